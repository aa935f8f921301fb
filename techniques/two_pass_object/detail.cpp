#include "detail.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::two_pass_object {

namespace {

/// A lit or dark part of a triangle, in one cell.
struct Part {
  std::uint32_t triangle;
  bool is_lit;
  std::uint32_t first, count;  ///< corners, of its patch
};

/// All parts that the cells of a patch hold.
struct PatchParts {
  std::vector<Part> parts;
  std::vector<glm::dvec3> corners;

  void add(std::uint32_t triangle, bool is_lit, std::span<const Corner> polygon) {
    parts.push_back({triangle, is_lit, static_cast<std::uint32_t>(corners.size()), static_cast<std::uint32_t>(polygon.size())});
    for (const Corner& corner : polygon) corners.push_back(corner.at);
  }
  std::span<const glm::dvec3> corners_of(const Part& part) const { return {corners.data() + part.first, part.count}; }
};

/// Clips the cells once more, now without a margin and for the dark parts too.
std::vector<PatchParts> find_parts(const Triangles& triangles, const LightMap& map) {
  std::vector<PatchParts> found(map.patch_count());
  for_blocks(found.size(), 1, [&](std::size_t patch, std::size_t) {
    PatchParts& mine = found[patch];
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
  return found;
}

/// The parts by triangle; those of one stay in the order of the cells.
class SortedParts {
 public:
  struct Place {
    std::uint32_t patch, part;
  };
  SortedParts(const std::vector<PatchParts>& found, std::size_t triangle_count) : begin_(triangle_count + 1, 0) {
    for (const PatchParts& some : found)
      for (const Part& part : some.parts) ++begin_[part.triangle + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    places_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t p = 0; p < found.size(); ++p)
      for (std::uint32_t k = 0; k < found[p].parts.size(); ++k) places_[next[found[p].parts[k].triangle]++] = {p, k};
  }
  std::span<const Place> of(std::uint32_t triangle) const {
    return {places_.data() + begin_[triangle], begin_[triangle + 1] - begin_[triangle]};
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<Place> places_;
};

}  // namespace

SurfaceDetail make_detail(const Scene& scene, const Triangles& triangles, const LightMap& map, bool merge) {
  const std::vector<PatchParts> found = find_parts(triangles, map);
  const SortedParts sorted(found, triangles.size());
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
      const std::span<const SortedParts::Place> parts = sorted.of(i);
      const auto part_of = [&](const SortedParts::Place& p) -> const Part& { return found[p.patch].parts[p.part]; };
      if (parts.empty()) {
        // Nothing of it is wider than epsilon: one point stands for all.
        glm::dvec3 center(0);
        for (const glm::vec3& p : triangles[i].points) center += glm::dvec3(p) / 3.0;
        const NumberedReceiver receiver = numbers.numbered({glm::vec3(center), m, of_mesh});
        add(map.shading(triangles, receiver) == LightMap::none, triangles[i].points);
        continue;
      }
      const bool is_lit = part_of(parts[0]).is_lit;
      if (merge && std::ranges::all_of(parts, [&](const auto& p) { return part_of(p).is_lit == is_lit; }))
        add(is_lit, triangles[i].points);
      else
        for (const SortedParts::Place& p : parts) add(part_of(p).is_lit, found[p.patch].corners_of(part_of(p)));
    }
  }
  return detail;
}

}  // namespace gnomon::two_pass_object
