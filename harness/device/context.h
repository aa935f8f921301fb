#pragma once
#include <string>
#include <string_view>

namespace gnomon {

/// Which driver draws: a real GPU's; Mesa's llvmpipe; or, a second OpenGL for machines without a GPU, Mesa's zink, which speaks
/// Vulkan to lavapipe. `automatic` takes the first real GPU that gives a context, else llvmpipe.
enum class GlChoice { automatic, software, hardware, zink };

/// The choice of the environment variable GNOMON_GL (auto, software, hardware, zink); automatic when it is not set. Throws
/// Error.
GlChoice gl_choice_from_environment();
/// The driver behind a renderer's name, the text of GL_RENDERER: software, hardware or zink, which over a real GPU's Vulkan is
/// hardware.
GlChoice driver_of(std::string_view renderer);

/// What drew, for every table.
struct GlInfo {
  std::string vendor, renderer, version;
  int device = 0;  ///< index in the list of EGL devices
  GlChoice driver = GlChoice::automatic;
  bool is_software() const { return driver != GlChoice::hardware; }  ///< drawn by the processor
};

/// A headless OpenGL 4.5 core context on an EGL device, without window, surface or display; current on the thread that made
/// it from construction to destruction. It sets the house state on top of the defaults of OpenGL: clip control upper left,
/// zero to one. Destruction releases the inputs that kit/gl/gl holds. A choice of software or zink sets the variables by which
/// Mesa chooses its driver, of this process: Mesa reads them when the first context is made, so a process has one driver.
/// Throws Error when no device gives a context.
class GlContext {
 public:
  explicit GlContext(GlChoice choice = gl_choice_from_environment());
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  const GlInfo& info() const { return info_; }

 private:
  bool try_device(void* device, GlChoice choice);
  void destroy();

  void* display_ = nullptr;  // EGLDisplay and EGLContext: both are void*
  void* context_ = nullptr;
  GlInfo info_;
};

/// The context of this process, made at the first call and never destroyed.
GlContext& process_context();

}  // namespace gnomon
