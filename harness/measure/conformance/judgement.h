#pragma once
// How masks are judged by what a technique promises, on pixels of class T and against the truth of the geometry that it sees.
#include "measure/conformance/trial.h"

namespace gnomon::conformance {

/// Pixels of class T, all or those that the technique covers, and what is wrong about them.
struct Tally {
  std::size_t tested = 0, dark = 0, wrong = 0, first_wrong = 0;
};
Tally tally(const std::vector<float>& mask, const World::Truthful& truth, const Technique& technique, bool takes_all = false);

/// An exact technique is wrong at no pixel of the tally. With full support the tally holds every tested pixel.
void judge_exact(Trial& trial, const Support& support, const Tally& found, const std::vector<float>& mask,
                 const World::Truthful& truth, const GBuffer& gbuffer);

/// Tested pixels under a light with area, and those of them that see a part of it.
struct SoftTally {
  std::size_t tested = 0, penumbra = 0;
};
/// An exact technique is within 4 standard errors of the reference, except at as many pixels as chance allows, and within 12
/// everywhere.
SoftTally judge_exact_soft(Trial& trial, const std::vector<float>& mask, const World::Truthful& truth, const GBuffer& gbuffer);

/// The error of a sampled technique and of a mask without shadows: a count of wrong pixels, or a sum of errors.
struct ErrorSums {
  double technique = 0, unshadowed = 0;
  double quarter = 0;                 ///< of the latter: the upper limit where nothing is promised
  std::size_t tested = 0, first = 0;  ///< the first pixel that is wrong, or the worst
};
ErrorSums wrong_pixels(const Tally& found);
/// Over all tested pixels, or those alone that the technique covers.
ErrorSums summed_errors(const std::vector<float>& mask, const World::Truthful& truth, const Technique* covers = nullptr);

/// A technique that promises a share keeps it, any other is below a quarter of a mask without shadows. `what` begins the
/// finding: "pixels wrong:".
void judge_promise(Trial& trial, const Support& support, const ErrorSums& off, std::string_view what, const GBuffer& gbuffer);

/// Where glass lets parts of the light through: a technique is off by less than a quarter of what no shadows are off by, and an
/// exact one nowhere but by rounding under a light without area. Shadows have to add up to `least` pixels.
void judge_glass(Trial& trial, const Light& light, const Technique& technique, const std::vector<float>& mask,
                 const World::Truthful& truth, const GBuffer& gbuffer, double least);

}  // namespace gnomon::conformance
