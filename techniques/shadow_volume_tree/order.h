#pragma once
#include <gnomon/kit/parallel.h>

#include <utility>
#include <vector>

#include "nodes.h"

namespace gnomon::shadow_volume_tree {

/// The larger casters before the smaller ones, in classes by their longest edges, each four times as long as the next; within a
/// class in the order they came in. Where a large caster lies across a plane, the whole tree of that plane is visited from
/// everywhere; so it gets its own place before there are many planes.
inline void put_large_first(std::vector<Caster>& casters) {
  constexpr int smallest = -300, count = (300 + 260) / 4;  // squares of float32 lengths are 2^-298 .. 2^259
  std::vector<std::uint8_t> classes(casters.size());
  for_blocks(casters.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double square = 0;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 edge = glm::dvec3(casters[i].corners[(k + 1) % 3]) - glm::dvec3(casters[i].corners[k]);
        square = std::max(square, glm::dot(edge, edge));
      }
      classes[i] = static_cast<std::uint8_t>(count - 1 - (std::clamp(std::ilogb(square), smallest, 259) - smallest) / 4);
    }
  });
  std::size_t next[count + 1] = {};
  for (const std::uint8_t c : classes) ++next[c + 1];
  for (int c = 0; c < count; ++c) next[c + 1] += next[c];
  std::vector<Caster> sorted(casters.size());
  for (std::size_t i = 0; i < casters.size(); ++i) sorted[next[classes[i]]++] = casters[i];
  casters = std::move(sorted);
}

}  // namespace gnomon::shadow_volume_tree
