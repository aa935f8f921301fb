// Rows of several lights: objects for further lights answer as whole ones do, and hold no more bytes.
#include <gnomon/kit/bases/light_objects.h>

#include <algorithm>
#include <cmath>

#include "measure/conformance/trial.h"
#include "measure/picture/shading.h"
#include "measure/score/together.h"

namespace gnomon::conformance {
namespace {

/// Objects for so many lights, with the defaults.
LightObjects built(const Trial& trial, const Scene& scene, std::size_t light_count) {
  LightObjects objects(trial.entry(), "");
  objects.hold(light_count);
  objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
  objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(scene); });
  return objects;
}

/// Every light's mask, resolved after all lights have had their relight, the last light first.
std::vector<std::vector<float>> masks(const Trial& trial, LightObjects& objects, const std::vector<Light>& lights,
                                      const GBuffer& gbuffer) {
  objects.each(Stage::relight, [&](Technique& object, std::size_t k) { object.relight(lights[k]); });
  std::vector<std::vector<float>> result(lights.size());
  for (std::size_t k = lights.size(); k-- > 0;) result[k] = trial.resolve(objects[k], gbuffer);
  return result;
}

/// The defaults, and one other value of every parameter that setup or build reads.
std::vector<std::string> settings_before_lights(const TechniqueEntry& entry) {
  const auto names = entry.make();
  std::vector<std::string> all = {""};
  for (const Parameter* parameter : names->parameters())
    if (parameter->spoils() <= Stage::build) all.push_back(fmt::format("{}={}", parameter->name(), parameter->probes().back()));
  return all;
}

// Also after a change of the scene, of which only the first object is notified, and with other settings than the defaults.
void further_lights(Trial& trial) {
  const char* const references[] = {"sphere_over_plane:segments=16", "box_city:count=12"};
  const std::unique_ptr<World> worlds[] = {trial.world(references[0]), trial.world(references[1])};
  for (const std::string& plain : settings_before_lights(trial.entry())) {
    const std::string settings = with_small_pictures(trial.entry(), plain);  // these objects are not made by the trial
    LightObjects objects(trial.entry(), settings);
    bool is_set_up = false;
    for (const int k : {0, 1, 0}) {
      trial.at(references[k], settings);
      const World& w = *worlds[k];
      const std::vector<Light> lights = trial.supported_lights(w.scene, settings);
      if (lights.empty()) continue;
      if (objects.hold(lights.size()) || !is_set_up)
        objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
      is_set_up = true;
      objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(w.scene); });
      const GBuffer gbuffer = w.gbuffer();
      const auto together = masks(trial, objects, lights, gbuffer);
      for (std::size_t l = 0; l < lights.size(); ++l) {
        trial.at(lights[l]);
        trial.expect_same(together[l], trial.fresh_answer(w.scene, lights[l], gbuffer, settings),
                          "an object for a further light, and a whole one", &gbuffer);
      }
    }
  }
}

// What several lights give together is the sum of what each gives alone: the masks come from objects that share, the sum is
// made from whole ones. Shares are rounded to float32 once: 2^-24 of 1, and the sum of light received as much of itself.
void sum_of_lights(Trial& trial) {
  const auto w = trial.enter("sphere_over_plane:segments=16");
  const std::vector<Light> lights = trial.supported_lights(w->scene);
  if (lights.size() < 2) return trial.does_not_apply("it supports one light of the scene at most");
  const GBuffer gbuffer = w->gbuffer();
  LightObjects objects = built(trial, w->scene, lights.size());
  const auto shared = masks(trial, objects, lights, gbuffer);
  std::vector<double> sum(gbuffer.size());
  std::vector<Evidence> evidence;
  const std::vector<PixelClass> classes(gbuffer.size(), PixelClass::T);
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const std::vector<float> alone = trial.fresh_answer(w->scene, lights[k], gbuffer);
    const std::vector<double> received = received_light(gbuffer, lights[k]);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += received[i] * alone[i];
    const std::vector<float>& mask = shared[k];
    evidence.push_back({gbuffer.width, gbuffer.height, classes, mask, mask, {}, &w->scene, &gbuffer, &lights[k]});
  }
  const Together all = together(evidence);
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const double shown = all.received[i] * all.shown[i];
    if (!(std::abs(shown - sum[i]) <= 0x1p-23 * all.received[i]))
      return trial.found(fmt::format("all lights together give {}, the sum of each alone is {}", shown, sum[i]), i, gbuffer);
  }
}

void bytes_of_further_lights(Trial& trial) {
  const auto w = trial.enter("box_city:count=12");
  const std::vector<Light> lights = trial.supported_lights(w->scene);
  if (lights.size() < 2) return trial.does_not_apply("it supports one light of the scene at most");
  const GBuffer gbuffer = w->gbuffer();
  LightObjects objects = built(trial, w->scene, lights.size());
  masks(trial, objects, lights, gbuffer);
  double whole = 0;
  for (const Light& light : lights) {
    const auto alone = trial.set_up();
    trial.answer(*alone, w->scene, light, gbuffer);
    whole += counted_bytes(alone->counts());
  }
  const double together = counted_bytes(objects.counts());
  trial.expect(together <= whole,
               fmt::format("objects for {} lights hold {} bytes together, whole ones {}", lights.size(), together, whole));
}

}  // namespace

std::vector<Rule> light_rules() {
  return {Rule("further_lights", further_lights, {.has_small_pictures = true},
               "Objects for further lights answer as independent objects do, also after a change of scene.",
               "An object of for_another_light() shares what setup and build make and nothing else; keep it in one "
               "Shared<Made> member (gnomon/kit/shared.h). Without for_another_light every light has a whole object.",
               "Each light has a process of its own: look for files outside of the folder that hello names, and for "
               "servers that several talk to."),
          Rule("sum_of_lights", sum_of_lights, {.sanitized = Sanitized::nothing},
               "The picture of all lights together is the sum of the pictures of each.",
               "As with further_lights; look for what relight writes into the shared part.",
               "As with further_lights; look for what relight leaves where other processes read it."),
          Rule("bytes_of_further_lights", bytes_of_further_lights, {.sanitized = Sanitized::nothing},
               "Objects for further lights hold no more bytes than independent objects would.",
               "Let an object for a further light count only what it holds itself, not what it shares.",
               "Count what the process of that light holds itself.")};
}

}  // namespace gnomon::conformance
