#pragma once
// Whether casters block the way from a receiver's point to a place of a light, in rational numbers: for places in double, which
// kit/geometry/exact.h does not take. Every triangle is tested.
#include <gmpxx.h>
#include <gnomon/kit/geometry/receiver.h>

#include <array>

namespace gnomon::exact_way {

/// `degenerate`: through an edge or a vertex, or by a triangle within 1e-12 of the way from the light, where the place's own
/// rounding decides.
enum class Way { clear, blocked, degenerate };

using Vector = std::array<mpq_class, 3>;
inline Vector rational(const glm::dvec3& v) { return {mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)}; }
inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline mpq_class determinant(const Vector& a, const Vector& b, const Vector& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Whether double rules out that the way goes through a triangle; errs towards no.
inline bool misses(const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& w, const glm::dvec3& to) {
  const double size = glm::length(u) * glm::length(v) + glm::length(v) * glm::length(w) + glm::length(w) * glm::length(u),
               slack = 1e-12 * size * glm::length(to);
  const double uv = glm::dot(glm::cross(u, v), to), vw = glm::dot(glm::cross(v, w), to), wu = glm::dot(glm::cross(w, u), to);
  return !(uv > -slack && vw > -slack && wu > -slack) && !(uv < slack && vw < slack && wu < slack);
}

/// As in crosses() of kit/geometry/exact.h. `to`: from the receiver's point to the place.
inline Way way(const Scene& scene, const Receiver& receiver, const glm::dvec3& to) {
  Way answer = Way::clear;
  const glm::dvec3 p(receiver.point);
  const mpq_class slack(1e-12);
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle corners = mesh.corners(t);
      if (misses(glm::dvec3(corners.points[0]) - p, glm::dvec3(corners.points[1]) - p, glm::dvec3(corners.points[2]) - p, to))
        continue;
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, corners.points)) continue;
      const Vector point = rational(p), d = rational(to), u = minus(rational(corners.points[0]), point),
                   v = minus(rational(corners.points[1]), point), w = minus(rational(corners.points[2]), point);
      const mpq_class uv = determinant(u, v, d), vw = determinant(v, w, d), wu = determinant(w, u, d),
                      volume = determinant(u, v, w), sum = uv + vw + wu;
      const int side = sgn(volume);
      if (side == 0 || side * sgn(uv) < 0 || side * sgn(vw) < 0 || side * sgn(wu) < 0 || sum == 0) continue;
      const mpq_class at = volume / sum;
      if (at > 1 + slack) continue;
      if (at < 1 - slack && sgn(uv) * sgn(vw) * sgn(wu) != 0) return Way::blocked;
      answer = Way::degenerate;
    }
  }
  return answer;
}

}  // namespace gnomon::exact_way
