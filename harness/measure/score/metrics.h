#pragma once
#include <gnomon/gbuffer.h>

#include <cmath>

#include "measure/cause/causes.h"
#include "measure/frame/pixel_truth.h"

namespace gnomon {

/// Everything that scoring one mask may read. Arrays are width * height, row-major.
struct Evidence {
  int width = 0, height = 0;
  std::span<const PixelClass> classes;
  std::span<const float> reference, mask;
  std::span<const Cause> causes;  ///< see find_causes; empty when they were not looked for
  /// What the pixels show; null where a test has none. Metrics that need it are then not defined.
  const Scene* scene = nullptr;
  const GBuffer* gbuffer = nullptr;
  const Light* light = nullptr;
  const Evidence* previous = nullptr;  ///< the frame before, on a path
  /// 1 where a rasterizer's rounding may turn the answer over (see find_snapping); empty when it was not found.
  std::span<const std::uint8_t> snapping = {};
  /// Where the answer is a fraction, else empty: standard errors of `reference`, what half of its rays say, and the other
  /// number that is true of the light.
  std::span<const float> reference_error = {}, reference_half = {}, other_reference = {};
  std::span<const float> caster_distance = {};  ///< meters, see SoftReference
  /// Behind casters that let a part of the light through, else empty: how many surfaces are on the way (Reference::surfaces).
  std::span<const std::uint8_t> surfaces = {};
  /// Under lights without area whose row asks for it, else empty: the truth over the pixel (see PixelTruth).
  std::span<const float> pixel_mean = {}, pixel_half = {};
  std::span<const std::uint8_t> pixel_kept = {};
  /// Of several lights together (see Together), else empty: what a pixel would receive of them without shadows. Mask and
  /// reference are shares of it, and `light` is null.
  std::span<const double> received = {};
  /// All light toward the eye, three floats a pixel, as the technique and as the reference have it, with the reference's
  /// standard errors; empty where it was not requested, and of a technique that has no such picture.
  std::span<const float> global_picture = {}, global_reference = {}, global_error = {};
  std::span<const CauseInfo> own_causes = {};  ///< that the technique has beside the common ones
  std::span<const std::uint32_t> parts = {};   ///< Technique::image_parts; empty of a technique of one part
  AnswerKind kind = AnswerKind::binary;        ///< of the reference: what the mask is compared with
  /// Where lights are of several channels (see Together), else empty: each channel's own. A metric is the mean over them.
  std::vector<Evidence> channels = {};

  bool faces_light(std::size_t i) const { return classes[i] > PixelClass::F; }
  /// Whether the truth over the pixel, which must be there, tests a pixel.
  bool is_tested_over_pixel(std::size_t i) const { return classes[i] == PixelClass::T && pixel_kept[i] >= least_kept_rays; }
  bool is_wrong(std::size_t i) const { return gnomon::is_wrong(mask[i], reference[i], kind); }
  /// Whether a pixel has a cause when causes were looked for: it is tested, and wrong; under a light with area, off at all.
  bool wants_cause(std::size_t i) const {
    return classes[i] == PixelClass::T && (reference_error.empty() ? is_wrong(i) : mask[i] != reference[i]);
  }
};

/// Pixels of one mask counted once.
struct ErrorCounts {
  std::size_t tested = 0, facing = 0;         ///< |T|, |T+G+S+U|
  std::size_t wrong = 0, wrong_facing = 0;    ///< wrong in T, wrong in T+G+S+U
  std::size_t false_dark = 0, false_lit = 0;  ///< of the wrong in T
  double error_sum = 0;                       ///< sum over T of |mask - reference|
};

/// Pixels of T that lie in one bin, and the wrong ones among them.
struct BinCount {
  std::size_t tested = 0, wrong = 0;
};

/// Pixels of T that lie as far from the technique's nearest seam, and what they are off by.
struct SeamBin {
  std::size_t tested = 0;
  double error_sum = 0;  ///< of |mask - reference|
};

/// The metrics where the reference has penumbra: 0.02 < V < 0.98 at a pixel of T. The band is all within 2 px of such pixels.
struct Softness {
  std::optional<double> band_mean, band_rms;        ///< of |mask - reference| over T in the band
  std::optional<double> outside_mean, outside_rms;  ///< over the rest of T
  std::optional<double> umbra_ratio, penumbra_ratio, width_ratio, shift, noise, hardening;
};

/// Distances between the shadow boundaries of technique and reference, both ways; none when one side has none.
struct Displacement {
  std::optional<double> mean = {}, p95 = {};  ///< pixels
  /// Meters in the scene; none without a G-buffer, and where one side has only pixels that cover nothing (see pixel_area).
  std::optional<double> mean_m = {}, p95_m = {};
};

/// What is wrong with the light that pixels of T receive, as irradiance.
struct LightError {
  std::optional<double> mean;  ///< of the absolute difference
  std::optional<double> rms;   ///< of the difference, as a share of that of the reference
};

/// The metrics behind casters that let a part of the light through: of |mask - reference| over T.
struct GlassError {
  std::optional<double> rms, p95;
  std::optional<double> near_jumps, off_jumps;  ///< means within 2 px of where the reference jumps by over 1/20, and elsewhere
  /// Means where the way crosses 0, 1, 2, 3 to 4, 5 surfaces or more and nothing opaque.
  std::array<std::optional<double>, 5> by_surfaces;
};

/// How different the shaded pictures of mask and reference look.
struct Likeness {
  std::optional<double> ssim, flip;
};

/// What several metrics share, each made at its first use. The evidence must outlive it. Not for two threads at once.
class Scoring {
 public:
  explicit Scoring(const Evidence& evidence)
      : evidence_(evidence), channels_(evidence.channels.begin(), evidence.channels.end()) {}
  const Evidence& evidence() const { return evidence_; }
  /// Of its evidence's channels.
  const std::vector<Scoring>& channels() const { return channels_; }
  const ErrorCounts& error_counts() const;
  const Displacement& displacement() const;
  /// Distance in pixels of every pixel to the reference's shadow boundary; infinity when it has none.
  const std::vector<float>& edge_distance() const;
  /// Bins of the distance to the reference's boundary, and of the angle of light to surface; empty without a G-buffer.
  const std::vector<BinCount>& edge_bins() const;
  const std::vector<BinCount>& angle_bins() const;
  /// Bins of the distance to the technique's nearest seam; empty of a technique of one part.
  const std::vector<SeamBin>& seam_bins() const;
  const Softness& softness() const;
  /// Of what half of the reference's rays say, as if that were the mask.
  const Softness& softness_of_half() const;
  /// Irradiance of every pixel without casters, of all lights together; empty where neither light nor that is known.
  std::span<const double> received() const;
  const LightError& light_error() const;
  const GlassError& glass_error() const;
  const Likeness& likeness() const;

