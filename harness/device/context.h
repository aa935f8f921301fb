#pragma once
#include <string>

namespace gnomon {

/// Which device draws. `automatic` takes the first real GPU that gives a context, else Mesa's llvmpipe.
enum class GlChoice { automatic, software, hardware };

/// The choice of the environment variable GNOMON_GL (auto, software, hardware); automatic when it is not set. Throws Error.
GlChoice gl_choice_from_environment();

/// What drew, for every table.
struct GlInfo {
  std::string vendor, renderer, version;
  int device = 0;            ///< index in the list of EGL devices
  bool is_software = false;  ///< drawn by the processor
};

/// A headless OpenGL 4.5 core context on an EGL device, without window, surface or display; current on the thread that made
/// it from construction to destruction. It sets the house state on top of the defaults of OpenGL: clip control upper left,
/// zero to one. Destruction releases the inputs that kit/gl holds. Throws Error when no device gives a context.
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
