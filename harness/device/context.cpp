#include "device/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gnomon/error.h>
#include <gnomon/kit/gl.h>

#include <cstdlib>
#include <string_view>
#include <vector>

namespace gnomon {

namespace {

constexpr std::string_view needed_packages = "libegl1 libgl1-mesa-dri";

/// Extension functions are not exported by libEGL: they are asked for by name.
template <class Function>
Function egl_function(const char* name) {
  const auto function = reinterpret_cast<Function>(eglGetProcAddress(name));
  if (!function) throw Error("libEGL has no function {}; install {}", name, needed_packages);
  return function;
}

std::vector<EGLDeviceEXT> egl_devices() {
  const auto query = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  EGLint count = 0;
  if (!query(0, nullptr, &count)) count = 0;
  std::vector<EGLDeviceEXT> devices(count);
  if (count > 0) query(count, devices.data(), &count);
  return devices;
}

std::string text(GLenum what) {
  const auto* bytes = glGetString(what);
  return bytes ? reinterpret_cast<const char*>(bytes) : "unknown";
}

/// A render node without its own driver is served by Mesa's processor renderers: only the renderer's name tells.
bool is_software_renderer(std::string_view renderer) {
  for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "SWR"})
    if (renderer.find(name) != std::string_view::npos) return true;
  return false;
}

}  // namespace

GlChoice gl_choice_from_environment() {
  const char* value = std::getenv("GNOMON_GL");
  const std::string_view word = value ? value : "auto";
  if (word == "auto") return GlChoice::automatic;
  if (word == "software") return GlChoice::software;
  if (word == "hardware") return GlChoice::hardware;
  throw Error("GNOMON_GL = {} is none of auto | software | hardware", word);
}

GlContext::GlContext(GlChoice choice) {
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  // Real GPUs first, then the processor.
  for (const GlChoice wanted : {GlChoice::hardware, GlChoice::software}) {
    if (choice != GlChoice::automatic && choice != wanted) continue;
    for (std::size_t i = 0; i < devices.size(); ++i)
      if (try_device(devices[i], wanted)) {
        info_.device = static_cast<int>(i);
        glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
        return;
      }
  }
  throw Error(
      "no {}OpenGL 4.5 core context on any of {} EGL devices; install {}, or choose with GNOMON_GL=auto|software|hardware",
      choice == GlChoice::hardware   ? "hardware "
      : choice == GlChoice::software ? "software "
                                     : "",
      devices.size(), needed_packages);
}

bool GlContext::try_device(void* device, GlChoice choice) {
  const auto get_display = egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
  display_ = get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr);
  if (!display_ || !eglInitialize(display_, nullptr, nullptr)) {
    display_ = nullptr;
    return false;
  }
  const EGLint config_attributes[] = {EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  const EGLint context_attributes[] = {
      EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 5, EGL_CONTEXT_OPENGL_PROFILE_MASK,
      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint config_count = 0;
  if (eglBindAPI(EGL_OPENGL_API) && eglChooseConfig(display_, config_attributes, &config, 1, &config_count) && config_count > 0)
    context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, context_attributes);
  if (context_ && eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {
    info_ = {.vendor = text(GL_VENDOR), .renderer = text(GL_RENDERER), .version = text(GL_VERSION)};
    info_.is_software = is_software_renderer(info_.renderer);
    if (info_.is_software == (choice == GlChoice::software)) return true;
  }
  destroy();
  return false;
}

void GlContext::destroy() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  if (context_) eglDestroyContext(display_, context_);
  context_ = nullptr;
  // The display is one object per device and process: another context may live on it, so it is not terminated.
  display_ = nullptr;
}

GlContext::~GlContext() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  release_inputs();
  destroy();
}

GlContext& process_context() {
  // Not destroyed: at exit the driver's own clean-up may already have run.
  static GlContext* const context = new GlContext;
  return *context;
}

}  // namespace gnomon
