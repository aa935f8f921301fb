// What is wrong with the light that reaches surfaces, and with the picture that a viewer sees of it.
#include <tbb/parallel_invoke.h>

#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/score/metrics.h"
#include "measure/score/perceptual.h"

namespace gnomon {

std::span<const double> Scoring::received() const {
  const Evidence& e = evidence_;
  if (!e.received.empty() || !e.gbuffer || !e.light) return e.received;
  if (!received_) received_ = received_light(*e.gbuffer, *e.light);
  return *received_;
}

LightError measure_light_error(const Scoring& scoring) {
  const Evidence& e = scoring.evidence();
  const std::span<const double> received = scoring.received();
  if (received.empty()) return {};
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
Likeness measure_likeness(const Scoring& scoring) {
  const Evidence& e = scoring.evidence();
  const std::span<const double> received = scoring.received();
  if (!e.scene || received.empty()) return {};
  const auto shaded = [&](std::span<const float> mask) { return shade(*e.scene, *e.gbuffer, received, mask); };
  Picture ours, theirs;
  tbb::parallel_invoke([&] { ours = shaded(e.mask); }, [&] { theirs = shaded(e.reference); });
  return {ssim(theirs, ours), flip(theirs, ours)};
}

}  // namespace gnomon
