#pragma once
#include <gnomon/kit/parallel.h>

#include <array>

#include "triangles.h"

namespace gnomon::two_pass_object {

/// A rectangle of places; an empty one by default.
struct Places {
  double u0 = INFINITY, v0 = INFINITY, u1 = -INFINITY, v1 = -INFINITY;
  double width() const { return u1 - u0; }
  double height() const { return v1 - v0; }
  double area() const { return width() * height(); }
  /// Grows to hold another rectangle.
  void add(const Places& p) { *this = {std::min(u0, p.u0), std::min(v0, p.v0), std::max(u1, p.u1), std::max(v1, p.v1)}; }
  void add(const PlaceAndDepth& p) { add({p.u, p.v, p.u, p.v}); }
  Places grown(double by) const { return {u0 - by, v0 - by, u1 + by, v1 + by}; }
  /// What two rectangles have in common.
  Places within(const Places& p) const {
    return {std::max(u0, p.u0), std::max(v0, p.v0), std::min(u1, p.u1), std::min(v1, p.v1)};
  }
  /// Whether they are farther apart than `reach` along u or v.
  bool misses(const Places& p, double reach = 0) const {
    return p.u1 < u0 - reach || p.u0 > u1 + reach || p.v1 < v0 - reach || p.v0 > v1 + reach;
  }
};

/// Of a face of a cube: faces meet and do not overlap.
inline constexpr Places cube_face{-1, -1, 1, 1};

/// What the light sees of a triangle on a face: a box around its places, and bounds of its depths there.
struct Footprint {
  Places box;
  std::uint32_t triangle;
  double nearest = -INFINITY, farthest = INFINITY;  ///< of its corners
  glm::dvec3 rise{0};                               ///< u * x + v * y + z is 1 / depth, and -depth for a directional light
  double reach = INFINITY;                          ///< more than a point that belongs to it lies off its place, in depth
  double area = INFINITY;                           ///< of its places
  bool is_bounded() const { return reach < INFINITY; }
};

/// More than rounding of a line's values at the places of a face.
inline double slack_of(const glm::dvec3& line) { return 0x1p-24 * (std::abs(line.x) + std::abs(line.y) + std::abs(line.z)); }

/// Bounds of what a triangle's points may have for depth in a rectangle of places that it touches.
struct Depths {
  double nearest, farthest;
};

inline Depths depths(const SceneLightSpace& space, const Footprint& f, const Places& in) {
  if (!f.is_bounded()) return {-INFINITY, INFINITY};
  const bool is_x = f.rise.x > 0, is_y = f.rise.y > 0;
  const double high = f.rise.x * (is_x ? in.u1 : in.u0) + f.rise.y * (is_y ? in.v1 : in.v0) + f.rise.z;
  const double low = f.rise.x * (is_x ? in.u0 : in.u1) + f.rise.y * (is_y ? in.v0 : in.v1) + f.rise.z;
  const double nearest = space.is_parallel() ? -high : high > 0 ? 1 / high : -INFINITY;
  const double farthest = space.is_parallel() ? -low : low > 0 ? 1 / low : INFINITY;
  return {std::max(f.nearest, nearest) - f.reach, std::min(f.farthest, farthest) + f.reach};
}

/// Leaves the part of a triangle that a face, or a little more, sees. Returns whether there is one.
inline bool cut_to_face(const SceneLightSpace& space, int face, const Triangle& triangle, Clipper& clipper) {
  clipper.start();
  for (const glm::vec3& p : triangle.points) clipper.add({p});
  for (int side = 0; side < 4; ++side) {
    ClipPlane plane = space.border(face, side / 2, side % 2 ? 1 + 0x1p-10 : -1 - 0x1p-10);
    if (side % 2) plane = -plane;
    if (clipper.keep_positive(plane, 0) == Lies::negative) return false;
  }
  return true;
}

/// The footprint of a triangle's part with these corners.
inline Footprint footprint_of(const Triangles& triangles, std::uint32_t i, int face, std::span<const Corner> corners) {
  const SceneLightSpace& space = triangles.space();
  Footprint f{.box = {}, .triangle = i, .nearest = INFINITY, .farthest = -INFINITY};
  double farthest = 0, area = 0;
  PlaceAndDepth first{}, last{};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const PlaceAndDepth p = space.seen(face, corners[k].at);
    f.box.add(p);
    f.nearest = std::min(f.nearest, p.depth);
    f.farthest = std::max(f.farthest, p.depth);
    if (!space.is_parallel()) farthest = std::max(farthest, glm::distance(corners[k].at, glm::dvec3(space.light())));
    if (k > 1) area += (last.u - first.u) * (p.v - first.v) - (p.u - first.u) * (last.v - first.v);
    if (k == 0) first = p;
    last = p;
  }
  if (triangles.is(i, Triangles::doubtful)) return {.box = f.box, .triangle = i};
  const ClipPlane own = triangles.cap(i).unit();
  const double height = space.height(own);
  f.area = std::abs(area) / 2;
  // A plane that is off by a quarter of the doubt adds less than the second half of this.
  f.reach = 2 * space.rounding() * (space.is_parallel() ? 1 : farthest) / std::abs(height);
  f.rise = space.line(face, own.normal, glm::dvec3(triangles[i].points[0])) / (space.is_parallel() ? height : -height);
  return f;
}

/// Whether a cube's face clearly sees all corners.
inline bool is_clearly_in(const SceneLightSpace& space, int face, std::span<const Corner> corners) {
  return std::ranges::all_of(corners, [&](const Corner& corner) {
    if (!space.has_place(space.depth(face, corner.at))) return false;
    const PlaceAndDepth p = space.seen(face, corner.at);
    return std::max(std::abs(p.u), std::abs(p.v)) < 1 - 0x1p-10;
  });
}

/// Calls visit(face, footprint) for each face that sees a part of the triangle.
inline void for_footprints(const Triangles& triangles, std::uint32_t i, const auto& visit) {
  const SceneLightSpace& space = triangles.space();
  const glm::vec3* p = triangles[i].points;
  const Corner corners[3] = {{p[0]}, {p[1]}, {p[2]}};
  if (space.is_parallel()) return visit(0, footprint_of(triangles, i, 0, corners));
  if (const int only = space.face_of(corners[0].at); is_clearly_in(space, only, corners))
    return visit(only, footprint_of(triangles, i, only, corners));
  const Footprint anywhere{.box = cube_face, .triangle = i};
  const bool is_doubtful = triangles.is(i, Triangles::doubtful);
  Clipper clipper;
  for (int face = 0; face < 6; ++face) {
    if (!is_doubtful && !cut_to_face(space, face, triangles[i], clipper)) continue;
    // So near to the light places are lost in rounding.
    const auto is_near = [&](const Corner& c) { return !space.has_place(space.depth(face, c.at)); };
    const bool has_bounds = !is_doubtful && std::ranges::none_of(clipper.corners(), is_near);
    Footprint f = has_bounds ? footprint_of(triangles, i, face, clipper.corners()) : anywhere;
    if (cube_face.misses(f.box)) continue;
    f.box = f.box.within(cube_face);
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
