// Rows of several lights: objects for further lights are as good as whole ones, and hold no more.
#include "measure/picture/shading.h"
#include "measure/run/light_objects.h"
#include "measure/score/together.h"
#include "stage.h"

namespace conformance {
namespace {

class Lights : public Every {
 protected:
  /// Objects for so many lights, with the defaults.
  LightObjects built(const Scene& scene, std::size_t light_count) const {
    LightObjects objects(entry(), "");
    objects.hold(light_count);
    objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
    objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(scene); });
    return objects;
  }
  /// Every light's mask, asked after all lights have had their relight, the last light first.
  std::vector<std::vector<float>> masks(LightObjects& objects, const std::vector<Light>& lights, const GBuffer& gbuffer) {
    objects.each(Stage::relight, [&](Technique& object, std::size_t k) { object.relight(lights[k]); });
    std::vector<std::vector<float>> result(lights.size());
    for (std::size_t k = lights.size(); k-- > 0;) result[k] = resolve(objects[k], gbuffer);
    return result;
  }
  static double bytes_of(const Counts& counts) {
    for (const Count& count : counts)
      if (count.name == "bytes") return count.value;
    return 0;
  }
};
INSTANTIATE_TEST_SUITE_P(technique, Lights, testing::ValuesIn(technique_ids()), id_of);

// Also after the scene changes under them, which only the first object is told, and with other settings than the defaults.
TEST_P(Lights, objects_for_further_lights_answer_as_whole_ones) {
  const std::unique_ptr<World> worlds[] = {world("sphere_over_plane:segments=16"), world("box_city:count=12")};
  const auto names = entry().make();
  std::vector<std::string> all_settings = {""};
  for (const Parameter* parameter : names->parameters())
    if (parameter->spoils() <= Stage::build)
      all_settings.push_back(fmt::format("{}={}", parameter->name(), parameter->probes().back()));
  for (const std::string& settings : all_settings) {
    SCOPED_TRACE(settings);
    LightObjects objects(entry(), settings);
    bool is_set_up = false;
    for (const int k : {0, 1, 0}) {
      const World& w = *worlds[k];
      const std::vector<Light> lights = supported_lights(w.scene, settings);
      if (lights.empty()) continue;
      if (objects.hold(lights.size()) || !is_set_up)
        objects.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
      is_set_up = true;
      objects.each(Stage::build, [&](Technique& object, std::size_t) { object.build(w.scene); });
      const GBuffer gbuffer = w.gbuffer();
      const auto together = masks(objects, lights, gbuffer);
      for (std::size_t l = 0; l < lights.size(); ++l)
        EXPECT_TRUE(same(together[l], fresh_answer(w.scene, lights[l], gbuffer, settings)))
            << w.scene.name << ", " << title(lights[l]);
    }
  }
}

// What several lights give together is the sum of what each gives alone: the masks come from objects that share, the sum is
// made from whole ones. Shares are rounded to float32 once: 2^-24 of 1, and the sum of light received as much of itself.
TEST_P(Lights, the_picture_of_all_is_the_sum_of_the_pictures_of_each) {
  const auto w = world("sphere_over_plane:segments=16");
  const std::vector<Light> lights = supported_lights(w->scene);
  if (lights.size() < 2) GTEST_SKIP() << "supports one light of the scene at most";
  const GBuffer gbuffer = w->gbuffer();
  LightObjects objects = built(w->scene, lights.size());
  const auto shared = masks(objects, lights, gbuffer);
  std::vector<double> sum(gbuffer.size());
  std::vector<Evidence> evidence;
  const std::vector<PixelClass> classes(gbuffer.size(), PixelClass::T);
  for (std::size_t k = 0; k < lights.size(); ++k) {
    const std::vector<float> alone = fresh_answer(w->scene, lights[k], gbuffer);
    const std::vector<double> received = received_light(gbuffer, lights[k]);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += received[i] * alone[i];
    Evidence& e = evidence.emplace_back();
    e.width = gbuffer.width, e.height = gbuffer.height;
    e.classes = classes;
    e.reference = e.mask = shared[k];
    e.gbuffer = &gbuffer, e.scene = &w->scene, e.light = &lights[k];
  }
  const Together all = together(evidence);
  for (std::size_t i = 0; i < sum.size(); ++i)
    ASSERT_NEAR(all.received[i] * all.shown[i], sum[i], 0x1p-23 * all.received[i]) << "pixel " << i;
}

TEST_P(Lights, further_objects_hold_no_more_than_whole_ones) {
  const auto w = world("box_city:count=12");
  const std::vector<Light> lights = supported_lights(w->scene);
  if (lights.size() < 2) GTEST_SKIP() << "supports one light of the scene at most";
  const GBuffer gbuffer = w->gbuffer();
  LightObjects objects = built(w->scene, lights.size());
  masks(objects, lights, gbuffer);
  double whole = 0;
  for (const Light& light : lights) {
    const auto alone = set_up();
    answer(*alone, w->scene, light, gbuffer);
    whole += bytes_of(alone->counts());
  }
  EXPECT_LE(bytes_of(objects.counts()), whole);
}

}  // namespace
}  // namespace conformance
