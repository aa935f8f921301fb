#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// What a technique supports that answers for one point of the light: every light without area, and of others `why` not.
inline Support hard_lights_only(const Light& light, const char* why) {
  return has_area(light) ? Support::unsupported(why) : Support::full();
}

}  // namespace gnomon
