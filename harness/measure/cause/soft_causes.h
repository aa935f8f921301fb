#pragma once
#include "measure/cause/causes.h"
#include "measure/frame/pixel_windows.h"

namespace gnomon {

/// What a mask under a light with area is compared with: one of the two numbers that are true, with its standard errors.
struct SoftTruth {
  std::span<const float> share, error;
  explicit SoftTruth(const Attribution& attribution);
};

/// The cause of every pixel of T whose answer differs from the reference at all, under a light with area; `none` elsewhere.
std::vector<Cause> find_soft_causes(const Attribution& attribution);

/// Causes that samples of the light show (false_sample, horizon, hard_shadow, banding, noise).
class SampleCauses {
 public:
  SampleCauses(const Attribution& attribution, const SoftTruth& truth) : a_(attribution), truth_(truth) {}
  /// Of pixels and what is said of them, in order; `none` where the samples leave it open, or there are none.
  std::vector<Cause> of(std::span<const std::uint32_t> pixels, std::span<const std::optional<Explanation>> whys);

 private:
  Cause of(std::uint32_t pixel, const Explanation& why, bool is_shared) const;
  bool share_places(std::uint32_t pixel, const Explanation& why, std::uint32_t before, const Explanation& why_before) const;

  const Attribution& a_;
  const SoftTruth& truth_;
  bool is_shared_ = false;  ///< whether the last two neighbors that were compared sampled the same places
};

// What geometry and rays say about pixel i under a light with area.

/// The share of the light's whole figure that is above the pixel's horizon.
double share_above_horizon(const Attribution& attribution, std::size_t i);
/// What the casters leave of the light together, and what is made of that by treating each alone.
struct CasterShares {
  std::size_t count = 0;  ///< meshes that hide some of the light
  double together = 1, product = 1, least = 1;
};
CasterShares caster_shares(const Attribution& attribution, std::size_t i);
/// The share that is seen of a light of four times the size around the same center; nothing where the point lies inside of it.
std::optional<double> seen_of_larger(const Attribution& attribution, std::size_t i);
/// The share that the mask is compared with and its error, by other rays, as many as half of `error` requires.
std::pair<double, double> traced_again(const Attribution& attribution, std::size_t i, double error);

/// Causes that the mask shows beside the reference: no account of the technique is needed.
class PenumbraShapes {
 public:
  PenumbraShapes(const Attribution& attribution, const SoftTruth& truth);

  /// Whether the scene has transmission, and the reference at pixel i of T may be one that is dimmed evenly: no value of a
  /// penumbra.
  bool is_dimmed(std::size_t i) const { return has_transmission_ && !is_between(truth_.share, i); }
  /// 1 in a shadow of 8 pixels or more of which the mask has less than a tenth.
  const std::vector<std::uint8_t>& missing() const { return missing_; }
  /// hard_shadow, banding or noise; else `none`.
  Cause of_grain(std::size_t i) const;
  /// too_wide, too_narrow or shifted; else `none`.
  Cause of_form(std::size_t i) const;

 private:
  double error(std::size_t j) const { return static_cast<double>(a_.mask[j]) - truth_.share[j]; }
  /// 1 where these values are those of a penumbra: neither 0 nor 1, and in a scene with transmission is_between.
  std::vector<std::uint8_t> find_penumbra(std::span<const float> values) const;
  bool is_between(std::span<const float> values, std::size_t i) const;
  std::pair<double, double> range_within(std::span<const float> values, std::size_t i, int reach) const;
  Cause form_within(std::size_t i, int reach) const;
  bool is_incoherent(std::size_t i) const;
  bool is_in_levels(std::size_t i) const;
  bool is_plateau(std::size_t i) const;
  double width(std::size_t i) const;
  void find_roughness();

  const Attribution& a_;
  const SoftTruth& truth_;
  PixelWindows windows_;
  const bool has_transmission_;
  std::vector<std::uint8_t> is_soft_, is_own_soft_;   ///< 1 in the reference's penumbra and in the mask's
  std::vector<std::int32_t> nearest_;                 ///< pixel of the reference's penumbra nearest to each, -1 where none is
  std::vector<float> to_penumbra_, to_own_penumbra_;  ///< pixels, to the reference's and to the mask's
  std::vector<std::uint8_t> missing_;
  std::vector<float> rough_, energy_;  ///< of every pixel of T, see is_incoherent
};

}  // namespace gnomon
