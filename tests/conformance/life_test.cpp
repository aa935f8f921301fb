// The life of an object: stages repeated with other arguments and other parameters leave nothing behind.
#include "stage.h"

namespace conformance {
namespace {

class Life : public Every {
 protected:
  /// Redoes `first` and the stages after it.
  std::vector<float> redo(Technique& technique, Stage first, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    if (first <= Stage::setup) technique.setup();
    if (first <= Stage::build) technique.build(scene);
    if (first <= Stage::relight) technique.relight(light);
    return resolve(technique, gbuffer);
  }
};
INSTANTIATE_TEST_SUITE_P(technique, Life, testing::ValuesIn(technique_ids()), id_of);

// Both ends of each range and every choice. A value that is set on a used object is seen from the stage that it spoils on: the
// parameter's row says the truth about it. One light will do, the first that is supported with the value.
TEST_P(Life, every_end_of_every_parameter_runs_and_spoils_the_stage_it_says) {
  const auto w = world("sphere_over_plane:segments=16");
  const GBuffer gbuffer = w->gbuffer();
  const auto names = entry().make();
  for (const Parameter* parameter : names->parameters()) {
    for (const std::string& value : parameter->probes()) {
      const std::string settings = fmt::format("{}={}", parameter->name(), value);
      SCOPED_TRACE(settings);
      std::vector<Light> lights = supported_lights(w->scene, settings);
      if (lights.empty()) continue;
      const Light& light = lights.size() > 1 ? lights[1] : lights[0];  // the sun where there is a choice: one image, not six
      std::vector<float> fresh;
      {
        const auto technique = set_up(settings);
        EXPECT_EQ(technique->settings(), value == parameter->default_text() ? "" : settings);
        fresh = answer(*technique, w->scene, light, gbuffer);
      }
      EXPECT_TRUE(is_mask(fresh, *w, gbuffer, light));
      if (!support(w->scene, light)) continue;
      const auto used = set_up();
      answer(*used, w->scene, light, gbuffer);
      used->parameter(parameter->name()).set(value);
      EXPECT_TRUE(same(fresh, redo(*used, parameter->spoils(), w->scene, light, gbuffer)))
          << "from " << name(parameter->spoils()) << " on";
    }
  }
}

// One object goes through all lights and back; each time it says what a fresh one says.
TEST_P(Life, relight_equals_a_fresh_object) {
  const auto w = world("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  const std::vector<Light> lights = supported_lights(w->scene);
  const auto used = set_up();
  used->build(w->scene);
  std::vector<std::vector<float>> fresh;
  for (const Light& light : lights) {
    fresh.push_back(fresh_answer(w->scene, light, gbuffer));
    used->relight(light);
    EXPECT_TRUE(same(fresh.back(), resolve(*used, gbuffer))) << "forth, " << title(light);
  }
  for (std::size_t k = lights.size(); k-- > 0;) {
    used->relight(lights[k]);
    EXPECT_TRUE(same(fresh[k], resolve(*used, gbuffer))) << "back, " << title(lights[k]);
  }
}

// Another view, and a third of another size, in between.
TEST_P(Life, resolve_is_independent_of_earlier_views) {
  const auto w = world("box_city:count=12");
  const GBuffer first = w->gbuffer(), others[] = {w->gbuffer(w->scene.views.at(1)), w->gbuffer(w->scene.views.at(1), 61, 80)};
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto used = set_up();
    const std::vector<float> before = answer(*used, w->scene, light, first);
    for (const GBuffer& other : others) {
      EXPECT_TRUE(same(resolve(*used, other), fresh_answer(w->scene, light, other))) << other.width << "x" << other.height;
      EXPECT_TRUE(same(before, resolve(*used, first)));
    }
  }
}

// Work and bytes are those of the present light and picture, whatever they were before and however much room that left. With
// every choice and both ends of each range.
TEST_P(Life, counts_are_independent_of_earlier_lights_and_views) {
  const auto w = world("sphere_over_plane:segments=24");
  const GBuffer gbuffers[] = {w->gbuffer(w->scene.views[0], 120, 80), w->gbuffer(w->scene.views[0], 72, 48)};
  const auto names = entry().make();
  std::vector<std::string> all_settings = {""};
  for (const Parameter* parameter : names->parameters())
    for (const std::string& value : parameter->probes()) all_settings.push_back(fmt::format("{}={}", parameter->name(), value));
  for (const std::string& settings : all_settings) {
    SCOPED_TRACE(settings);
    const std::vector<Light> lights = supported_lights(w->scene, settings);
    if (lights.empty()) continue;
    // Two objects go opposite ways: what one does first, the other does last.
    std::string counts[2][2];
    for (const bool is_back : {false, true}) {
      const auto technique = set_up(settings);
      technique->build(w->scene);
      for (const bool is_second : {is_back, !is_back}) {
        technique->relight(lights[is_second % lights.size()]);
        resolve(*technique, gbuffers[is_second]);
        for (const Count& c : technique->counts()) counts[is_back][is_second] += fmt::format("{} {}\n", c.name, c.value);
      }
    }
    EXPECT_EQ(counts[0][0], counts[1][0]);
    EXPECT_EQ(counts[0][1], counts[1][1]);
  }
}

// A large scene, a small one, the large one: the same object does all three.
TEST_P(Life, survives_a_change_of_scene) {
  const std::unique_ptr<World> worlds[] = {world("box_city:count=20"), world("sphere_over_plane:segments=12"),
                                           world("soup:count=40")};
  const auto used = set_up();
  for (const int k : {0, 1, 2, 0}) {
    const World& w = *worlds[k];
    const std::vector<Light> lights = supported_lights(w.scene);
    if (lights.empty()) continue;
    const GBuffer gbuffer = w.gbuffer();
    EXPECT_TRUE(same(answer(*used, w.scene, lights[0], gbuffer), fresh_answer(w.scene, lights[0], gbuffer)))
        << w.scene.name << ", " << title(lights[0]);
  }
}

TEST_P(Life, two_objects_do_not_disturb_each_other) {
  const auto city = world("box_city:count=12"), ball = world("sphere_over_plane:segments=12");
  const std::vector<Light> city_lights = supported_lights(city->scene), ball_lights = supported_lights(ball->scene);
  if (city_lights.empty() || ball_lights.empty()) GTEST_SKIP() << "supports no light of one of the two scenes";
  const GBuffer city_view = city->gbuffer(), ball_view = ball->gbuffer();
  const std::vector<float> city_alone = fresh_answer(city->scene, city_lights.front(), city_view);
  const std::vector<float> ball_alone = fresh_answer(ball->scene, ball_lights.back(), ball_view);
  const auto a = set_up(), b = set_up();
  a->build(city->scene), b->build(ball->scene);
  b->relight(ball_lights.back()), a->relight(city_lights.front());
  EXPECT_TRUE(same(city_alone, resolve(*a, city_view)));
  EXPECT_TRUE(same(ball_alone, resolve(*b, ball_view)));
  EXPECT_TRUE(same(city_alone, resolve(*a, city_view)));
}

}  // namespace
}  // namespace conformance
