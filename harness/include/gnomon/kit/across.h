#pragma once
#include <gnomon/scene.h>

namespace gnomon {

/// Two unit vectors across a unit axis; u, v, axis is right-handed. The coordinate axis farthest from it makes the best
/// conditioned pair.
struct Across {
  glm::dvec3 u, v;

  explicit Across(const glm::dvec3& axis) {
    const glm::dvec3 a = glm::abs(axis);
    const glm::dvec3 helper = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                              : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                       : glm::dvec3(0, 0, 1);
    u = glm::normalize(glm::cross(helper, axis)), v = glm::cross(axis, u);
  }
};

}  // namespace gnomon
