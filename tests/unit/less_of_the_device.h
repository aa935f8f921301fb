#pragma once
#include <gnomon/kit/gl/gl_limits.h>

#include <cstdlib>
#include <string>

namespace gnomon {

/// While it lives the device has less of something. `words` as GNOMON_GL_LIMITS has them.
class LessOfTheDevice {
 public:
  explicit LessOfTheDevice(const std::string& words) {
    setenv("GNOMON_GL_LIMITS", words.c_str(), 1);
    ask_gl_limits();
  }
  LessOfTheDevice(const LessOfTheDevice&) = delete;
  ~LessOfTheDevice() {
    unsetenv("GNOMON_GL_LIMITS");
    ask_gl_limits();
  }
};

}  // namespace gnomon
