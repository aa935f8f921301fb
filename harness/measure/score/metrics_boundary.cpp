// How far the shadow boundaries of technique and reference lie apart.
#include <algorithm>
#include <numeric>

#include "measure/frame/boundary.h"
#include "measure/score/metrics.h"
#include "measure/statistics/statistics.h"

namespace gnomon {

namespace {

/// The dark side of the boundary alone: with both sides marked, an edge displaced by k pixels would be found k - 1/2 away.
std::vector<std::uint8_t> shadow_rim(const Evidence& e, std::span<const float> mask) {
  std::vector<std::uint8_t> marked = shadow_boundary(mask, e.classes, e.width, e.height, e.kind);
  for (std::size_t i = 0; i < marked.size(); ++i) marked[i] &= !is_lit(mask[i]);
  return marked;
}

}  // namespace

Displacement measure_displacement(const Evidence& e) {
  const auto ours = shadow_rim(e, e.mask), theirs = shadow_rim(e, e.reference);
  const bool have_ours = std::ranges::count(ours, 1) > 0, have_theirs = std::ranges::count(theirs, 1) > 0;
  if (!have_ours && !have_theirs) return {0, 0};
  if (!have_ours || !have_theirs) return {};
  const auto to_ours = distance_transform(ours, e.width, e.height), to_theirs = distance_transform(theirs, e.width, e.height);
  std::vector<double> distances;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i]) distances.push_back(to_theirs[i]);
    if (theirs[i]) distances.push_back(to_ours[i]);
  }
  return {std::accumulate(distances.begin(), distances.end(), 0.0) / static_cast<double>(distances.size()),
          quantile(distances, 0.95)};
}

}  // namespace gnomon
