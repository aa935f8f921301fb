#pragma once
#include "denoiser.h"

namespace gnomon::denoised_rays {

/// What a pixel's answer is wrong by, signed. F is the filter over pixels with the answer's own weights, a the part of the
/// newest frame; of V, the shares that rays found, and R, the exact ones, H and H_R are the histories:
///
///   out - R = [F(aV + (1-a)H) - F(aR + (1-a)H_R)] + [F(aR + (1-a)H_R) - F(R)] + [F(R) - R]
///              residual_noise                        stale_history              over_blur
struct ErrorParts {
  double residual_noise = 0, stale_history = 0, over_blur = 0;
};
/// From the answer, F(aR + (1-a)H_R), F(R) and R. The parts add up to out - exact, whatever the other two are.
inline ErrorParts error_parts(double out, double twin, double filtered, double exact) {
  return {out - twin, twin - filtered, filtered - exact};
}

/// A channel of exact shares that goes through the weights and intervals of the answer beside it.
class Twin {
 public:
  void forget();
  /// The frame of the last `part` becomes the one before.
  void advance();
  /// Whether it has seen all `frame` frames of the sequence before this one.
  bool has_seen(std::uint32_t frame) const { return frames_ == frame; }
  /// The parts at every pixel, 0 where it does not count. `out` is what `denoiser` answered in its last step, for `in`. Asked
  /// again, it answers the same.
  std::vector<ErrorParts> part(const Denoiser& denoiser, const FrameInput& in, const Settings& settings,
                               std::span<const float> exact, std::span<const float> out);

 private:
  std::uint32_t frames_ = 0;
  bool has_stepped_ = false;
  std::vector<float> last_, next_;  ///< numerators of histories
  GuidedFilter filter_;
};

}  // namespace gnomon::denoised_rays
