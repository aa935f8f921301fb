#pragma once
#include <cmath>
#include <glm/glm.hpp>

namespace gnomon {

/// The sign of the determinant of three vectors where rounding cannot have made it, else 0; `value` is the determinant in
/// double. Each of the six products errs by at most four roundings of double, their sum by two more. What the vectors
/// themselves are rounded by is the caller's.
inline int sure_sign(const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& w, double& value) {
  const double yz = v.y * w.z, zy = v.z * w.y, zx = v.z * w.x, xz = v.x * w.z, xy = v.x * w.y, yx = v.y * w.x;
  value = u.x * (yz - zy) + u.y * (zx - xz) + u.z * (xy - yx);
  const double bound = 16 * 0x1p-53 *
                       (std::abs(u.x) * (std::abs(yz) + std::abs(zy)) + std::abs(u.y) * (std::abs(zx) + std::abs(xz)) +
                        std::abs(u.z) * (std::abs(xy) + std::abs(yx)));
  return value > bound ? 1 : value < -bound ? -1 : 0;
}

}  // namespace gnomon
