#include "device/context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <gnomon/error.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/gl/gl_limits.h>

#include <cstdlib>
#include <vector>

namespace gnomon {

namespace {

constexpr std::string_view needed_packages = "libegl1 libgl1-mesa-dri";

bool has_process_context = false;

/// Extension functions are not exported by libEGL: they are looked up by name.
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

/// Mesa takes another driver than the machine's own from the environment, and zink finds lavapipe by the first of these.
void choose_mesa_driver(GlChoice choice) {
  if (choice == GlChoice::zink) {
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    setenv("GALLIUM_DRIVER", "zink", 1);
    setenv("MESA_LOADER_DRIVER_OVERRIDE", "zink", 1);
  } else if (choice == GlChoice::software) {  // whatever the environment says otherwise
    unsetenv("GALLIUM_DRIVER");
    unsetenv("MESA_LOADER_DRIVER_OVERRIDE");
  }
}

[[noreturn]] void refuse(GlChoice choice, std::size_t device_count) {
  if (choice == GlChoice::zink)
    throw Error("no OpenGL 4.5 core context of zink over lavapipe on any of {} EGL devices; install {} mesa-vulkan-drivers",
                device_count, needed_packages);
  throw Error(
      "no {}OpenGL 4.5 core context on any of {} EGL devices; install {}, or choose with GNOMON_GL=auto|software|hardware|zink",
      choice == GlChoice::hardware   ? "hardware "
      : choice == GlChoice::software ? "software "
                                     : "",
      device_count, needed_packages);
}

}  // namespace

// A render node without its own driver is served by Mesa's processor renderers: only the renderer's name shows it.
GlChoice driver_of(std::string_view renderer) {
  for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "SWR"})
    if (renderer.find(name) != std::string_view::npos)
      return renderer.starts_with("zink") ? GlChoice::zink : GlChoice::software;
  return GlChoice::hardware;
}

GlChoice gl_choice_from_environment() {
  const char* value = std::getenv("GNOMON_GL");
  const std::string_view word = value ? value : "auto";
  if (word == "auto") return GlChoice::automatic;
  if (word == "software") return GlChoice::software;
  if (word == "hardware") return GlChoice::hardware;
  if (word == "zink") return GlChoice::zink;
  throw Error("GNOMON_GL = {} is none of auto | software | hardware | zink", word);
}

GlContext::GlContext(GlChoice choice) {
  choose_mesa_driver(choice);
  const std::vector<EGLDeviceEXT> devices = egl_devices();
  // Real GPUs first, then the processor; zink, without a request, only where the environment leaves no other.
  for (const GlChoice wanted : {GlChoice::hardware, GlChoice::software, GlChoice::zink}) {
    if (choice != GlChoice::automatic && choice != wanted) continue;
    for (std::size_t i = 0; i < devices.size(); ++i)
      if (try_device(devices[i], wanted)) {
        info_.device = static_cast<int>(i);
        glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
        ask_gl_limits();
        return;
      }
  }
  refuse(choice, devices.size());
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
    info_.driver = driver_of(info_.renderer);
    if (info_.driver == choice) return true;
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
  forget_gl_limits();
  destroy();
}

GlContext& process_context() {
  // Not destroyed: at exit the driver's own clean-up may already have run.
  static GlContext* const context = [] {
    has_process_context = true;
    return new GlContext;
  }();
  return *context;
}

}  // namespace gnomon

#if defined(__SANITIZE_ADDRESS__)
// Called by the leak checker before it stops all threads: those of a driver end at the same time, and take it down. So a
// process that has drawn is not checked for leaks.
extern "C" int __lsan_is_turned_off() { return gnomon::has_process_context; }
#endif
