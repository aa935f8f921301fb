// The list of metrics, and those that are counted pixel by pixel.
#include "measure/score/metrics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>

#include "measure/frame/boundary.h"
#include "measure/score/metrics_area.h"

namespace gnomon {

namespace {

std::optional<double> share(double part, double whole) {
  if (whole == 0) return std::nullopt;
  return part / whole;
}

// --- bins: each is a metric of its own ----------------------------------------------------------------------------------

/// Values above the bin before it, up to `to`.
struct Bin {
  std::string_view name;
  double to;
  std::string_view sentence;
};

/// Distance in pixels to the nearest pixel beside the reference's shadow boundary, which is 0 on both its sides.
constexpr Bin edge_bins_table[] = {
    {"wrong_rate_edge_0_1", 1, "Wrong rate of the pixels of T within 1 px of the reference's shadow boundary."},
    {"wrong_rate_edge_1_2", 2, "Wrong rate of the pixels of T more than 1 px, at most 2 px from it."},
    {"wrong_rate_edge_2_4", 4, "Wrong rate of the pixels of T more than 2 px, at most 4 px from it."},
    {"wrong_rate_edge_4_8", 8, "Wrong rate of the pixels of T more than 4 px, at most 8 px from it."},
    {"wrong_rate_edge_8_up", INFINITY, "Wrong rate of the pixels of T more than 8 px from it, or where there is none."},
};

/// Sine of the angle between surface and direction to the light (of an area light: to its center). Class G holds what is
/// below 2.
constexpr Bin angle_bins_table[] = {
    {"wrong_rate_angle_2_10", 0.17364817766693033, "Wrong rate of the pixels of T that the light meets at up to 10 degrees."},
    {"wrong_rate_angle_10_30", 0.5, "Wrong rate of the pixels of T that it meets at 10 to 30 degrees."},
    {"wrong_rate_angle_30_60", 0.8660254037844386, "Wrong rate of the pixels of T that it meets at 30 to 60 degrees."},
    {"wrong_rate_angle_60_90", 1.001, "Wrong rate of the pixels of T that it meets at 60 to 90 degrees."},
};

/// Counts the pixels of T by the bin of their value, in parallel; counts are the same in any order.
template <std::size_t bin_count, class Value>
std::vector<BinCount> count_bins(const Evidence& e, const Bin (&bins)[bin_count], const Value& value) {
  using Counts = std::array<BinCount, bin_count>;
  const auto count = [&](const tbb::blocked_range<std::size_t>& pixels, Counts counts) {
    for (std::size_t i = pixels.begin(); i < pixels.end(); ++i) {
      if (e.classes[i] != PixelClass::T) continue;
      const double v = value(i);
      std::size_t k = 0;
      while (k + 1 < bin_count && v > bins[k].to) ++k;
      ++counts[k].tested;
      counts[k].wrong += e.is_wrong(i);
    }
    return counts;
  };
  const auto add = [](Counts a, const Counts& b) {
    for (std::size_t k = 0; k < bin_count; ++k) {
      a[k].tested += b[k].tested;
      a[k].wrong += b[k].wrong;
    }
    return a;
  };
  const Counts counts = tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, e.mask.size(), 16384), Counts{}, count, add);
  return {counts.begin(), counts.end()};
}

/// A row for each bin of a table.
template <const std::vector<BinCount>& (Scoring::*counts)() const, std::size_t... k>
void add_rows(std::vector<MetricInfo>& rows, const Bin* bins, std::index_sequence<k...>) {
  const auto value = []<std::size_t bin>(const Scoring& s) -> std::optional<double> {
    const std::vector<BinCount>& all = (s.*counts)();
    return all.empty() ? std::nullopt : share(all[bin].wrong, all[bin].tested);
  };
  (rows.push_back({bins[k].name, "", "lower", bins[k].sentence,
                   [](const Scoring& s) { return decltype(value){}.template operator()<k>(s); }}),
   ...);
}

// --- other rows ---------------------------------------------------------------------------------------------------------

