// The errors of a technique that remembers: of still frames they do not grow, and their parts add up.
#include <algorithm>
#include <cmath>
#include <span>

#include "measure/conformance/sequence.h"
#include "measure/conformance/trial.h"

namespace gnomon::conformance {
namespace {

double mean_error(const std::vector<float>& mask, const World::Truthful& truth) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (truth.classes[i] != PixelClass::T) continue;
    sum += std::abs(double(mask[i]) - truth.mask[i]);
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

// The error of few rays differs from frame to frame: means of 16 frames are compared. Half a unit in the last place of 1 is
// allowed beside 5 %: answers are rounded to float32.
void still_frames_settle(Trial& trial) {
  constexpr int frames = 64, compared = 16;
  std::size_t asked = 0;
  trial.under_each_light("sphere_over_plane:segments=24", [&](World& w, const GBuffer& gbuffer, const Light& light) {
    const World::Truthful truth = w.reference(gbuffer, light, trial.entry().about.estimates);
    const auto technique = trial.set_up();
    double early = 0, settled = 0;
    for (int n = 0; n < frames; ++n) {
      const std::vector<float> mask =
          n == 0 ? trial.answer(*technique, w.scene, light, gbuffer) : trial.resolve_next(*technique, gbuffer);
      if (n < compared) early += mean_error(mask, truth) / compared;
      if (n >= frames - compared) settled += mean_error(mask, truth) / compared;
    }
    if (!(settled <= 1.05 * early + 0x1p-24))
      trial.found(
          fmt::format("the mean error is {:.3g} % in the first {} of {} still frames and {:.3g} % in the last; at most "
                      "1.05 times as much may be",
                      100 * early, compared, frames, 100 * settled));
    ++asked;
  });
  if (asked == 0) trial.does_not_apply("it supports no light of this scene");
}

/// What both may be off by, of a share of 1: the contract's.
constexpr double sum_tolerance = 1e-6;

/// What error_terms said of one frame.
struct Told {
  const std::vector<ErrorTerm>& terms;
  const std::vector<float>& mask;
  const std::vector<float>& exact;
  std::size_t frame;
};

bool are_well_formed(Trial& trial, const Told& told) {
  const auto causes = trial.entry().about.causes;
  for (const ErrorTerm& term : told.terms) {
    if (std::ranges::find(causes, term.cause, &OwnCause::id) == causes.end()) {
      trial.found(
          fmt::format("frame {}: an error term is of '{}', which is no cause of About::causes", told.frame, term.cause));
      return false;
    }
    if (term.values.size() != told.mask.size()) {
      trial.found(fmt::format("frame {}: the error term {} has {} values for {} pixels", told.frame, term.cause,
                              term.values.size(), told.mask.size()));
      return false;
    }
  }
  return true;
}

bool has_sum(Trial& trial, const Told& told, std::size_t i, const GBuffer& gbuffer) {
  const double off = double(told.mask[i]) - told.exact[i];
  double sum = 0;
  for (const ErrorTerm& term : told.terms) sum += term.values[i];
  const bool holds = std::abs(sum - off) <= sum_tolerance;
  if (!holds)
    trial.found(
        fmt::format("frame {}: its error terms add up to {}, and the mask {} is off by {}", told.frame, sum, told.mask[i], off),
        i, gbuffer);
  return holds;
}

/// The largest term of the difference's sign, or one as large within the tolerance.
bool names_largest(Trial& trial, const Told& told, const Technique& technique, std::size_t i, const GBuffer& gbuffer) {
  const double off = double(told.mask[i]) - told.exact[i];
  if (!(std::abs(off) > sum_tolerance)) return true;
  const auto why = technique.explain(i);
  if (why && !why->covered) return true;
  double largest = 0, named = 0;
  for (const ErrorTerm& term : told.terms) {
    const double part = off > 0 ? term.values[i] : -term.values[i];
    largest = std::max(largest, part);
    if (why && why->cause == term.cause) named += part;
  }
  const bool holds = named >= largest - sum_tolerance;
  if (!holds)
    trial.found(fmt::format("frame {}: explain names '{}', whose error term is {}, and the largest is {}", told.frame,
                            why ? std::string(why->cause) : "", named, largest),
                i, gbuffer);
  return holds;
}

// Two objects have the same frames, and one of them is not queried.
void error_terms_add_up(Trial& trial) {
  const auto w = trial.enter("sphere_over_plane:segments=24");
  std::size_t told_count = 0;
  for (const Light& light : two_lights(trial, trial.supported_lights(w->scene))) {
    const Slides slides(w->scene, light, w->scene.views[0]);
    std::vector<Light> lights;
    std::vector<GBuffer> gbuffers;
    for (const Step& step : std::span(sequence_steps).first(4)) {  // those in which no vertex moves
      lights.push_back(slides.light(step.light));
      gbuffers.push_back(w->gbuffer(slides.view(step.view), 48, 27));
    }
    trial.at(light);
    const auto queried = trial.set_up(), silent = trial.set_up();
    for (Technique* const technique : {queried.get(), silent.get()}) technique->build(w->scene);
    for (std::size_t k = 0; k < gbuffers.size(); ++k) {
      const Light& there = lights[k];
      const GBuffer& gbuffer = gbuffers[k];
      if (!trial.support(w->scene, there)) break;
      for (Technique* const technique : {queried.get(), silent.get()}) technique->relight(there);
      const std::vector<float> mask = trial.resolve_next(*queried, gbuffer);
      trial.expect_same(mask, trial.resolve_next(*silent, gbuffer),
                        fmt::format("frame {}, with error_terms and explain called in each frame and without", k), &gbuffer);
      const World::Truthful truth = w->reference(gbuffer, there, trial.entry().about.estimates);
      const std::vector<ErrorTerm> terms = queried->error_terms(truth.mask);
      if (terms.empty()) continue;
      ++told_count;
      const Told told{terms, mask, truth.mask, k};
      if (!are_well_formed(trial, told)) return;
      // One finding of a kind in a frame is enough.
      bool adds_up = true, is_largest = true;
      for (std::size_t i = 0; i < gbuffer.size(); ++i) {
        if (!faces_light(w->scene, gbuffer, there, i)) continue;
        adds_up = adds_up && has_sum(trial, told, i, gbuffer);
        is_largest = is_largest && names_largest(trial, told, *queried, i, gbuffer);
      }
    }
  }
  if (told_count == 0) trial.does_not_apply("it gives no error terms");
}

}  // namespace

std::vector<Rule> sequence_error_rules() {
  return {
      Rule("still_frames_settle", still_frames_settle,
           {.applies_to = AppliesTo::remembering, .has_small_pictures = true, .sanitized = Sanitized::nothing},
           "Where nothing changes, the mean error of frames 48 to 63 is at most 1.05 times that of frames 0 to 15.",
           "See that the mean over frames is one of exact shares: no term may be biased, and no weight of the memory may grow "
           "beyond what its length deserves."),
      Rule("error_terms_add_up", error_terms_add_up,
           {.applies_to = AppliesTo::remembering, .has_small_pictures = true, .sanitized = Sanitized::part},
           "Where it gives error terms, they are of causes of its own and add up to the mask less what is exact, within 1e-6 "
           "wherever the light is faced, in every frame. Explain names the cause of the largest that has the sign of the "
           "difference. Calling both changes no mask.",
           "Put what is exact through the same filter, with the weights that the mask had, and begin the memory of that in the "
           "first frame after forget. Sum in double.",
           "A program gives no error terms: what is found comes from a stage before.")};
}

}  // namespace gnomon::conformance
