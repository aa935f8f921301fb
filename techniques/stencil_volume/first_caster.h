#pragma once
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/geometry/edges.h>

#include <algorithm>
#include <concepts>
#include <optional>

namespace stencil_volume {
using namespace gnomon;

/// The boxes of all triangles of an adjacency.
class CasterTree : public BoxTree {
 public:
  explicit CasterTree(const EdgeAdjacency& adjacency) : BoxTree(boxes(adjacency)) {}

 private:
  static std::vector<Bounds> boxes(const EdgeAdjacency& adjacency) {
    std::vector<Bounds> bounds(adjacency.triangles().size());
    for (std::size_t t = 0; t < bounds.size(); ++t) bounds[t].add(adjacency.corners(t).points);
    return bounds;
  }
};

/// The first triangle of the scene before its masks were cut, by number, that is on a way and for which is_part(triangle).
template <std::predicate<std::uint32_t> IsPart>
std::optional<std::uint64_t> first_caster(const CasterTree& tree, const EdgeAdjacency& adjacency, const CutMasks& cut,
                                          const Segment& way, const IsPart& is_part) {
  std::optional<std::uint64_t> first;
  tree.any(SegmentSlabs(way), 0, [&](std::uint32_t place) {
    const std::uint32_t t = tree.order()[place];
    if (is_part(t) && crosses(way, adjacency.corners(t)) != Crossing::none)
      first = std::min<std::uint64_t>(first.value_or(UINT64_MAX), cut.source(t));
    return false;
  });
  return first;
}

}  // namespace stencil_volume
