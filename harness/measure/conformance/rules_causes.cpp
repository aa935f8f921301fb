// Whether a technique's own account of a pixel explains every error that it makes.
#include <algorithm>
#include <cmath>

#include "measure/cause/own_causes.h"
#include "measure/conformance/trial.h"
#include "measure/frame/frame.h"
#include "measure/program/elsewhere.h"

namespace gnomon::conformance {
namespace {

/// Under a light with area every pixel with an error has a cause, and at most 1 % of the error is unexplained.
void expect_soft_causes(Trial& trial, std::span<const Cause> causes, const Reference& truth, std::span<const float> mask,
                        const GBuffer& gbuffer) {
  const bool is_area = trial.entry().about.estimates == LightShareKind::area;
  const std::span<const float> share = is_area ? truth.mask : truth.irradiance;
  double all = 0, unexplained = 0;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const double error = std::abs(static_cast<double>(mask[i]) - share[i]);
    const bool is_off = truth.classes[i] == PixelClass::T && error > 0;
    if ((causes[i] != Cause::none) != is_off)
      return trial.found(is_off ? "it is off and has no cause" : "it is not off and has a cause", i, gbuffer);
    if (causes[i] != Cause::none) all += error;
    if (causes[i] != Cause::unexplained) continue;
    if (unexplained == 0) worst = i;
    unexplained += error;
  }
  if (!(unexplained <= 0.01 * all))
    trial.found(fmt::format("{:.2g} % of the error has no cause that explains it; 1 % may be", 100 * unexplained / all), worst,
                gbuffer);
}

void expect_causes(Trial& trial, std::span<const Cause> causes, const Reference& truth, std::span<const float> mask,
                   const GBuffer& gbuffer) {
  std::size_t unexplained = 0, first = 0;
  for (std::size_t i = 0; i < causes.size(); ++i) {
    const bool is_wrong = truth.classes[i] == PixelClass::T && gnomon::is_wrong(mask[i], truth.mask[i], truth.kind);
    if ((causes[i] != Cause::none) != is_wrong)
      return trial.found(is_wrong ? "it is wrong and has no cause" : "it is not wrong and has a cause", i, gbuffer);
    if (causes[i] == Cause::unexplained && unexplained++ == 0) first = i;
  }
  if (unexplained > 0)
    trial.found(fmt::format("{} wrong pixels have no cause that explains them", unexplained), first, gbuffer);
}

/// Whether an explanation has anything from which a cause follows; else the cause follows from the pixel's place alone.
bool says_something(const std::optional<Explanation>& why) {
  return why && (!why->covered || why->formula_differs || why->outline_error > 0 || why->element || !why->cause.empty() ||
                 !why->taps.empty() || !why->samples.empty());
}

void named_causes(Trial& trial) {
  std::size_t tested = 0, queried = 0, explained = 0;  // lights; pixels that are queried, and that are explained
  for (const char* reference : {"box_city:count=30", "soup:count=200", "fence", "contact"}) {
    trial.at(reference);
    const Scene scene = generated_scene(reference);
    FrameStore frames = frames_of(scene);
    const FrameKey key{scene.views[0], 192, 108, trial.entry().about.sees};
    const GBuffer gbuffer = frames.gbuffer(key);
    for (const Light& light : scene.lights) {
      if (!trial.support(scene, light)) continue;
      trial.at(light);
      const auto technique = trial.set_up();
      const std::vector<float> mask = trial.answer(*technique, scene, light, gbuffer);
      const Reference truth = frames.reference(key, light);
      const bool is_area = trial.entry().about.estimates == LightShareKind::area || !has_area(light);
      technique->error_terms(is_area ? truth.mask : truth.irradiance);  // of which explain names the largest
      const auto explain = [&](std::span<const std::uint32_t> pixels) {
        auto whys = explain_all(*technique, pixels);
        queried += pixels.size();
        explained += static_cast<std::size_t>(std::ranges::count_if(whys, says_something));
        return whys;
      };
      const About& about = trial.entry().about;
      const std::vector<CauseInfo> own = own_causes(about);
      const auto causes = find_causes(
          {scene, frames.casters(key.truth), gbuffer, light, truth, mask, {}, explain, about.estimates, own, about.rasterizes});
      ++tested;
      const auto expect = has_area(light) ? expect_soft_causes : expect_causes;
      expect(trial, causes, truth, mask, gbuffer);
    }
  }
  if (tested == 0)
    trial.does_not_apply("it supports no light of these scenes");
  else if (queried == 0)
    trial.does_not_apply("no pixel of these scenes is wrong");
  else if (explained == 0)
    trial.does_not_apply("it explains no wrong pixel: causes are told from where they are alone");
}

}  // namespace

std::vector<Rule> cause_rules() {
  return {Rule("named_causes", named_causes, {.sanitized = Sanitized::nothing},
               "Every wrong pixel of four scenes has a cause. Under lights with area at least 99 % of the error has one.",
               "Return from explain() what decided the pixel: the taps with their weights and stored depths, or the samples of "
               "the light, the bias, and covered = false where the technique has no opinion. docs/causes.md says what each "
               "cause looks at.",
               "List explain in answers, and answer it with what decided the pixel: the taps with their weights and "
               "stored depths, or the samples of the light, the bias, and covered false where the technique has no "
               "opinion. docs/causes.md says what each cause looks at.")};
}

}  // namespace gnomon::conformance
