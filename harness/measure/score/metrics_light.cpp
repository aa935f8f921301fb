// What is wrong with the light that reaches surfaces, and with the picture that a viewer sees of it.
#include <tbb/parallel_invoke.h>

#include <cmath>

#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/score/metrics.h"
#include "measure/score/perceptual.h"

namespace gnomon {

LightError measure_light_error(const Evidence& e) {
  if (!e.gbuffer || (!e.light && e.received.empty())) return {};
  const std::vector<double> of_one = e.received.empty() ? received_light(*e.gbuffer, *e.light) : std::vector<double>();
  const std::span<const double> received = e.received.empty() ? std::span(of_one) : e.received;
  double tested = 0, sum = 0, squares = 0, whole = 0;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    const double difference = received[i] * (static_cast<double>(e.mask[i]) - e.reference[i]);
    const double right = received[i] * e.reference[i];
    ++tested;
    sum += std::abs(difference);
    squares += difference * difference;
    whole += right * right;
  }
  return {tested > 0 ? std::optional(sum / tested) : std::nullopt,
          whole > 0 ? std::optional(std::sqrt(squares / whole)) : std::nullopt};
}

/// What a viewer sees of a wrong mask: the shaded picture against the reference's.
Likeness measure_likeness(const Evidence& e) {
  if (!e.scene || !e.gbuffer || (!e.light && e.received.empty())) return {};
  const auto shaded = [&](std::span<const float> mask) {
    return e.light ? shade(*e.scene, *e.gbuffer, *e.light, mask) : shade(*e.scene, *e.gbuffer, e.received, mask);
  };
  Picture ours, theirs;
  tbb::parallel_invoke([&] { ours = shaded(e.mask); }, [&] { theirs = shaded(e.reference); });
  return {ssim(theirs, ours), flip(theirs, ours)};
}

}  // namespace gnomon
