#pragma once
#include <gnomon/kit/geometry/planar_shadow.h>

#include <cmath>
#include <numbers>

namespace planar_conic {
using namespace gnomon;

/// The conic that bounds a disc's shadow on the plane y = 0: q(x, z) = xx x^2 + xz x z + zz z^2 + x x + z z + one, not negative
/// in the shadow. Expanded from the rows, f(rows[2])^2 - f(rows[0])^2 - f(rows[1])^2.
struct Conic {
  double xx = 0, xz = 0, zz = 0, x = 0, z = 0, one = 0;

  explicit Conic(const ShadowTest& test) {
    for (int k = 0; k < 3; ++k) {
      const double sign = k == 2 ? 1 : -1, offset = test.rows[k].w - glm::dot(glm::dvec3(test.rows[k]), test.anchor);
      const double a = test.rows[k].x, b = test.rows[k].z;
      xx += sign * a * a, xz += sign * 2 * a * b, zz += sign * b * b;
      x += sign * 2 * a * offset, z += sign * 2 * b * offset, one += sign * offset * offset;
    }
  }
  /// Negative: an ellipse; zero: a parabola; positive: a hyperbola.
  double discriminant() const { return xz * xz - 4 * xx * zz; }
  double at(double px, double pz) const { return xx * px * px + xz * px * pz + zz * pz * pz + x * px + z * pz + one; }
  glm::dvec2 center() const { return glm::dvec2(2 * zz * x - xz * z, 2 * xx * z - xz * x) / discriminant(); }
  /// Semi-axes of an ellipse along x and z (xz = 0): about the center q falls from its value there as the squares grow.
  glm::dvec2 semi_axes() const {
    const double top = at(center().x, center().y);
    return {std::sqrt(top / -xx), std::sqrt(top / -zz)};
  }
  /// pi times the product of the semi-axes, whose squares are the value at the center over the eigenvalues.
  double area() const { return std::numbers::pi * at(center().x, center().y) / std::sqrt(-discriminant() / 4); }
};

/// Area of a loop without points at infinity, positive when it is counter-clockwise seen from above.
inline double area(const std::vector<glm::dvec4>& loop) {
  double twice = 0;
  const glm::dvec3 origin = glm::dvec3(loop[0]) / loop[0].w;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const glm::dvec4 &p = loop[k], &q = loop[(k + 1) % loop.size()];
    twice += glm::cross(glm::dvec3(p) / p.w - origin, glm::dvec3(q) / q.w - origin).y;
  }
  return twice / 2;
}

}  // namespace planar_conic
