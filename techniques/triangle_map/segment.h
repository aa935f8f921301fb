#pragma once
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <string_view>
#include <utility>

// Whether a segment meets a triangle, so that no segment slips through an edge that two triangles share (Woop, Benthin and Wald
// 2013). In float32, once in C++ for tests and once in the shader.
//
// All corners are taken relative to the segment's start and sheared so that the segment runs along one axis. An edge's function
// is then a difference of two products of the corners' coordinates. Two triangles compute that of their common edge from the
// same numbers, one with the sign changed: where none of both is strict, both are hit.
namespace gnomon::triangle_map {

/// The frame of a segment.
struct Shear {
  int axis = 2;         ///< along which the way is longest
  glm::vec3 shear{0};   ///< the way across that axis over the way along it, twice, and 1 over the latter
  bool has_end = true;  ///< it ends where the way does; else never
};
/// Components in cyclic order, that of the axis last.
inline glm::vec3 turned(const glm::vec3& v, int axis) { return {v[(axis + 1) % 3], v[(axis + 2) % 3], v[axis]}; }
inline Shear shear_along(const glm::vec3& way, bool has_end) {
  const glm::vec3 a = glm::abs(way);
  const int axis = a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
  const glm::vec3 t = turned(way, axis);
  return {axis, {t.x / t.z, t.y / t.z, 1 / t.z}, has_end};
}

/// What the test computes. A triangle is met where no two of the three edges have opposite signs, their sum is not 0, and the
/// height, over that sum, is on the segment.
struct Meeting {
  float u = 0, v = 0, w = 0, height = 0;
  float sum() const { return u + v + w; }
};
/// Corners are relative to the segment's start.
inline Meeting meeting(const std::array<glm::vec3, 3>& corners, const Shear& along) {
  std::array<glm::vec3, 3> p;
  for (int k = 0; k < 3; ++k) {
    p[k] = turned(corners[k], along.axis);
    p[k].x -= along.shear.x * p[k].z;
    p[k].y -= along.shear.y * p[k].z;
  }
  Meeting m{p[2].x * p[1].y - p[2].y * p[1].x, p[0].x * p[2].y - p[0].y * p[2].x, p[1].x * p[0].y - p[1].y * p[0].x};
  m.height = (m.u * p[0].z + m.v * p[1].z + m.w * p[2].z) * along.shear.z;
  return m;
}
inline bool is_met(const Meeting& m, bool has_end) {
  const float sum = m.sum(), height = sum < 0 ? -m.height : m.height;
  if ((m.u < 0 || m.v < 0 || m.w < 0) && (m.u > 0 || m.v > 0 || m.w > 0)) return false;
  return sum != 0 && height >= 0 && (!has_end || height <= std::abs(sum));
}

/// The same in GLSL: `segment_axis`, `segment_turned` and
///   bool segment_meets(vec3 a, vec3 b, vec3 c, vec3 shear, bool has_end)   of corners that are turned
/// `precise`, for a fused product would give the two sides of a common edge different values.
inline constexpr std::string_view segment_snippet = R"(
int segment_axis(vec3 way) {
  vec3 a = abs(way);
  return a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
}
vec3 segment_turned(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
bool segment_meets(vec3 a, vec3 b, vec3 c, vec3 shear, bool has_end) {
  precise float ax = a.x - shear.x * a.z, ay = a.y - shear.y * a.z;
  precise float bx = b.x - shear.x * b.z, by = b.y - shear.y * b.z;
  precise float cx = c.x - shear.x * c.z, cy = c.y - shear.y * c.z;
  precise float u = cx * by - cy * bx;
  precise float v = ax * cy - ay * cx;
  precise float w = bx * ay - by * ax;
  precise float sum = u + v + w;
  precise float height = (u * a.z + v * b.z + w * c.z) * shear.z;
  bool is_beside = (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
  float along = sum < 0 ? -height : height;
  return !is_beside && sum != 0 && along >= 0 && (!has_end || along <= abs(sum));
}
)";

}  // namespace gnomon::triangle_map
