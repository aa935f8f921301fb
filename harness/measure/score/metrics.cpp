// What several metrics share: counts of pixels, in all and by bins.
#include "measure/score/metrics.h"

#include <gnomon/kit/add_up.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "measure/frame/boundary.h"

namespace gnomon {

namespace {

/// Ends of the bins of distance in pixels to the nearest pixel beside the reference's shadow boundary, which is 0 on both its
/// sides. A bin holds the values above the one before it, up to its end.
constexpr double edge_bin_ends[] = {1, 2, 4, 8, INFINITY};

/// Ends of the bins of the sine of the angle between surface and direction to the light (of an area light: to its center): of
/// 10, 30, 60 and 90 degrees. Class G holds what is below 2.
constexpr double angle_bin_ends[] = {0.17364817766693033, 0.5, 0.8660254037844386, 1.001};

/// Counts the pixels of T by the bin of their value, in parallel; counts are the same in any order.
template <std::size_t bin_count, class Value>
std::vector<BinCount> count_bins(const Evidence& e, const double (&ends)[bin_count], const Value& value) {
  using Counts = std::array<BinCount, bin_count>;
  const auto count = [&](const tbb::blocked_range<std::size_t>& pixels, Counts counts) {
    for (std::size_t i = pixels.begin(); i < pixels.end(); ++i) {
      if (e.classes[i] != PixelClass::T) continue;
      const double v = value(i);
      std::size_t k = 0;
      while (k + 1 < bin_count && v > ends[k]) ++k;
      ++counts[k].tested;
      counts[k].wrong += e.is_wrong(i);
    }
    return counts;
  };
  const auto add = [](Counts a, const Counts& b) {
    for (std::size_t k = 0; k < bin_count; ++k) add_up(a[k], b[k], &BinCount::tested, &BinCount::wrong);
    return a;
  };
  const Counts counts = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, e.mask.size(), 16384), Counts{}, count, add);
  return {counts.begin(), counts.end()};
}

ErrorCounts count_errors(const Evidence& e) {
  ErrorCounts t;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (!e.faces_light(i)) continue;
    const bool wrong = e.is_wrong(i);
    ++t.facing;
    t.wrong_facing += wrong;
    if (e.classes[i] != PixelClass::T) continue;
    ++t.tested;
    t.error_sum += std::abs(e.mask[i] - e.reference[i]);
    if (!wrong) continue;
    ++t.wrong;
    ++(e.mask[i] < e.reference[i] ? t.false_dark : t.false_lit);
  }
  return t;
}

std::vector<BinCount> count_angle_bins(const Evidence& e) {
  if (!e.gbuffer || !e.light) return {};
  const glm::dvec4 light = homogeneous_of_center(*e.light);
  return count_bins(e, angle_bin_ends, [&](std::size_t i) {
    const glm::dvec3 to = to_light(light, e.gbuffer->position(i));
    return glm::dot(glm::dvec3(e.gbuffer->normal(i)), to) / glm::length(to);
  });
}

std::vector<BinCount> count_edge_bins(const Scoring& scoring) {
  const std::vector<float>& distance = scoring.edge_distance();
  return count_bins(scoring.evidence(), edge_bin_ends, [&](std::size_t i) { return distance[i]; });
}

std::vector<float> measure_edge_distance(const Evidence& e) {
  return distance_transform(shadow_boundary(e.reference, e.classes, e.width, e.height, e.kind), e.width, e.height);
}

Softness measure_softness_of_half(const Evidence& e) {
  if (e.reference_half.empty()) return {};
  Evidence half = e;
  half.mask = e.reference_half;
  return measure_softness(half);
}

/// What `make` returns for these arguments, made at the first call.
template <class Value, class Make, class Of>
const Value& once(std::optional<Value>& value, const Make& make, const Of& of) {
  if (!value) value = make(of);
  return *value;
}

}  // namespace

const ErrorCounts& Scoring::error_counts() const { return once(error_counts_, count_errors, evidence_); }
const Displacement& Scoring::displacement() const { return once(displacement_, measure_displacement, evidence_); }
const std::vector<float>& Scoring::edge_distance() const { return once(edge_distance_, measure_edge_distance, evidence_); }
const std::vector<BinCount>& Scoring::edge_bins() const { return once(edge_bins_, count_edge_bins, *this); }
const std::vector<BinCount>& Scoring::angle_bins() const { return once(angle_bins_, count_angle_bins, evidence_); }
const std::vector<SeamBin>& Scoring::seam_bins() const { return once(seam_bins_, measure_seam_bins, evidence_); }
const Softness& Scoring::softness() const { return once(softness_, measure_softness, evidence_); }
const Softness& Scoring::softness_of_half() const { return once(softness_of_half_, measure_softness_of_half, evidence_); }
const LightError& Scoring::light_error() const { return once(light_error_, measure_light_error, *this); }
const GlassError& Scoring::glass_error() const { return once(glass_error_, measure_glass_error, evidence_); }
const Likeness& Scoring::likeness() const { return once(likeness_, measure_likeness, *this); }

}  // namespace gnomon
