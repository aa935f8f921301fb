#include "measure/score/together.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "measure/picture/shading.h"

namespace gnomon {

namespace {

/// Sums over the lights, in double: the order of the lights then does not show in a float.
struct ShareSums {
  explicit ShareSums(std::size_t pixels)
      : mask(pixels), shown(pixels), reference(pixels), half(pixels), variance(pixels), worst(pixels) {}
  std::vector<double> mask, shown, reference, half, variance;
  std::vector<double> worst;  ///< the largest error of one light that has a cause, as light received
};

void add(const Evidence& e, const std::vector<double>& received, Together& whole, ShareSums& sums) {
  for (std::size_t i = 0; i < received.size(); ++i) {
    whole.received[i] += received[i];
    whole.classes[i] = std::max(whole.classes[i], e.classes[i]);  // from B to T
    const double reference = received[i] * e.reference[i];
    const double mask = e.classes[i] == PixelClass::T ? received[i] * e.mask[i] : reference;
    sums.reference[i] += reference;
    const bool has_half = e.classes[i] == PixelClass::T && !e.reference_half.empty();
    sums.half[i] += has_half ? received[i] * e.reference_half[i] : reference;
    sums.mask[i] += mask;
    sums.shown[i] += received[i] * e.mask[i];
    if (!e.reference_error.empty()) {
      const double error = received[i] * e.reference_error[i];
      sums.variance[i] += error * error;
    }
    if (e.causes.empty() || e.causes[i] == Cause::none) continue;
    if (const double error = std::abs(mask - reference); error > sums.worst[i]) {
      sums.worst[i] = error;
      whole.causes[i] = e.causes[i];
    }
  }
}

}  // namespace

Together together(std::span<const Evidence> lights) {
  assert(!lights.empty());
  const GBuffer& gbuffer = *lights.front().gbuffer;
  const std::size_t pixels = gbuffer.size();
  Together whole{.scene = lights.front().scene,
                 .gbuffer = &gbuffer,
                 .received = std::vector<double>(pixels),
                 .mask = {},
                 .reference = {},
                 .shown = {},
                 .reference_error = {},
                 .reference_half = {},
                 .classes = std::vector<PixelClass>(pixels, PixelClass::B),
                 .causes = {},
                 .own_causes = {lights.front().own_causes.begin(), lights.front().own_causes.end()}};
  if (std::ranges::any_of(lights, [](const Evidence& e) { return !e.causes.empty(); }))
    whole.causes.assign(pixels, Cause::none);
  ShareSums sums(pixels);
  for (const Evidence& e : lights) add(e, received_light(gbuffer, *e.light), whole, sums);

  whole.mask.assign(pixels, 1.0f);
  whole.reference = whole.shown = whole.mask;
  if (std::ranges::any_of(lights, [](const Evidence& e) { return !e.reference_error.empty(); }))
    whole.reference_error.assign(pixels, 0.0f);
  if (std::ranges::any_of(lights, [](const Evidence& e) { return !e.reference_half.empty(); }))
    whole.reference_half.assign(pixels, 1.0f);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (whole.received[i] == 0) continue;
    whole.mask[i] = static_cast<float>(sums.mask[i] / whole.received[i]);
    whole.shown[i] = static_cast<float>(sums.shown[i] / whole.received[i]);
    whole.reference[i] = static_cast<float>(sums.reference[i] / whole.received[i]);
    if (!whole.reference_half.empty()) whole.reference_half[i] = static_cast<float>(sums.half[i] / whole.received[i]);
    if (!whole.reference_error.empty())
      whole.reference_error[i] = static_cast<float>(std::sqrt(sums.variance[i]) / whole.received[i]);
  }
  return whole;
}

Evidence Together::evidence() const {
  return {.width = gbuffer->width,
          .height = gbuffer->height,
          .classes = classes,
          .reference = reference,
          .mask = mask,
          .causes = causes,
          .scene = scene,
          .gbuffer = gbuffer,
          .reference_error = reference_error,
          .reference_half = reference_half,
          .received = received,
          .own_causes = own_causes,
          .kind = AnswerKind::received};
}

}  // namespace gnomon
