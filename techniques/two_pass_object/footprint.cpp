#include "footprint.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::two_pass_object {

Depths depths(const SceneLightSpace& space, const Footprint& f, const Places& in) {
  if (!f.is_bounded()) return {-INFINITY, INFINITY};
  const bool is_x = f.rise.x > 0, is_y = f.rise.y > 0;
  const double high = f.rise.x * (is_x ? in.u1 : in.u0) + f.rise.y * (is_y ? in.v1 : in.v0) + f.rise.z;
  const double low = f.rise.x * (is_x ? in.u0 : in.u1) + f.rise.y * (is_y ? in.v0 : in.v1) + f.rise.z;
  const double nearest = space.is_parallel() ? -high : high > 0 ? 1 / high : -INFINITY;
  const double farthest = space.is_parallel() ? -low : low > 0 ? 1 / low : INFINITY;
  return {std::max(f.nearest, nearest) - f.reach, std::min(f.farthest, farthest) + f.reach};
}

namespace {

/// Leaves the part of a triangle that a face, or a little more, sees; says whether there is one.
bool cut_to_face(const SceneLightSpace& space, int face, const Triangle& triangle, Clipper& clipper) {
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
Footprint footprint_of(const Triangles& triangles, std::uint32_t i, int face, std::span<const Corner> corners) {
  const SceneLightSpace& space = triangles.space();
  Footprint f{INFINITY, INFINITY, -INFINITY, -INFINITY, i, INFINITY, -INFINITY};
  double farthest = 0, area = 0;
  PlaceAndDepth first{}, last{};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const PlaceAndDepth p = space.seen(face, corners[k].at);
    f.u0 = std::min(f.u0, p.u);
    f.u1 = std::max(f.u1, p.u);
    f.v0 = std::min(f.v0, p.v);
    f.v1 = std::max(f.v1, p.v);
    f.nearest = std::min(f.nearest, p.depth);
    f.farthest = std::max(f.farthest, p.depth);
    if (!space.is_parallel()) farthest = std::max(farthest, glm::distance(corners[k].at, glm::dvec3(space.light())));
    if (k > 1) area += (last.u - first.u) * (p.v - first.v) - (p.u - first.u) * (last.v - first.v);
    if (k == 0) first = p;
    last = p;
  }
  if (triangles.is(i, Triangles::doubtful)) return Footprint{f.u0, f.v0, f.u1, f.v1, i};
  const ClipPlane own = triangles.cap(i).unit();
  const double height = space.height(own);
  f.area = std::abs(area) / 2;
  // A plane that is off by a quarter of the doubt adds less than the second half of this.
  f.reach = 2 * space.rounding() * (space.is_parallel() ? 1 : farthest) / std::abs(height);
  f.rise = space.line(face, own.normal, glm::dvec3(triangles[i].points[0])) / (space.is_parallel() ? height : -height);
  return f;
}

/// Whether a cube's face clearly sees all corners.
bool is_clearly_in(const SceneLightSpace& space, int face, std::span<const Corner> corners) {
  return std::ranges::all_of(corners, [&](const Corner& corner) {
    if (!space.has_place(space.depth(face, corner.at))) return false;
    const PlaceAndDepth p = space.seen(face, corner.at);
    return std::max(std::abs(p.u), std::abs(p.v)) < 1 - 0x1p-10;
  });
}

}  // namespace

void for_footprints(const Triangles& triangles, std::uint32_t i, const std::function<void(int, const Footprint&)>& visit) {
  const SceneLightSpace& space = triangles.space();
  const glm::vec3* p = triangles[i].points;
  const Corner corners[3] = {{p[0]}, {p[1]}, {p[2]}};
  if (space.is_parallel()) return visit(0, footprint_of(triangles, i, 0, corners));
  if (const int only = space.face_of(corners[0].at); is_clearly_in(space, only, corners))
    return visit(only, footprint_of(triangles, i, only, corners));
  const Footprint anywhere{-1, -1, 1, 1, i};
  Clipper clipper;
  for (int face = 0; face < 6; ++face) {
    if (triangles.is(i, Triangles::doubtful)) {
      visit(face, anywhere);
      continue;
    }
    if (!cut_to_face(space, face, triangles[i], clipper)) continue;
    // So near to the light places are lost in rounding.
    const bool is_near =
        std::ranges::any_of(clipper.corners(), [&](const Corner& c) { return !space.has_place(space.depth(face, c.at)); });
    Footprint f = is_near ? anywhere : footprint_of(triangles, i, face, clipper.corners());
    if (f.u0 > 1 || f.u1 < -1 || f.v0 > 1 || f.v1 < -1) continue;
    f.u0 = std::max(f.u0, -1.0);
    f.u1 = std::min(f.u1, 1.0);
    f.v0 = std::max(f.v0, -1.0);
    f.v1 = std::min(f.v1, 1.0);
    visit(face, f);
  }
}

Footprints find_footprints(const Triangles& triangles) {
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
