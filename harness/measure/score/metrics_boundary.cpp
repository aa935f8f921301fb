// How far the shadow boundaries of technique and reference lie apart, in the picture and in the scene.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <numeric>

#include "measure/frame/boundary.h"
#include "measure/score/metrics.h"
#include "measure/score/near_places.h"
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

/// Where the marked pixels' points are, but for those that see their plane so flatly that they cover nothing.
std::vector<glm::dvec3> places_of(const Evidence& e, std::span<const std::uint8_t> marked) {
  const Camera camera(e.gbuffer->view, e.width, e.height);
  std::vector<glm::dvec3> places;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i] && pixel_area(camera, *e.gbuffer, i) > 0) places.emplace_back(e.gbuffer->position(i));
  return places;
}

/// From each place of either side to the nearest one of the other.
std::vector<double> ways_between(const std::vector<glm::dvec3>& ours, const std::vector<glm::dvec3>& theirs) {
  std::vector<double> ways(ours.size() + theirs.size());
  const auto measure = [&ways](const std::vector<glm::dvec3>& from, const std::vector<glm::dvec3>& to, std::size_t first) {
    const NearPlaces near(to);
    for_blocks(from.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ways[first + i] = near.distance(from[i]);
    });
  };
  measure(ours, theirs, 0);
  measure(theirs, ours, ours.size());
  return ways;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

Displacement measure_displacement(const Evidence& e) {
  const auto ours = shadow_rim(e, e.mask), theirs = shadow_rim(e, e.reference);
  const bool have_ours = std::ranges::count(ours, 1) > 0, have_theirs = std::ranges::count(theirs, 1) > 0;
  const std::optional<double> zero = e.gbuffer ? std::optional(0.0) : std::nullopt;
  if (!have_ours && !have_theirs) return {.mean = 0, .p95 = 0, .mean_m = zero, .p95_m = zero};
  if (!have_ours || !have_theirs) return {};
  const auto to_ours = distance_transform(ours, e.width, e.height), to_theirs = distance_transform(theirs, e.width, e.height);
  std::vector<double> distances;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i]) distances.push_back(to_theirs[i]);
    if (theirs[i]) distances.push_back(to_ours[i]);
  }
  Displacement found{.mean = mean_of(distances), .p95 = quantile(distances, 0.95)};
  if (!e.gbuffer) return found;
  const std::vector<glm::dvec3> our_places = places_of(e, ours), their_places = places_of(e, theirs);
  if (our_places.empty() || their_places.empty()) return found;
  const std::vector<double> meters = ways_between(our_places, their_places);
  found.mean_m = mean_of(meters);
  found.p95_m = quantile(meters, 0.95);
  return found;
}

}  // namespace gnomon
