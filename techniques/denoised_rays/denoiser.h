#pragma once
#include <gnomon/kit/denoise/tiles.h>

#include <algorithm>

#include "reprojection.h"
#include "settings.h"

namespace gnomon::denoised_rays {

/// What is filtered in one frame: for each pixel the irradiance that was asked and the part of it that arrives.
struct FrameInput {
  const FilterGuides& guides;
  std::span<const std::uint8_t> faces;  ///< 1 where a pixel counts
  std::span<const float> asked, seen;
  std::span<const float> sigma;     ///< of filter width
  std::span<const Source> sources;  ///< where there is memory
  int source_width = 0;             ///< of the picture before
  bool has_changed = false;         ///< light or casters, since the frame before
};

/// What one frame leaves to the next: numbers for each pixel, row-major. seen / asked is the share.
struct History {
  UnsetVector<float> asked, seen, length;
  UnsetVector<float> mean, squares;  ///< of the shares of single frames; empty where nothing needs them

  void resize(std::size_t size, bool has_moments);
  std::size_t bytes() const;
};

/// The part a of the newest frame and the interval that the history's share is held to: a = 1 where there is no history.
struct Blend {
  float newest = 1, low = 0, high = 1;

  /// Of sums that are blended alike: monotone in both, so that what is seen stays below what was asked.
  float of(float now, float before) const { return newest * now + (1 - newest) * before; }
  /// The numerator of a history after its share is held to the interval; `asked` is its denominator.
  float held(float seen, float asked) const {
    if (!(asked > 0) || (low <= 0 && high >= 1)) return seen;
    return std::min(std::max(seen / asked, low), high) * asked;
  }
};

/// A mean over frames, then one over pixels. Both are linear in what is seen, with weights and intervals that this frame's
/// values decide once: `follow` passes other numerators through the very same ones.
class Denoiser {
 public:
  /// The next frame is the first.
  void forget() {
    has_stepped_ = false;
    begins_ = true;
  }
  /// The frame of the last `step` becomes the one before. Nothing where there was none since.
  void advance();
  /// Writes the share of every pixel that counts into `mask` and leaves all others.
  void step(const FrameInput& in, const Settings& settings, GuidedFilter& filter, std::span<float> mask);

  /// What a twin's numerators become, see Twin: `now` of this frame, `before` of the history of the frame before, where there
  /// is memory; `still` are numerators that are not blended, over the denominators of the blended ones. In place: `now` and
  /// `still` become filtered numerators, `asked` their denominators, `kept` what the next frame has for a history.
  struct Followers {
    std::span<const float> before;
    std::span<float> now, still, asked, kept;
  };
  void follow(const FrameInput& in, const Settings& settings, GuidedFilter& filter, const Followers& twin) const;
  /// Denominators of the last step, before the filter over pixels.
  std::span<const float> blended_asked() const { return blended_asked_; }
  /// Numerators alone, `pixel`'s and no other: what part of each pixel's share comes from there. Row-major.
  std::vector<float> reach_of(const FrameInput& in, const Settings& settings, std::size_t pixel) const;

  /// Frames that the history counts as, this one included; of the last step.
  std::span<const float> lengths() const { return next_.length; }
  /// Of the frame before.
  std::span<const float> last_lengths() const { return last_.length; }
  /// Variance of the shares before the filter over pixels; empty where no filter looks at it.
  std::span<const float> variance() const { return variance_; }
  std::size_t bytes() const;

 private:
  void resize(std::size_t size, const Settings& settings);
  void blend(const FrameInput& in, const Settings& settings, std::size_t pixel);
  void blend_all(const FrameInput& in, const Settings& settings);

  bool has_stepped_ = false, begins_ = true;
  History last_, next_;
  TileMap tiles_;
  UnsetVector<Blend> blends_;
  UnsetVector<float> blended_asked_, blended_seen_;  ///< before the filter over pixels
  UnsetVector<float> asked_, seen_;                  ///< and after it
  UnsetVector<float> variance_, variance_left_;      ///< before and after it
};

}  // namespace gnomon::denoised_rays
