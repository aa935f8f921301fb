#pragma once
#include <gnomon/technique.h>

#include "map.h"

namespace gnomon::two_pass_object {

/// The polygons of a map, by clipping its cells once more, now without a margin and for the dark parts too. `merge`: a triangle
/// that is lit, or dark, throughout is one polygon.
inline SurfaceDetail make_detail(const Scene& scene, const Triangles& triangles, const LightMap& map, bool merge) {
  struct Part {
    std::uint32_t triangle;
    bool is_lit;
    std::uint32_t first, count;
  };
  struct Found {
    std::vector<Part> parts;
    std::vector<glm::dvec3> corners;
  };
  std::vector<Found> found(map.patch_count());
  for_blocks(found.size(), 1, [&](std::size_t patch, std::size_t) {
    Found& mine = found[patch];
    const auto add = [&](std::uint32_t triangle, bool is_lit, std::span<const Corner> corners) {
      mine.parts.push_back(
          {triangle, is_lit, static_cast<std::uint32_t>(mine.corners.size()), static_cast<std::uint32_t>(corners.size())});
      for (const Corner& corner : corners) mine.corners.push_back(corner.at);
    };
    map.for_leaves(triangles, patch, [&](int face, const Node& cell, std::span<const Footprint* const> footprints) {
      CellClipper clipper(triangles, face);
      clipper.clip(
          cell, 0, true, footprints,
          [&](std::uint32_t index, const Pieces& pieces) {
            for (std::size_t k = 0; k < pieces.size(); ++k) add(clipper.members()[index].triangle, true, pieces[k]);
          },
          [&](const CellClipper::Member& m, std::span<const Corner> part) {
            if (m.receives) add(m.triangle, false, part);
          });
    });
  });

  // Sort the parts by triangle; those of one stay in the order of the cells.
  struct Where {
    std::uint32_t patch, part;
  };
  std::vector<std::uint32_t> begin(triangles.size() + 1, 0);
  for (const Found& some : found)
    for (const Part& part : some.parts) ++begin[part.triangle + 1];
  for (std::size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<Where> sorted(begin.back());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  for (std::uint32_t p = 0; p < found.size(); ++p)
    for (std::uint32_t k = 0; k < found[p].parts.size(); ++k) sorted[next[found[p].parts[k].triangle]++] = {p, k};

  SurfaceDetail detail;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    for (std::uint32_t i = triangles.first_of(m); i < triangles.end_of(m); ++i) {
      if (!triangles.takes_part(i) || !triangles.is(i, Triangles::receives)) continue;
      const std::span<const Where> parts(sorted.data() + begin[i], begin[i + 1] - begin[i]);
      const auto add = [&](bool is_lit, auto&& corners) {
        detail.polygons.push_back({m, i - triangles.first_of(m), is_lit, static_cast<std::uint32_t>(detail.corners.size()),
                                   static_cast<std::uint32_t>(std::size(corners))});
        for (const auto& corner : corners) detail.corners.emplace_back(corner);
      };
      const auto part_of = [&](const Where& w) -> const Part& { return found[w.patch].parts[w.part]; };
      const bool is_one =
          std::ranges::all_of(parts, [&](const Where& w) { return part_of(w).is_lit == part_of(parts[0]).is_lit; });
      if (parts.empty()) {
        // Nothing of it is wider than epsilon: one point stands for all.
        glm::dvec3 center(0);
        for (const glm::vec3& p : triangles[i].points) center += glm::dvec3(p) / 3.0;
        add(map.shading(triangles, {.point = glm::vec3(center), .triangle = i}) == Asked::none, triangles[i].points);
      } else if (merge && is_one) {
        add(part_of(parts[0]).is_lit, triangles[i].points);
      } else {
        for (const Where& w : parts) {
          const Part& part = part_of(w);
          add(part.is_lit, std::span<const glm::dvec3>(found[w.patch].corners.data() + part.first, part.count));
        }
      }
    }
  }
  return detail;
}

}  // namespace gnomon::two_pass_object
