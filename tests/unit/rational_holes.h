#pragma once
// Where a segment crosses a triangle, and whether that is solid, in rational numbers: by the point where it cuts the plane and
// the areas around that, which is another road than the volumes of kit/geometry/holes.cpp.
#include <gmpxx.h>
#include <gnomon/kit/geometry/holes.h>

#include <array>
#include <optional>

namespace gnomon::rational_holes {

using Vector = std::array<mpq_class, 3>;
inline Vector rational(const glm::dvec3& v) { return {mpq_class(v.x), mpq_class(v.y), mpq_class(v.z)}; }
inline Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline mpq_class dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The shares of the corners at the place of the cut; they add up to 1.
struct Cut {
  std::array<mpq_class, 3> shares;
  bool is_on_edge = false;
};

/// Nothing where the segment does not cross the closed triangle strictly between its ends.
inline std::optional<Cut> cut(const Segment& segment, const Triangle& triangle) {
  const Vector point = rational(segment.point), light = rational(glm::dvec3(segment.light));
  const Vector way = segment.light.w == 0 ? light : minus(light, point);
  std::array<Vector, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = rational(triangle.points[k]);
  const Vector normal = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
  const mpq_class rise = dot(normal, way), height = dot(normal, minus(corner[0], point));
  if (rise == 0 || height == 0) return std::nullopt;
  const mpq_class t = height / rise;
  if (t <= 0 || (segment.light.w != 0 && t >= 1)) return std::nullopt;
  const Vector at = {point[0] + t * way[0], point[1] + t * way[1], point[2] + t * way[2]};
  Cut found;
  const mpq_class area = dot(normal, normal);
  for (int k = 0; k < 3; ++k) {
    const Vector &from = corner[(k + 1) % 3], &to = corner[(k + 2) % 3];
    found.shares[k] = dot(normal, cross(minus(to, from), minus(at, from))) / area;
    if (found.shares[k] < 0) return std::nullopt;
    found.is_on_edge |= found.shares[k] == 0;
  }
  return found;
}

/// In texels along one axis, before wrapping.
inline mpq_class place(const Mesh& mesh, std::uint32_t triangle, const Cut& cut, int axis) {
  mpq_class sum = 0;
  for (int k = 0; k < 3; ++k) sum += cut.shares[k] * mpq_class(static_cast<double>(mesh.uv[mesh.triangles[triangle][k]][axis]));
  return sum * (axis == 0 ? mesh.alpha_mask->width() : mesh.alpha_mask->height());
}

inline mpz_class whole_below(const mpq_class& place) {
  mpz_class whole = place.get_num() / place.get_den();  // toward zero
  if (whole > place) --whole;
  return whole;
}

/// Of copies of the image side by side, every other one turned when mirrored.
inline int wrapped(const mpz_class& texel, int size, AlphaMask::Wrap wrap) {
  if (wrap == AlphaMask::Wrap::clamp) {
    if (texel < 0) return 0;
    return texel >= size ? size - 1 : static_cast<int>(texel.get_si());
  }
  const mpz_class copy = whole_below(mpq_class(texel) / size), within = texel - copy * size;
  const bool is_turned = wrap == AlphaMask::Wrap::mirror && mpz_odd_p(copy.get_mpz_t());
  return static_cast<int>(is_turned ? size - 1 - within.get_si() : within.get_si());
}

inline bool is_solid(const Mesh& mesh, std::uint32_t triangle, const Cut& cut) {
  if (!mesh.alpha_mask) return true;
  const AlphaMask& mask = *mesh.alpha_mask;
  return mask.is_solid(wrapped(whole_below(place(mesh, triangle, cut, 0)), mask.width(), mask.wrap_u()),
                       wrapped(whole_below(place(mesh, triangle, cut, 1)), mask.height(), mask.wrap_v()));
}

}  // namespace gnomon::rational_holes
