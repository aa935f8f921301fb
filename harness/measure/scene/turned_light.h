#pragma once
#include <gnomon/light.h>

namespace gnomon {

/// The light turned by an angle about the vertical line through a point, counter-clockwise seen from above. In double, rounded
/// once.
Light turned(const Light& light, const glm::dvec3& about, double radians);

}  // namespace gnomon