/// The same for every technique.
std::optional<double> snapping_floor(const Scoring& s) {
  const std::span<const std::uint8_t> snapping = s.evidence().snapping;
  if (snapping.empty()) return std::nullopt;
  return share(static_cast<double>(std::ranges::count(snapping, 1)), s.error_counts().tested);
}

constexpr MetricInfo counted_rows[] = {
    {"wrong_rate", "", "lower", "Share of the tested pixels (T) whose visibility is off by more than one half.",
     [](const Scoring& s) { return share(s.error_counts().wrong, s.error_counts().tested); }},
    {"wrong_rate_all", "", "lower", "The same over every pixel that faces the light (T, G, S and U): nothing hidden.",
     [](const Scoring& s) { return share(s.error_counts().wrong_facing, s.error_counts().facing); }},
    {"false_dark_rate", "", "lower", "Share of T that is dark where the reference is lit.",
     [](const Scoring& s) { return share(s.error_counts().false_dark, s.error_counts().tested); }},
    {"false_lit_rate", "", "lower", "Share of T that is lit where the reference is dark.",
     [](const Scoring& s) { return share(s.error_counts().false_lit, s.error_counts().tested); }},
    {"error_mean", "", "lower", "Mean over T of the absolute difference from the reference.",
     [](const Scoring& s) { return share(s.error_counts().error_sum, s.error_counts().tested); }},
    {"displacement_mean", "px", "lower", "Mean distance between the shadow boundaries of technique and reference, both ways.",
     [](const Scoring& s) { return s.displacement().mean; }},
    {"displacement_p95", "px", "lower", "95th percentile of the same distances.",
     [](const Scoring& s) { return s.displacement().p95; }},
    {"tested_share", "", "higher", "Share of the pixels facing the light that is tested (T).",
     [](const Scoring& s) { return share(s.error_counts().tested, s.error_counts().facing); }},
    {"snapping_floor", "", "",
     "Share of T whose exact answer flips when the sample point moves by 1/512 px: no rasterizer can promise a lower wrong "
     "rate.",
     snapping_floor},
};

/// Share of the pixels tested in this frame and the one before that change sides in the technique and not in the reference.
std::optional<double> instability(const Scoring& scoring) {
  const Evidence &now = scoring.evidence(), *before = now.previous;
  if (!before || before->mask.size() != now.mask.size()) return std::nullopt;
  std::size_t tested = 0, flips = 0;
  const auto flip = [](float a, float b) { return is_lit(a) != is_lit(b); };
  for (std::size_t i = 0; i < now.mask.size(); ++i) {
    if (now.classes[i] != PixelClass::T || before->classes[i] != PixelClass::T) continue;
    ++tested;
    flips += flip(now.mask[i], before->mask[i]) && !flip(now.reference[i], before->reference[i]);
  }
  return share(flips, tested);
}

/// Of a scene seen at a slant, pixels far away cover more than near ones: areas of surface are compared, not pixels.
std::optional<double> shadow_area_ratio(const Scoring& scoring) {
  const Evidence& e = scoring.evidence();
  if (!e.gbuffer) return std::nullopt;
  return share(shadow_area(*e.gbuffer, e.classes, e.mask), shadow_area(*e.gbuffer, e.classes, e.reference));
}

