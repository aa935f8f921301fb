// The list of metrics, and all that need no file of their own.
#include <algorithm>

#include "measure/score/coverage_error.h"
#include "measure/score/metrics.h"

namespace gnomon {

namespace {

std::optional<double> share(double part, double whole) { return whole == 0 ? std::nullopt : std::optional(part / whole); }

template <const std::vector<BinCount>& (Scoring::*bins)() const, std::size_t k>
std::optional<double> wrong_rate_in_bin(const Scoring& s) {
  const std::vector<BinCount>& all = (s.*bins)();
  return all.empty() ? std::nullopt : share(all[k].wrong, all[k].tested);
}

/// The same for every technique.
std::optional<double> snapping_floor(const Scoring& s) {
  const std::span<const std::uint8_t> snapping = s.evidence().snapping;
  if (snapping.empty()) return std::nullopt;
  return share(static_cast<double>(std::ranges::count(snapping, 1)), s.error_counts().tested);
}

/// Share of the pixels tested in this frame and the one before that change sides in the technique and not in the reference.
std::optional<double> instability(const Scoring& scoring) {
  const Evidence &now = scoring.evidence(), *before = now.previous;
  if (!before || before->mask.size() != now.mask.size()) return std::nullopt;
  std::size_t tested = 0, flips = 0;
  const auto flip = [&](float a, float b) {
    return now.kind == AnswerKind::transmitted ? gnomon::is_wrong(a, b, now.kind) : is_lit(a) != is_lit(b);
  };
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

std::optional<double> wrong_area_of(const Scoring& scoring) {
  const Evidence& e = scoring.evidence();
  return e.gbuffer && scoring.error_counts().tested > 0 ? std::optional(wrong_area(e)) : std::nullopt;
}

/// What the reference's own noise adds is taken off, which leaves less than nothing where that is all there is.
std::optional<double> radiosity_error(const Scoring& scoring) {
  const Evidence& e = scoring.evidence();
  double excess = 0, whole = 0;
  for (std::size_t k = 0; k < e.global_picture.size(); ++k) {
    if (e.classes[k / 3] == PixelClass::B) continue;
    const double right = e.global_reference[k], error = e.global_error[k], off = e.global_picture[k] - right;
    excess += off * off - error * error;
    whole += right * right;
  }
  return whole > 0 ? std::optional(std::sqrt(std::max(excess, 0.0) / whole)) : std::nullopt;
}

/// Mean over T of |values[i] - of[i]|; nothing where `values` is empty.
std::optional<double> mean_over_tested(const Scoring& s, std::span<const float> values, std::span<const float> of) {
  const Evidence& e = s.evidence();
  double sum = 0;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (e.classes[i] == PixelClass::T) sum += std::abs(static_cast<double>(values[i]) - of[i]);
  return values.empty() ? std::nullopt : share(sum, s.error_counts().tested);
}

template <std::size_t k>
std::optional<double> glass_error_behind(const Scoring& s) {
  return s.glass_error().by_surfaces[k];
}

template <std::size_t k>
std::optional<double> error_by_seam(const Scoring& s) {
  const std::vector<SeamBin>& bins = s.seam_bins();
  return bins.empty() ? std::nullopt : share(bins[k].error_sum, static_cast<double>(bins[k].tested));
}

template <std::size_t k>
std::optional<double> share_by_seam(const Scoring& s) {
  const std::vector<SeamBin>& bins = s.seam_bins();
  return bins.empty() ? std::nullopt : share(static_cast<double>(bins[k].tested), static_cast<double>(s.error_counts().tested));
}

constexpr std::string_view floor_sentence =
    "Distance of the metric of that name from its best value by the reference's noise alone: half of its rays against all "
    "of them. Under lights with area.";

constexpr std::string_view coverage_floor_sentence =
    "What the noise of the truth over the pixel alone makes of the metric of that name: half of its eye rays against all of "
    "them. A smaller number cannot be told from 0.";

/// A floor is itself measured: that of a right mask may lie a little above.
constexpr double floor_margin = 1.1;

std::optional<double> floor_of(std::optional<double> of_half, double best) {
  return of_half ? std::optional(floor_margin * std::abs(*of_half - best)) : std::nullopt;
}

template <int power>
std::optional<double> coverage_error_floor(const Scoring& s) {
  return floor_of(coverage_error(s.evidence(), s.evidence().pixel_half, power), 0);
}

template <std::optional<double> Softness::*metric, int best>
std::optional<double> softness_floor(const Scoring& s) {
  return floor_of(s.softness_of_half().*metric, best);
}

constexpr MetricInfo metric_rows[] = {
    {"error", "", "lower",
     "Mean of |V - V_ref| over the tested pixels (T). Every row is judged by it. Under several lights together V is the "
     "share of their light that a pixel receives.",
     [](const Scoring& s) { return share(s.error_counts().error_sum, static_cast<double>(s.error_counts().tested)); }},
    {"constant_error", "", "",
     "Error of the best mask of one value everywhere. A row that does not beat it is never called best.", constant_error},
    {"coverage_error_mean", "", "lower",
     "Mean of |V - V_pixel| over the pixels of T of whose eye rays at least half are kept. V_pixel is the mean of V_ref over the "
     "pixel (--truth-over). Under lights without area.",
     [](const Scoring& s) { return coverage_error(s.evidence(), s.evidence().mask, 1); }},
    {"coverage_error_rms", "", "lower", "Root of the mean square of the same differences.",
     [](const Scoring& s) { return coverage_error(s.evidence(), s.evidence().mask, 2); }},
    {"coverage_error_mean_floor", "", "", coverage_floor_sentence, coverage_error_floor<1>},
    {"coverage_error_rms_floor", "", "", coverage_floor_sentence, coverage_error_floor<2>},
    {"coverage_constant_error", "", "",
     "The coverage_error_mean of the best mask of one value everywhere. A row that does not beat it is never called best by "
     "coverage_error_mean or coverage_error_rms.",
     coverage_constant_error},
    {"wrong_rate", "", "lower",
     "Share of T whose visibility is off by more than one half, or is one half where the reference is lit. Where casters let a "
     "part of a light without area through, off by more than 1/20.",
     [](const Scoring& s) { return share(s.error_counts().wrong, s.error_counts().tested); }},
    {"wrong_rate_all", "", "lower", "Wrong rate over every pixel that faces the light (T, G, S and U).",
     [](const Scoring& s) { return share(s.error_counts().wrong_facing, s.error_counts().facing); }},
    {"false_dark_rate", "", "lower",
     "Share of T that is dark where the reference is lit; behind glass too dark by more than 1/20.",
     [](const Scoring& s) { return share(s.error_counts().false_dark, s.error_counts().tested); }},
    {"false_lit_rate", "", "lower",
     "Share of T that is lit where the reference is dark; behind glass too light by more than 1/20.",
     [](const Scoring& s) { return share(s.error_counts().false_lit, s.error_counts().tested); }},
    {"error_floor", "", "",
     "Error that the reference's noise alone makes under a light with area: the error of half of its rays against all of "
     "them. A smaller error cannot be told from 0.",
     [](const Scoring& s) { return floor_of(mean_over_tested(s, s.evidence().reference_half, s.evidence().reference), 0); }},
    {"other_error_mean", "", "lower",
     "Mean over T of the absolute difference from the other share of a light with area: from its share of irradiance for "
     "techniques that estimate the share of area, and vice versa.",
     [](const Scoring& s) { return mean_over_tested(s, s.evidence().other_reference, s.evidence().mask); }},
    {"received_error_rms", "", "lower",
     "Root mean square over T of the difference in irradiance, as a share of the reference's root mean square. An unlit "
     "picture has 100 %.",
     [](const Scoring& s) { return s.light_error().rms; }},
    {"received_error_mean", "W/m2", "lower", "Mean over T of the absolute difference in irradiance.",
     [](const Scoring& s) { return s.light_error().mean; }},
    {"radiosity_error", "", "lower",
     "Root mean square of the difference in all light toward the eye (global picture), over channels and all pixels but "
     "background, as a share of the reference's. The part of the reference's noise is subtracted, down to 0. Needs "
     "global_samples.",
     radiosity_error},
    {"displacement_mean", "px", "lower", "Mean distance between the shadow boundaries of technique and reference, both ways.",
     [](const Scoring& s) { return s.displacement().mean; }},
    {"displacement_p95", "px", "lower", "95th percentile of the same distances.",
     [](const Scoring& s) { return s.displacement().p95; }},
    {"displacement_mean_m", "m", "lower",
     "Mean distance in the scene between the points of the same boundaries, each to the nearest of the other, both ways. Pixels "
     "that cover nothing (wrong_area_m2) are left out.",
     [](const Scoring& s) { return s.displacement().mean_m; }},
    {"displacement_p95_m", "m", "lower", "95th percentile of the same distances.",
     [](const Scoring& s) { return s.displacement().p95_m; }},
    {"wrong_area_m2", "m2", "lower",
     "Area of surface that the wrong pixels of T cover. A pixel covers what its corner rays cut out of the plane of its point; "
     "nothing where the distance along them more than triples across it.",
     wrong_area_of},
    {"tested_share", "", "higher", "Share of the pixels facing the light that is tested (T).",
     [](const Scoring& s) { return share(s.error_counts().tested, s.error_counts().facing); }},
    {"snapping_floor", "", "",
     "Share of T whose exact answer flips when the sample point moves by 1/512 px. No rasterizer can promise a lower wrong "
     "rate.",
     snapping_floor},
    {"wrong_rate_edge_0_1", "", "lower", "Wrong rate of the pixels of T within 1 px of the reference's shadow boundary.",
     wrong_rate_in_bin<&Scoring::edge_bins, 0>},
    {"wrong_rate_edge_1_2", "", "lower", "Wrong rate of the pixels of T more than 1 px, at most 2 px from it.",
     wrong_rate_in_bin<&Scoring::edge_bins, 1>},
    {"wrong_rate_edge_2_4", "", "lower", "Wrong rate of the pixels of T more than 2 px, at most 4 px from it.",
     wrong_rate_in_bin<&Scoring::edge_bins, 2>},
    {"wrong_rate_edge_4_8", "", "lower", "Wrong rate of the pixels of T more than 4 px, at most 8 px from it.",
     wrong_rate_in_bin<&Scoring::edge_bins, 3>},
    {"wrong_rate_edge_8_up", "", "lower", "Wrong rate of the pixels of T more than 8 px from it, or where there is none.",
     wrong_rate_in_bin<&Scoring::edge_bins, 4>},
    {"wrong_rate_angle_2_10", "", "lower", "Wrong rate of the pixels of T that the light meets at up to 10 degrees.",
     wrong_rate_in_bin<&Scoring::angle_bins, 0>},
    {"wrong_rate_angle_10_30", "", "lower", "Wrong rate of the pixels of T that it meets at 10 to 30 degrees.",
     wrong_rate_in_bin<&Scoring::angle_bins, 1>},
    {"wrong_rate_angle_30_60", "", "lower", "Wrong rate of the pixels of T that it meets at 30 to 60 degrees.",
     wrong_rate_in_bin<&Scoring::angle_bins, 2>},
    {"wrong_rate_angle_60_90", "", "lower", "Wrong rate of the pixels of T that it meets at 60 to 90 degrees.",
     wrong_rate_in_bin<&Scoring::angle_bins, 3>},
    {"error_seam_0_1", "", "lower",
     "Error of the pixels of T within 1 px of a seam: where two slices, faces or pages of the technique's images meet on one "
     "surface.",
     error_by_seam<0>},
    {"error_seam_1_2", "", "lower", "Error of the pixels of T more than 1 px, at most 2 px from one.", error_by_seam<1>},
    {"error_seam_2_4", "", "lower", "Error of the pixels of T more than 2 px, at most 4 px from one.", error_by_seam<2>},
    {"error_seam_4_8", "", "lower", "Error of the pixels of T more than 4 px, at most 8 px from one.", error_by_seam<3>},
    {"error_seam_8_16", "", "lower", "Error of the pixels of T more than 8 px, at most 16 px from one.", error_by_seam<4>},
    {"error_seam_16_32", "", "lower", "Error of the pixels of T more than 16 px, at most 32 px from one.", error_by_seam<5>},
    {"error_seam_32_64", "", "lower", "Error of the pixels of T more than 32 px, at most 64 px from one.", error_by_seam<6>},
    {"error_seam_64_up", "", "lower", "Error of the pixels of T more than 64 px from one, or where the picture has none.",
     error_by_seam<7>},
    {"seam_share_0_1", "", "", "Share of T within 1 px of a seam.", share_by_seam<0>},
    {"seam_share_1_2", "", "", "Share of T more than 1 px, at most 2 px from one.", share_by_seam<1>},
    {"seam_share_2_4", "", "", "Share of T more than 2 px, at most 4 px from one.", share_by_seam<2>},
    {"seam_share_4_8", "", "", "Share of T more than 4 px, at most 8 px from one.", share_by_seam<3>},
    {"seam_share_8_16", "", "", "Share of T more than 8 px, at most 16 px from one.", share_by_seam<4>},
    {"seam_share_16_32", "", "", "Share of T more than 16 px, at most 32 px from one.", share_by_seam<5>},
    {"seam_share_32_64", "", "", "Share of T more than 32 px, at most 64 px from one.", share_by_seam<6>},
    {"seam_share_64_up", "", "", "Share of T more than 64 px from one, or where the picture has none.", share_by_seam<7>},
    {"shadow_area_ratio", "ratio", "",
     "Area of surface in cast shadow over the pixels of T, technique to reference; best at 1.", shadow_area_ratio},
    {"instability", "", "lower",
     "Share of the pixels of T, in this frame of a path and the one before, that change in the technique and not in the "
     "reference.",
     instability, MetricInfo::Of::two_frames},
    {"flicker_1_60", "", "lower",
     "Root mean square of e(t + 1/60 s) - e(t) with e = V - V_ref, over the frames of a row on a path, at the pixels that show "
     "one surface point and are T from t to t + 1/60 s. Where the camera moves, e(t) is that of the pixel nearest to it. "
     "Needs frames at a multiple of 60 Hz. A mask that never changes has little of it: read it beside error.",
     nullptr, MetricInfo::Of::row},
    {"flicker_1_15", "", "lower", "The same of e(t + 1/15 s) - e(t).", nullptr, MetricInfo::Of::row},
    {"flicker_1_4", "", "lower", "The same of e(t + 1/4 s) - e(t).", nullptr, MetricInfo::Of::row},
    {"temporal_sd", "", "lower",
     "Root mean, over the pixels that show one surface point and are T in all frames, of the variance of V - V_ref over time. "
     "Needs a camera that stands still, as do flips.",
     nullptr, MetricInfo::Of::row},
    {"false_flips", "1/s", "lower",
     "Flips per second and pixel: V crosses 1/2 between two frames, and V_ref crosses it the same way in no frame within 0.1 s.",
     nullptr, MetricInfo::Of::row},
    {"late_flips", "1/s", "lower", "Flips per second and pixel that V_ref has in another frame within 0.1 s, before or after.",
     nullptr, MetricInfo::Of::row},
    {"steady_share", "", "",
     "Share of the pixels of T in the first frame of a row on a path that show the same surface point and are T in all its "
     "frames. Where the camera moves: share of the pixels of T that flicker_1_60 compares with an earlier one.",
     nullptr, MetricInfo::Of::row},
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
     "Width of the penumbra, technique to reference; best at 1. The width is 6 times the integral of V (1 - V) along a "
     "line across the penumbra. Needs ten lines that go from umbra to light in both.",
     [](const Scoring& s) { return s.softness().width_ratio; }},
    {"contact_hardening", "ratio", "",
     "How fast the penumbra widens with the distance to the caster, technique to reference; best at 1. Under lights with area.",
     [](const Scoring& s) { return s.softness().hardening; }},
    {"penumbra_shift", "px", "",
     "Shift of the shadow's edge along the same lines: the integral of V_ref - V. Positive: the shadow is too large.",
     [](const Scoring& s) { return s.softness().shift; }},
    {"penumbra_noise", "", "lower",
     "Root mean square of V - median_5x5(V) over the tested pixels of the penumbra band; V is the technique's mask.",
     [](const Scoring& s) { return s.softness().noise; }},
    {"penumbra_error_mean_floor", "", "", floor_sentence, softness_floor<&Softness::band_mean, 0>},
    {"penumbra_error_rms_floor", "", "", floor_sentence, softness_floor<&Softness::band_rms, 0>},
    {"outside_error_mean_floor", "", "", floor_sentence, softness_floor<&Softness::outside_mean, 0>},
    {"outside_error_rms_floor", "", "", floor_sentence, softness_floor<&Softness::outside_rms, 0>},
    {"umbra_area_ratio_floor", "ratio", "", floor_sentence, softness_floor<&Softness::umbra_ratio, 1>},
    {"penumbra_area_ratio_floor", "ratio", "", floor_sentence, softness_floor<&Softness::penumbra_ratio, 1>},
    {"penumbra_width_ratio_floor", "ratio", "", floor_sentence, softness_floor<&Softness::width_ratio, 1>},
    {"contact_hardening_floor", "ratio", "", floor_sentence, softness_floor<&Softness::hardening, 1>},
    {"penumbra_shift_floor", "px", "", floor_sentence, softness_floor<&Softness::shift, 0>},
    {"error_cold", "", "lower", "Error of the first picture of a sequence, of techniques that remember frames.", nullptr,
     MetricInfo::Of::sequence},
    {"error_settled", "", "lower",
     "Mean error of the last 16 of 64 pictures in which nothing moves, before the path where there is one. Of techniques that "
     "remember frames.",
     nullptr, MetricInfo::Of::sequence},
    {"ghost_half_life", "frames", "lower",
     "Frames after a jump until half of the error that it adds is gone. In rows of which the picture changes once.", nullptr,
     MetricInfo::Of::sequence},
    {"ghost_frames", "frames", "lower",
     "Frames after a jump until the error is at most 1.1 times the one before. In rows of which the picture changes once.",
     nullptr, MetricInfo::Of::sequence},
    {"transmittance_error_rms", "", "lower",
     "Root mean square of the difference from the reference over T, where casters let a part of the light through.",
     [](const Scoring& s) { return s.glass_error().rms; }},
    {"transmittance_error_p95", "", "lower", "95th percentile of the absolute difference over T, there.",
     [](const Scoring& s) { return s.glass_error().p95; }},
    {"transmittance_error_at_jumps", "", "lower",
     "Mean absolute difference over the pixels of T within 2 px of neighbors whose references differ by more than 1/20.",
     [](const Scoring& s) { return s.glass_error().near_jumps; }},
    {"transmittance_error_off_jumps", "", "lower", "The same over the other pixels of T.",
     [](const Scoring& s) { return s.glass_error().off_jumps; }},
    {"transmittance_error_0", "", "lower",
     "Mean absolute difference over the pixels of T whose way to the light crosses nothing, in such scenes.",
     glass_error_behind<0>},
    {"transmittance_error_1", "", "lower", "The same of ways through 1 surface that takes a part of the light.",
     glass_error_behind<1>},
    {"transmittance_error_2", "", "lower", "The same of ways through 2 surfaces.", glass_error_behind<2>},
    {"transmittance_error_3_4", "", "lower", "The same of ways through 3 or 4 surfaces.", glass_error_behind<3>},
    {"transmittance_error_5_up", "", "lower", "The same of ways through 5 surfaces or more.", glass_error_behind<4>},
    {hue_error_name, "", "lower",
     "Mean over the pixels tested in all three channels of the largest less the smallest signed difference among them, where "
     "glass colors the light.",
     [](const Scoring& s) { return measure_hue_error(s.evidence()); }},
    {"ssim", "index", "higher", "Structural similarity of the shaded picture and the reference's, on luma; 1 is equal.",
     [](const Scoring& s) { return s.likeness().ssim; }},
    {"flip", "index", "lower",
     "Mean LDR-FLIP of the same two pictures at 67 pixels per degree: the difference that a viewer notices who alternates "
     "between them.",
     [](const Scoring& s) { return s.likeness().flip; }},
};

}  // namespace

std::span<const MetricInfo> metric_infos() { return metric_rows; }

MetricInfo::Of metric_is_of(std::string_view name) {
  const auto info = std::ranges::find(metric_infos(), name, &MetricInfo::name);
  return info == metric_infos().end() ? MetricInfo::Of::frame : info->of;
}

}  // namespace gnomon
