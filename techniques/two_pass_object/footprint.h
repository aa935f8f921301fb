#pragma once
#include <array>

#include "triangles.h"

namespace gnomon::two_pass_object {

/// What the light sees of a triangle on a face: a box around its places, and bounds of its depths there.
struct Footprint {
  double u0, v0, u1, v1;
  std::uint32_t triangle;
  double nearest = -INFINITY, farthest = INFINITY;  ///< of its corners
  glm::dvec3 rise{0};                               ///< u * x + v * y + z is 1 / depth, and -depth for a directional light
  double reach = INFINITY;                          ///< more than a point that belongs to it lies off its place, in depth
  double area = INFINITY;                           ///< of its places
  bool is_bounded() const { return reach < INFINITY; }
};

/// More than rounding of a line's values at the places of a face.
inline double slack_of(const glm::dvec3& line) { return 0x1p-24 * (std::abs(line.x) + std::abs(line.y) + std::abs(line.z)); }

/// A rectangle of places.
struct Places {
  double u0, v0, u1, v1;
  double area() const { return (u1 - u0) * (v1 - v0); }
};

/// Bounds of what a triangle's points may have for depth in a rectangle of places that it touches.
struct Depths {
  double nearest, farthest;
};
inline Depths depths(const LightSpace& space, const Footprint& f, const Places& in) {
  if (!f.is_bounded()) return {-INFINITY, INFINITY};
  const bool is_x = f.rise.x > 0, is_y = f.rise.y > 0;
  const double high = f.rise.x * (is_x ? in.u1 : in.u0) + f.rise.y * (is_y ? in.v1 : in.v0) + f.rise.z;
  const double low = f.rise.x * (is_x ? in.u0 : in.u1) + f.rise.y * (is_y ? in.v0 : in.v1) + f.rise.z;
  const double nearest = space.is_parallel() ? -high : high > 0 ? 1 / high : -INFINITY;
  const double farthest = space.is_parallel() ? -low : low > 0 ? 1 / low : INFINITY;
  return {std::max(f.nearest, nearest) - f.reach, std::min(f.farthest, farthest) + f.reach};
}

/// The part of a triangle that a face, or a little more, sees; returns its number of corners. `out` holds 7.
inline std::size_t cut_to_face(const LightSpace& space, int face, const Triangle& triangle, Corner* out) {
  Corner other[8];
  std::size_t count = 3;
  for (int k = 0; k < 3; ++k) out[k] = {glm::dvec3(triangle.points[k])};
  for (int side = 0; side < 4 && count > 0; ++side) {
    ClipPlane plane = space.border(face, side / 2, side % 2 ? 1 + 0x1p-10 : -1 - 0x1p-10);
    if (side % 2) plane.normal = -plane.normal, plane.offset = -plane.offset;
    double values[8];
    Corner lost[8];
    const Lies lies = classify({out, count}, plane, 0, values);
    if (lies == Lies::positive || lies == Lies::within) continue;
    if (lies == Lies::negative) return 0;
    count = cut_polygon({out, count}, values, 0, 0, lost, other).positive;
    std::copy_n(other, count, out);
  }
  return count;
}

/// Calls visit(face, footprint) for each face that sees a part of the triangle.
template <class Visit>
void for_footprints(const Triangles& triangles, std::uint32_t i, Visit&& visit) {
  const LightSpace& space = triangles.space();
  const Triangle& triangle = triangles[i];
  const bool is_doubtful = triangles.is(i, Triangles::doubtful);
  const ClipPlane own = triangles.cap(i).unit();
  const double height = space.height(own);
  const auto print_of = [&](int face, const auto* corners, std::size_t count) {
    Footprint f{INFINITY, INFINITY, -INFINITY, -INFINITY, i, INFINITY, -INFINITY};
    double farthest = 0, area = 0;
    Seen first{}, last{};
    for (std::size_t k = 0; k < count; ++k) {
      const Seen s = space.seen(face, corners[k]);
      f.u0 = std::min(f.u0, s.u), f.u1 = std::max(f.u1, s.u);
      f.v0 = std::min(f.v0, s.v), f.v1 = std::max(f.v1, s.v);
      f.nearest = std::min(f.nearest, s.depth), f.farthest = std::max(f.farthest, s.depth);
      if (!space.is_parallel()) farthest = std::max(farthest, glm::distance(corners[k], glm::dvec3(space.light())));
      if (k > 1) area += (last.u - first.u) * (s.v - first.v) - (s.u - first.u) * (last.v - first.v);
      if (k == 0) first = s;
      last = s;
    }
    if (is_doubtful) return Footprint{f.u0, f.v0, f.u1, f.v1, i};
    f.area = std::abs(area) / 2;
    // A plane that is off by a quarter of the doubt adds less than the second half of this.
    f.reach = 2 * space.rounding() * (space.is_parallel() ? 1 : farthest) / std::abs(height);
    f.rise = space.line(face, own.normal, glm::dvec3(triangle.points[0])) / (space.is_parallel() ? height : -height);
    return f;
  };
  const glm::dvec3 points[3] = {glm::dvec3(triangle.points[0]), glm::dvec3(triangle.points[1]), glm::dvec3(triangle.points[2])};
  if (space.is_parallel()) return visit(0, print_of(0, points, 3));
  const int only = space.face_of(points[0]);
  const auto is_clearly_in = [&](const glm::dvec3& p) {
    const double depth = space.depth(only, p);
    if (!(depth > 0x1p-30 * space.extent())) return false;
    const Seen s = space.seen(only, p);
    return std::max(std::abs(s.u), std::abs(s.v)) < 1 - 0x1p-10;
  };
  if (is_clearly_in(points[0]) && is_clearly_in(points[1]) && is_clearly_in(points[2]))
    return visit(only, print_of(only, points, 3));
  for (int face = 0; face < 6; ++face) {
    if (is_doubtful) {
      visit(face, Footprint{-1, -1, 1, 1, i});
      continue;
    }
    Corner polygon[8];
    const std::size_t count = cut_to_face(space, face, triangle, polygon);
    if (count == 0) continue;
    glm::dvec3 at[8];
    bool is_near = false;
    for (std::size_t k = 0; k < count; ++k) {
      at[k] = polygon[k].at;
      is_near |= !(space.depth(face, at[k]) > 0x1p-30 * space.extent());
    }
    // So near to the light places are lost in rounding.
    Footprint f = is_near ? Footprint{-1, -1, 1, 1, i} : print_of(face, at, count);
    if (f.u0 > 1 || f.u1 < -1 || f.v0 > 1 || f.v1 < -1) continue;
    f.u0 = std::max(f.u0, -1.0), f.u1 = std::min(f.u1, 1.0);
    f.v0 = std::max(f.v0, -1.0), f.v1 = std::min(f.v1, 1.0);
    visit(face, f);
  }
}

/// The footprints of all triangles that take part, by face.
using Footprints = std::array<std::vector<Footprint>, 6>;

inline Footprints find_footprints(const Triangles& triangles) {
  constexpr std::size_t block = 16384;
  std::vector<Footprints> found((triangles.size() + block - 1) / block);
  for_blocks(triangles.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (triangles.takes_part(static_cast<std::uint32_t>(i)))
        for_footprints(triangles, static_cast<std::uint32_t>(i),
                       [&](int face, const Footprint& f) { found[begin / block][face].push_back(f); });
  });
  Footprints all;
  for (int face = 0; face < 6; ++face) {
    std::size_t count = 0;
    for (const Footprints& some : found) count += some[face].size();
    all[face].reserve(count);
    for (Footprints& some : found) {
      all[face].insert(all[face].end(), some[face].begin(), some[face].end());
      some[face] = {};
    }
  }
  return all;
}

}  // namespace gnomon::two_pass_object
