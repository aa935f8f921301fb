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
  if (e.kind != AnswerKind::transmitted) {
    for (std::size_t i = 0; i < marked.size(); ++i) marked[i] &= !is_lit(mask[i]);
    return marked;
  }
  // Any two shares may have an edge between them: the darker one of each pair of neighbors is its dark side.
  std::vector<std::uint8_t> rim(marked.size());
  const auto compare = [&](std::size_t i, std::size_t j) {
    if (marked[i] && marked[j] && is_wrong(mask[i], mask[j], e.kind)) rim[mask[i] < mask[j] ? i : j] = 1;
  };
  for (int y = 0; y < e.height; ++y)
    for (int x = 0; x < e.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * e.width + x;
      if (x + 1 < e.width) compare(i, i + 1);
      if (y + 1 < e.height) compare(i, i + e.width);
    }
  return rim;
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
