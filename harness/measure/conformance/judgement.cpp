#include "measure/conformance/judgement.h"

#include <algorithm>
#include <cmath>

#include "measure/statistics/distributions.h"
#include "measure/statistics/statistics.h"

namespace gnomon::conformance {

Tally tally(const std::vector<float>& mask, const World::Truthful& truth, const Technique& technique, bool takes_all) {
  Tally t;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    const auto why = technique.explain(i);
    if (why && !why->covered && !takes_all) continue;
    ++t.tested;
    t.dark += truth.mask[i] < 0.5f;
    // Stricter than a metric: an answer of one half is wrong, also over a dark truth.
    const bool is_wrong = std::abs(mask[i] - truth.mask[i]) >= 0.5f;
    if (is_wrong && t.wrong++ == 0) t.first_wrong = i;
  }
  return t;
}

void judge_exact(Trial& trial, const Support& support, const Tally& found, const std::vector<float>& mask,
                 const World::Truthful& truth, const GBuffer& gbuffer) {
  if (found.wrong > 0)
    trial.found(fmt::format("{} of {} tested pixels are wrong; the mask is {}, the reference {}", found.wrong, found.tested,
                            mask[found.first_wrong], truth.mask[found.first_wrong]),
                found.first_wrong, gbuffer);
  const std::size_t all = count_classes(truth.classes)[static_cast<std::size_t>(PixelClass::T)];
  if (support.kind() == Support::Kind::full && found.tested != all)
    trial.found(fmt::format("its support is full, but it covers {} of {} tested pixels", found.tested, all));
}

SoftTally judge_exact_soft(Trial& trial, const std::vector<float>& mask, const World::Truthful& truth, const GBuffer& gbuffer) {
  SoftTally found;
  std::size_t beyond_4 = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    ++found.tested;
    found.penumbra += truth.mask[i] > 0 && truth.mask[i] < 1;
    const float off = std::abs(mask[i] - truth.mask[i]);
    beyond_4 += off > 4 * truth.error[i];
    if (off <= 12 * truth.error[i]) continue;
    trial.found(
        fmt::format("the mask is {}, the reference {} with a standard error of {}", mask[i], truth.mask[i], truth.error[i]), i,
        gbuffer);
    return found;
  }
  const auto most = most_by_chance(found.penumbra, 2 * student_tail(4, 7), 1e-6);
  trial.expect(beyond_4 <= most,
               fmt::format("{} pixels are more than 4 standard errors off; of {} in penumbrae {} may be by chance", beyond_4,
                           found.penumbra, most));
  return found;
}

ErrorSums wrong_pixels(const Tally& found) {
  return {static_cast<double>(found.wrong), static_cast<double>(found.dark), static_cast<double>(found.dark / 4), found.tested,
          found.first_wrong};
}

ErrorSums summed_errors(const std::vector<float>& mask, const World::Truthful& truth, const Technique* covers) {
  ErrorSums off;
  float worst = -1;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    if (covers)
      if (const auto why = covers->explain(i); why && !why->covered) continue;
    const float error = std::abs(mask[i] - truth.mask[i]);
    if (error > worst) off.first = i;
    worst = std::max(worst, error);
    ++off.tested;
    off.technique += error;
    off.unshadowed += 1 - truth.mask[i];
  }
  off.quarter = off.unshadowed / 4;
  return off;
}

void judge_promise(Trial& trial, const Support& support, const ErrorSums& off, std::string_view what, const GBuffer& gbuffer) {
  const double share = 100.0 / static_cast<double>(std::max<std::size_t>(off.tested, 1));
  const std::string is =
      fmt::format("{} {:.3g} %, {:.3g} % without shadows", what, share * off.technique, share * off.unshadowed);
  if (const auto promised = support.most_wrong()) {
    if (100 * *promised < share * off.technique)
      trial.found(fmt::format("{}; it promises at most {:.3g} %", is, 100 * *promised), off.first, gbuffer);
  } else if (!(off.technique < off.quarter)) {
    trial.found(fmt::format("{}; it has to be below {:.3g} %, a quarter of that", is, share * off.quarter), off.first, gbuffer);
  }
}

void judge_glass(Trial& trial, const Light& light, const Technique& technique, const std::vector<float>& mask,
                 const World::Truthful& truth, const GBuffer& gbuffer, double least) {
  constexpr double most_rounding = 1.0 / 1024;
  double error = 0, unshadowed = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    if (const auto why = technique.explain(i); why && !why->covered) continue;
    const double off = std::abs(static_cast<double>(mask[i]) - truth.mask[i]);
    error += off;
    unshadowed += 1 - static_cast<double>(truth.mask[i]);
    if (trial.entry().about.promise == Promise::exact && !has_area(light) && off > most_rounding)
      return trial.found(fmt::format("the mask is {}, the reference {}", mask[i], truth.mask[i]), i, gbuffer);
  }
  trial.expect(unshadowed >= least, fmt::format("shadows that it covers add up to {} pixels: too few to judge by", unshadowed));
  trial.expect(error < unshadowed / 4,
               fmt::format("the tested pixels are off by {:.1f} in all, by {:.1f} without shadows; less than a quarter may be",
                           error, unshadowed));
}

}  // namespace gnomon::conformance
