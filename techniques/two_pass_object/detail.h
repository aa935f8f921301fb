#pragma once
#include <gnomon/kit/parallel.h>
#include <gnomon/technique.h>

#include "map.h"

namespace gnomon::two_pass_object {

/// A lit or dark part of a triangle, in one cell.
struct Part {
  std::uint32_t triangle;
  bool is_lit;
  std::uint32_t first, count;  ///< corners
};

struct Parts {
  std::vector<Part> parts;
  std::vector<glm::dvec3> corners;

  void add(std::uint32_t triangle, bool is_lit, std::span<const Corner> polygon) {
    parts.push_back({triangle, is_lit, static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(polygon.size())});
    for (const Corner& corner : polygon) corners.push_back(corner.at);
  }
  std::span<const glm::dvec3> corners_of(const Part& part) const { return {corners.data() + part.first, part.count}; }
};

/// Clips the cells once more, now without a margin and for the dark parts too. By triangle; the parts of one are in the order
/// of the cells.
inline Parts find_parts(const Triangles& triangles, const LightMap& map) {
  std::vector<Parts> found(map.patch_count());
  for_blocks(found.size(), 1, [&](std::size_t patch, std::size_t) {
    Parts& mine = found[patch];
    map.for_leaves(triangles, patch, [&](int face, const Node& cell, std::span<const Footprint* const> footprints) {
      CellClipper clipper(triangles, face);
      clipper.clip(
          cell, 0, true, footprints,
          [&](std::uint32_t index, const Pieces& pieces) {
            for (std::size_t k = 0; k < pieces.size(); ++k) mine.add(clipper.members()[index].triangle, true, pieces[k]);
          },
          [&](const CellClipper::Member& m, std::span<const Corner> part) {
            if (m.receives) mine.add(m.triangle, false, part);
          });
    });
  });
  Parts all;
  for (const Parts& some : found) {
    const auto first = static_cast<std::uint32_t>(all.corners.size());
    for (const Part& p : some.parts) all.parts.push_back({p.triangle, p.is_lit, first + p.first, p.count});
    all.corners.insert(all.corners.end(), some.corners.begin(), some.corners.end());
  }
  std::ranges::stable_sort(all.parts, {}, &Part::triangle);
  return all;
}

/// The polygons of a map, by clipping its cells once more, now without a margin and for the dark parts too. `merge`: a triangle
/// that is lit, or dark, throughout is one polygon.
inline SurfaceDetail make_detail(const Scene& scene, const Triangles& triangles, const LightMap& map, bool merge) {
  const Parts found = find_parts(triangles, map);
  const TriangleNumbers& numbers = triangles.numbers();
  SurfaceDetail detail;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    for (std::uint32_t i = numbers.first_of(m); i < numbers.end_of(m); ++i) {
      if (!triangles.takes_part(i) || !triangles.is(i, Triangles::receives)) continue;
      const std::uint32_t of_mesh = i - numbers.first_of(m);
      const auto add = [&](bool is_lit, auto&& corners) {
        detail.polygons.push_back({m, of_mesh, is_lit, static_cast<std::uint32_t>(detail.corners.size()),
                                   static_cast<std::uint32_t>(std::size(corners))});
        for (const auto& corner : corners) detail.corners.emplace_back(corner);
      };
      const std::span<const Part> parts(std::ranges::lower_bound(found.parts, i, {}, &Part::triangle),
                                        std::ranges::upper_bound(found.parts, i, {}, &Part::triangle));
      if (parts.empty()) {
        // Nothing of it is wider than epsilon: one point decides for all.
        glm::dvec3 center(0);
        for (const glm::vec3& p : triangles[i].points) center += glm::dvec3(p) / 3.0;
        const NumberedReceiver receiver = numbers.numbered({glm::vec3(center), m, of_mesh});
        add(map.shading(triangles, receiver) == LightMap::none, triangles[i].points);
        continue;
      }
      const bool is_lit = parts.front().is_lit;
      if (merge && std::ranges::all_of(parts, [&](const Part& part) { return part.is_lit == is_lit; }))
        add(is_lit, triangles[i].points);
      else
        for (const Part& part : parts) add(part.is_lit, found.corners_of(part));
    }
  }
  return detail;
}

}  // namespace gnomon::two_pass_object
