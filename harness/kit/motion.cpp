#include <gnomon/motion.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

namespace gnomon {

glm::dmat4 node_matrix(const glm::dvec3& translation, const glm::dvec4& rotation, const glm::dvec3& scale) {
  const glm::dmat3 turned = glm::mat3_cast(glm::dquat(rotation.w, rotation.x, rotation.y, rotation.z));
  glm::dmat4 matrix(1);
  for (int c = 0; c < 3; ++c) matrix[c] = glm::dvec4(turned[c] * scale[c], 0);
  matrix[3] = glm::dvec4(translation, 1);
  return matrix;
}

double Animation::end() const {
  double last = 0;
  for (const Track& track : tracks) last = std::max(last, track.times.back());
  return last;
}

glm::dvec3 Placement::apply(const glm::dvec3& p) const {
  glm::dvec3 q = scale * p;
  for (int axis = 0; axis < 3; ++axis) {
    if (rotate_degrees[axis] == 0) continue;
    // Quarter turns are exact: cos(90 degrees) is 0, not 6e-17.
    const double turns = std::remainder(rotate_degrees[axis], 360.0) / 90;
    const double angle = glm::radians(rotate_degrees[axis]);
    const bool quarter = turns == std::round(turns);
    const double c = quarter ? std::round(std::cos(angle)) : std::cos(angle);
    const double s = quarter ? std::round(std::sin(angle)) : std::sin(angle);
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double qu = q[u], qv = q[v];
    q[u] = c * qu - s * qv;
    q[v] = s * qu + c * qv;
  }
  return q + translate;
}

}  // namespace gnomon