 private:
  const Evidence& evidence_;
  std::vector<Scoring> channels_;
  mutable std::optional<ErrorCounts> error_counts_;
  mutable std::optional<Displacement> displacement_;
  mutable std::optional<std::vector<float>> edge_distance_;
  mutable std::optional<std::vector<BinCount>> edge_bins_, angle_bins_;
  mutable std::optional<std::vector<SeamBin>> seam_bins_;
  mutable std::optional<Softness> softness_, softness_of_half_;
  mutable std::optional<std::vector<double>> received_;  ///< of one light
  mutable std::optional<LightError> light_error_;
  mutable std::optional<GlassError> glass_error_;
  mutable std::optional<Likeness> likeness_;
};

/// One metric is one row. A value is nothing where it is not defined, and shown so.
struct MetricInfo {
  /// What has a value: a frame; a frame of a path together with the one before; all frames of a path (TimeScore); pictures in
  /// the order in which a technique remembers them (MemoryScore).
  enum class Of : std::uint8_t { frame, two_frames, row, sequence };
  std::string_view name, unit;
  std::string_view better;  ///< "lower", "higher" or ""
  std::string_view sentence;
  std::optional<double> (*value)(const Scoring&);  ///< null where a frame has none
  Of of = Of::frame;
  /// One more whenever the metric has another value for the same masks: editions name the version that they have.
  int version = 1;
};
std::span<const MetricInfo> metric_infos();
/// Of the metric of that name; of a name that is none, `frame`.
MetricInfo::Of metric_is_of(std::string_view name);
/// Metrics of pixels by their distance to a seam, which need Technique::image_parts: a bin's mean error and its share of T.
inline constexpr std::string_view seam_error_prefix = "error_seam_", seam_share_prefix = "seam_share_";
inline bool is_of_seams(std::string_view metric) {
  return metric.starts_with(seam_error_prefix) || metric.starts_with(seam_share_prefix);
}
/// The metric that compares channels, which those of one do not have.
inline constexpr std::string_view hue_error_name = "hue_error";

// The bodies of metrics that fill a file of their own.
Displacement measure_displacement(const Evidence& evidence);
std::vector<SeamBin> measure_seam_bins(const Evidence& evidence);
Softness measure_softness(const Evidence& evidence);
LightError measure_light_error(const Scoring& scoring);
GlassError measure_glass_error(const Evidence& evidence);
std::optional<double> measure_hue_error(const Evidence& evidence);
Likeness measure_likeness(const Scoring& scoring);

/// Square meters that pixel i covers on the plane through its point, across its normal: the exact area of the quadrilateral
/// that the pixel's four corner rays cut out. 0 for background, and for a pixel so flat to the eye's ray that the distance to
/// the plane more than triples from the nearest to the farthest corner: what it covers is not what its center shows.
/// `camera` is that of the G-buffer.
double pixel_area(const Camera& camera, const GBuffer& gbuffer, std::size_t i);

/// Square meters of surface in cast shadow: the area of every pixel of T times 1 - its visibility.
double shadow_area(const GBuffer& gbuffer, std::span<const PixelClass> classes, std::span<const float> mask);
/// Square meters of surface that the wrong pixels of T cover. The evidence has a G-buffer.
double wrong_area(const Evidence& evidence);

}  // namespace gnomon
