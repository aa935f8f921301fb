// Whether a technique keeps its promise, on the pixels of class T and against the truth of the geometry that it sees.
#include <algorithm>

#include "measure/conformance/judgement.h"

namespace gnomon::conformance {
namespace {

// Zero wrong pixels in every scene, under both lights. With full support every tested pixel must be covered.
void exact(Trial& trial) {
  std::size_t tested = 0, dark = 0;
  for (const char* reference : {"sphere_over_plane", "box_city:count=30", "soup:count=200", "fence", "contact"}) {
    const auto w = trial.enter(reference);
    const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 160, 90);
    for (const Light& light : w->scene.lights) {
      const Support support = trial.support(w->scene, light);
      if (!support || has_area(light)) continue;
      trial.at(light);
      const auto technique = trial.set_up();
      const std::vector<float> mask = trial.answer(*technique, w->scene, light, gbuffer);
      const World::Truthful truth = w->reference(gbuffer, light);
      const Tally t = tally(mask, truth, *technique);
      judge_exact(trial, support, t, mask, truth, gbuffer);
      tested += t.tested;
      dark += t.dark;
    }
  }
  trial.at("");
  if (tested == 0) return trial.does_not_apply("it supports no light without area on these scenes");
  trial.expect(dark > 1000, fmt::format("{} dark pixels in all: too few to judge by", dark));  // the scenes do have shadows
}

// Under lights with area exact means: within 4 standard errors of the reference, except at as many pixels as chance allows, and
// nowhere beyond 12.
void exact_soft(Trial& trial) {
  std::size_t penumbra = 0, tested = 0;
  for (const char* reference : {"sphere_over_plane:segments=24", "box_city:count=12", "soup:count=60"}) {
    const auto w = trial.enter(reference);
    const GBuffer gbuffer = w->gbuffer();
    for (const Light& light : trial.supported_lights(w->scene)) {
      if (!has_area(light)) continue;
      trial.at(light);
      const std::vector<float> mask = trial.fresh_answer(w->scene, light, gbuffer);
      const World::Truthful truth = w->reference(gbuffer, light, trial.entry().about.estimates);
      const SoftTally found = judge_exact_soft(trial, mask, truth, gbuffer);
      tested += found.tested;
      penumbra += found.penumbra;
    }
  }
  trial.at("");
  if (tested == 0) return trial.does_not_apply("it supports no light with area on these scenes");
  trial.expect(penumbra > 1000, fmt::format("{} pixels of penumbrae in all: too few to judge by", penumbra));
}

void expect_worth(Trial& trial, const Support& support, const ErrorSums& off) {
  const auto promised = support.most_wrong();
  if (promised && *promised * static_cast<double>(off.tested) >= off.unshadowed)
    trial.found(fmt::format("it promises at most {:.3g} %, which is no better than no shadows at all: {:.3g} %",
                            100 * *promised, 100 * off.unshadowed / static_cast<double>(std::max<std::size_t>(off.tested, 1))));
}

// At its defaults a sampled technique is wrong at less than a quarter of the covered pixels at which a mask without shadows is
// wrong. One that promises a share of wrong pixels keeps it over all pixels, also in further scenes.
void better_than_nothing(Trial& trial) {
  std::size_t tested = 0;
  for (const char* reference : {"sphere_over_plane", "box_city:count=30", "fence", "contact"}) {
    const auto w = trial.enter(reference);
    const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 320, 180);
    const bool is_first = tested == 0;
    for (const Light& light : w->scene.lights) {
      const Support support = trial.support(w->scene, light);
      if (!support || has_area(light)) continue;
      if (!is_first && !support.most_wrong()) continue;
      trial.at(light);
      const auto technique = trial.set_up();
      const std::vector<float> mask = trial.answer(*technique, w->scene, light, gbuffer);
      const Tally t = tally(mask, w->reference(gbuffer, light), *technique, support.most_wrong().has_value());
      const ErrorSums off = wrong_pixels(t);
      judge_promise(trial, support, off, "pixels wrong:", gbuffer);
      if (is_first) expect_worth(trial, support, off);
      tested += t.tested;
    }
    if (tested == 0) return trial.does_not_apply("it supports no light without area on this scene");
  }
}

void better_than_nothing_soft(Trial& trial) {
  const auto w = trial.enter("sphere_over_plane");
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 160, 90);
  std::size_t asked = 0;
  for (const Light& light : trial.supported_lights(w->scene)) {
    if (!has_area(light)) continue;
    trial.at(light);
    const std::vector<float> mask = trial.fresh_answer(w->scene, light, gbuffer);
    const World::Truthful truth = w->reference(gbuffer, light, trial.entry().about.estimates);
    const ErrorSums off = summed_errors(mask, truth);
    const Support support = trial.support(w->scene, light);
    judge_promise(trial, support, off, "mean error:", gbuffer);
    expect_worth(trial, support, off);
    ++asked;
  }
  if (asked == 0) trial.does_not_apply("it supports no light with area on this scene");
}

}  // namespace

std::vector<Rule> promise_rules() {
  return {Rule("exact", exact, {.applies_to = AppliesTo::exact, .sanitized = Sanitized::nothing},
               "An exact technique is wrong at no tested pixel of five scenes, under every light without area that it "
               "supports. With full support it covers all pixels.",
               "Look at the pixel that is named: gnomon run with this scene, light and size shows it in the color of its "
               "cause. Where the method errs, promise Promise::sampled; where it has no opinion, say Support::approximate and "
               "covered = false.",
               "Look at the pixel that is named: gnomon run with this scene, light and size shows it in the color of its "
               "cause. Where the method errs, leave promise out; where it has no opinion, state approximate and explain "
               "such pixels with covered false."),
          Rule("exact_soft", exact_soft, {.applies_to = AppliesTo::exact, .sanitized = Sanitized::nothing},
               "Under lights with area an exact technique is within 4 standard errors of the reference, except at as many "
               "pixels as chance allows, and within 12 everywhere.",
               "See that About::estimates names the share that the mask holds, of the area or of the irradiance. Where the "
               "method errs, promise Promise::sampled.",
               "See that the key estimates names the share that the mask holds, of the area or of the irradiance. Where "
               "the method errs, leave promise out."),
          Rule("better_than_nothing", better_than_nothing, {.applies_to = AppliesTo::sampled, .sanitized = Sanitized::nothing},
               "At its defaults a sampled technique has less than a quarter of the wrong pixels that a mask without shadows "
               "has; one that promises a share of wrong pixels keeps its promise instead.",
               "See that the defaults suit a scene of a few meters. One that only approximates says so and what it promises: "
               "Support::approximate(why, {.most_wrong = 0.3}), the largest share of tested pixels that is wrong.",
               "See that the defaults suit a scene of a few meters, and that the key lights lists no kind that the method "
               "cannot answer."),
          Rule("better_than_nothing_soft", better_than_nothing_soft,
               {.applies_to = AppliesTo::sampled, .sanitized = Sanitized::nothing},
               "Under lights with area a sampled technique has less than a quarter of the mean error that a mask without "
               "shadows has; one that promises a bound keeps its promise instead.",
               "See that About::estimates names the share that the mask holds, and that the defaults suit a scene of a few "
               "meters. One that only approximates says what it promises, as with better_than_nothing.",
               "See that the key estimates names the share that the mask holds, that the defaults suit a scene of a few "
               "meters, and that the key lights lists no kind that the method cannot answer.")};
}

}  // namespace gnomon::conformance