constexpr MetricInfo other_rows[] = {
    {"shadow_area_ratio", "ratio", "",
     "Area of surface in cast shadow over the pixels of T, technique to reference; best at 1.", shadow_area_ratio},
    {"instability", "", "lower",
     "Share of the pixels of T in this frame of a path and the one before that change in the technique and not in the "
     "reference.",
     instability},
    {"penumbra_error_mean", "", "lower",
     "Mean of the absolute difference from the reference over T in the penumbra band: within 2 px of 0.02 < V < 0.98.",
     [](const Scoring& s) { return s.softness().band_mean; }},
    {"penumbra_error_rms", "", "lower", "Root of the mean square of the same differences.",
     [](const Scoring& s) { return s.softness().band_rms; }},
    {"outside_error_mean", "", "lower", "Mean of the absolute difference over T outside the penumbra band.",
     [](const Scoring& s) { return s.softness().outside_mean; }},
    {"outside_error_rms", "", "lower", "Root of the mean square of the same differences.",
     [](const Scoring& s) { return s.softness().outside_rms; }},
    {"umbra_area_ratio", "ratio", "", "Pixels of T with V up to 0.02, technique to reference; best at 1.",
     [](const Scoring& s) { return s.softness().umbra_ratio; }},
    {"penumbra_area_ratio", "ratio", "", "Pixels of T with 0.02 < V < 0.98, technique to reference; best at 1.",
     [](const Scoring& s) { return s.softness().penumbra_ratio; }},
    {"penumbra_width_ratio", "ratio", "",
     "Median of the widths of penumbra (0.8 / slope of V) where V is in 0.1 .. 0.9 in both, technique to reference; best at 1.",
     [](const Scoring& s) { return s.softness().width_ratio; }},
    {"penumbra_shift", "px", "",
     "Median distance from the reference's line V = 0.5 to the technique's; positive: shadow too large.",
     [](const Scoring& s) { return s.softness().shift; }},
    {"penumbra_noise", "", "lower",
     "Root mean square over T in the band of what a 5 x 5 median takes from the technique's mask.",
     [](const Scoring& s) { return s.softness().noise; }},
    {"ssim", "index", "higher", "Structural similarity of the shaded picture and the reference's, on luma; 1 is equal.",
     [](const Scoring& s) { return s.likeness().ssim; }},
    {"flip", "index", "lower",
     "Mean LDR-FLIP of the same two pictures at 67 pixels per degree: what a viewer notices who sees them in turn.",
     [](const Scoring& s) { return s.likeness().flip; }},
};

ErrorCounts count(const Evidence& e) {
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

}  // namespace

std::span<const MetricInfo> metric_infos() {
  static const std::vector<MetricInfo> rows = [] {
    std::vector<MetricInfo> all(std::begin(counted_rows), std::end(counted_rows));
    add_rows<&Scoring::edge_bins>(all, edge_bins_table, std::make_index_sequence<std::size(edge_bins_table)>());
    add_rows<&Scoring::angle_bins>(all, angle_bins_table, std::make_index_sequence<std::size(angle_bins_table)>());
    all.insert(all.end(), std::begin(other_rows), std::end(other_rows));
    return all;
  }();
  return rows;
}

namespace {

/// What `make` answers, made at the first call.
template <class Value, class Make>
const Value& once(std::optional<Value>& value, const Make& make) {
  if (!value) value = make();
  return *value;
}

}  // namespace

const ErrorCounts& Scoring::error_counts() const {
  return once(error_counts_, [&] { return count(evidence_); });
}

const Displacement& Scoring::displacement() const {
  return once(displacement_, [&] { return measure_displacement(evidence_); });
}

const std::vector<float>& Scoring::edge_distance() const {
  const Evidence& e = evidence_;
  return once(edge_distance_, [&] {
    return distance_transform(shadow_boundary(e.reference, e.classes, e.width, e.height), e.width, e.height);
  });
}

const std::vector<BinCount>& Scoring::edge_bins() const {
  return once(edge_bins_, [&] {
    return count_bins(evidence_, edge_bins_table, [&distance = edge_distance()](std::size_t i) { return distance[i]; });
  });
}

const std::vector<BinCount>& Scoring::angle_bins() const {
  return once(angle_bins_, [&]() -> std::vector<BinCount> {
    const Evidence& e = evidence_;
    if (!e.gbuffer || !e.light) return {};
    const glm::dvec4 light = homogeneous(*e.light);
    return count_bins(e, angle_bins_table, [&](std::size_t i) {
      const glm::dvec3 to = to_light(light, e.gbuffer->position(i));
      return glm::dot(glm::dvec3(e.gbuffer->normal(i)), to) / glm::length(to);
    });
  });
}

const Softness& Scoring::softness() const {
  return once(softness_, [&] { return measure_softness(evidence_); });
}

const Likeness& Scoring::likeness() const {
  return once(likeness_, [&] { return measure_likeness(evidence_); });
}

}  // namespace gnomon
