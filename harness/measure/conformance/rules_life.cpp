// The life of an object: stages repeated with other arguments and other parameters leave nothing behind.
#include "measure/conformance/trial.h"
#include "measure/scene/load.h"

namespace gnomon::conformance {
namespace {

/// Redoes `first` and the stages after it.
std::vector<float> redo(const Trial& trial, Technique& technique, Stage first, const Scene& scene, const Light& light,
                        const GBuffer& gbuffer) {
  if (first <= Stage::setup) technique.setup();
  if (first <= Stage::build) technique.build(scene);
  if (first <= Stage::relight) technique.relight(light);
  return trial.resolve(technique, gbuffer);
}

// Larger pictures of the technique's own are drawn once, for their mask; a used object is then set to a smaller one, for what a
// parameter spoils does not depend on its value. Under the sanitizers, which see no driver, they are left out, a used object
// is set to one value of each parameter, and the sphere has fewer triangles.
constexpr double most_texels = 1024;
constexpr std::string_view smaller = "512";

bool is_large_picture(const Parameter& parameter, const std::string& value) {
  return parameter.unit() == "texel" && std::stod(value) > most_texels;
}

// Both ends of each range and every choice. A value that is set on a used object is seen from the stage that it spoils on: the
// parameter's row says the truth about it. One light will do, the first that is supported with the value.
void parameter_ends(Trial& trial) {
  const char* const reference = trial.is_short() ? "sphere_over_plane:segments=6" : "sphere_over_plane:segments=16";
  trial.at(reference);
  const auto w = trial.world(reference);
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 64, 36);
  const auto names = trial.entry().make();
  for (const Parameter* parameter : names->parameters()) {
    const std::vector<std::string> probes = parameter->probes();
    for (const std::string& value : probes) {
      const bool is_large = is_large_picture(*parameter, value);
      if (is_large && trial.is_short()) continue;
      const std::string settings = fmt::format("{}={}", parameter->name(), value);
      trial.at(reference, settings);
      std::vector<Light> lights = trial.supported_lights(w->scene, settings);
      if (lights.empty()) continue;
      const Light& light = lights.size() > 1 ? lights[1] : lights[0];  // the sun where there is a choice: one image, not six
      trial.at(light);
      const auto plain = trial.entry().make();
      plain->apply(settings);
      const std::string wanted = value == parameter->default_text() ? "" : settings;
      trial.expect(plain->settings() == wanted, fmt::format("its settings are '{}', not '{}'", plain->settings(), wanted));
      std::vector<float> fresh = trial.fresh_answer(w->scene, light, gbuffer, settings);
      trial.expect_mask(fresh, w->scene, gbuffer, light);
      if (!trial.support(w->scene, light)) continue;
      if (trial.is_short() && value != probes.front()) continue;
      const std::string set(is_large ? smaller : value);
      if (is_large) fresh = trial.fresh_answer(w->scene, light, gbuffer, fmt::format("{}={}", parameter->name(), set));
      const auto used = trial.set_up();
      trial.answer(*used, w->scene, light, gbuffer);
      used->parameter(parameter->name()).set(set);
      used->apply(
          with_small_pictures(trial.entry(), fmt::format("{}={}", parameter->name(), set)));  // of objects that it brought
      trial.expect_same(fresh, redo(trial, *used, parameter->spoils(), w->scene, light, gbuffer),
                        fmt::format("set on a used object, from {} on{}", name(parameter->spoils()),
                                    is_large ? fmt::format(", to {}", set) : ""),
                        &gbuffer);
    }
  }
}

// One object goes through all lights and back; each time it says what a fresh one says.
void change_of_light(Trial& trial) {
  const char* const reference = "box_city:count=12";
  trial.at(reference);
  const auto w = trial.world(reference);
  const GBuffer gbuffer = w->gbuffer();
  const std::vector<Light> lights = trial.supported_lights(w->scene);
  const auto used = trial.set_up();
  used->build(w->scene);
  std::vector<std::vector<float>> fresh;
  for (const Light& light : lights) {
    trial.at(light);
    fresh.push_back(trial.fresh_answer(w->scene, light, gbuffer));
    used->relight(light);
    trial.expect_same(fresh.back(), trial.resolve(*used, gbuffer), "relit after other lights, and fresh", &gbuffer);
  }
  for (std::size_t k = lights.size(); k-- > 0;) {
    trial.at(lights[k]);
    used->relight(lights[k]);
    trial.expect_same(fresh[k], trial.resolve(*used, gbuffer), "relit on the way back, and fresh", &gbuffer);
  }
}

// Another view, and a third of another size, in between.
void change_of_view(Trial& trial) {
  const char* const reference = "box_city:count=12";
  trial.at(reference);
  const auto w = trial.world(reference);
  const GBuffer first = w->gbuffer(), others[] = {w->gbuffer(w->scene.views.at(1)), w->gbuffer(w->scene.views.at(1), 61, 80)};
  for (const Light& light : trial.supported_lights(w->scene)) {
    trial.at(light);
    const auto used = trial.set_up();
    const std::vector<float> before = trial.answer(*used, w->scene, light, first);
    for (const GBuffer& other : others) {
      trial.expect_same(trial.resolve(*used, other), trial.fresh_answer(w->scene, light, other),
                        "another view after the first, and fresh", &other);
      trial.expect_same(before, trial.resolve(*used, first), "back in the first view", &first);
    }
  }
}

// Work and bytes are those of the present light and picture, whatever they were before and however much room that left. With
// every choice and both ends of each range; under the sanitizers, which see them all in parameter_ends, as it comes.
void counts_of_now(Trial& trial) {
  const char* const reference = "sphere_over_plane:segments=24";
  trial.at(reference);
  const auto w = trial.world(reference);
  const GBuffer gbuffers[] = {w->gbuffer(w->scene.views[0], 60, 40), w->gbuffer(w->scene.views[0], 36, 24)};
  for (const std::string& settings : trial.is_short() ? std::vector<std::string>{""} : settings_of(trial.entry())) {
    trial.at(reference, settings);
    const std::vector<Light> lights = trial.supported_lights(w->scene, settings);
    if (lights.empty()) continue;
    // Two objects go opposite ways: what one does first, the other does last.
    std::string counts[2][2];
    for (const bool is_back : {false, true}) {
      const auto technique = trial.set_up(settings);
      technique->build(w->scene);
      for (const bool is_second : {is_back, !is_back}) {
        technique->relight(lights[is_second % lights.size()]);
        trial.resolve(*technique, gbuffers[is_second]);
        for (const Count& c : technique->counts())
          if (c.unit != "ms")  // a time is never the same
            counts[is_back][is_second] += fmt::format("{} {}; ", c.name, c.value);
      }
    }
    for (const bool is_second : {false, true}) {
      trial.at(lights[is_second % lights.size()]);
      const auto& [first, last] = std::pair(counts[is_second][is_second], counts[!is_second][is_second]);
      trial.expect(first == last, fmt::format("first in the object's life it counts {}last {}", first, last));
    }
  }
}

// A large scene, a small one, the large one: the same object does all three.
void change_of_scene(Trial& trial) {
  const char* const references[] = {"box_city:count=20", "sphere_over_plane:segments=12", "soup:count=40"};
  const std::unique_ptr<World> worlds[] = {trial.world(references[0]), trial.world(references[1]), trial.world(references[2])};
  const auto used = trial.set_up();
  for (const int k : {0, 1, 2, 0}) {
    trial.at(references[k]);
    const World& w = *worlds[k];
    const std::vector<Light> lights = trial.supported_lights(w.scene);
    if (lights.empty()) continue;
    trial.at(lights[0]);
    const GBuffer gbuffer = w.gbuffer();
    trial.expect_same(trial.answer(*used, w.scene, lights[0], gbuffer), trial.fresh_answer(w.scene, lights[0], gbuffer),
                      "after another scene, and fresh", &gbuffer);
  }
}

void two_objects(Trial& trial) {
  const auto city = trial.world("box_city:count=12"), ball = trial.world("sphere_over_plane:segments=12");
  const std::vector<Light> city_lights = trial.supported_lights(city->scene), ball_lights = trial.supported_lights(ball->scene);
  if (city_lights.empty() || ball_lights.empty()) return trial.does_not_apply("it supports no light of one of the two scenes");
  trial.at("box_city:count=12, and another object in sphere_over_plane:segments=12");
  const GBuffer city_view = city->gbuffer(), ball_view = ball->gbuffer();
  const std::vector<float> city_alone = trial.fresh_answer(city->scene, city_lights.front(), city_view);
  const std::vector<float> ball_alone = trial.fresh_answer(ball->scene, ball_lights.back(), ball_view);
  const auto a = trial.set_up(), b = trial.set_up();
  a->build(city->scene);
  b->build(ball->scene);
  b->relight(ball_lights.back());
  a->relight(city_lights.front());
  trial.expect_same(city_alone, trial.resolve(*a, city_view), "the first object, alone and beside the other", &city_view);
  trial.expect_same(ball_alone, trial.resolve(*b, ball_view), "the second object, alone and beside the other", &ball_view);
  trial.expect_same(city_alone, trial.resolve(*a, city_view), "the first object after the other resolved", &city_view);
}

}  // namespace

std::vector<Rule> life_rules() {
  return {
      {.name = "parameter_ends",
       .sentence = "Both ends of every parameter, and every choice, run. A value set on a used object takes full effect "
                   "from the stage that the parameter spoils.",
       .advice = "Name the earliest stage that reads the parameter in its row; read it in that stage and not in a "
                 "constructor.",
       .check = parameter_ends,
       .has_small_pictures = true,
       .sanitized = Sanitized::part},
      {.name = "change_of_light",
       .sentence = "After relight under another light it answers as a fresh object does, through all lights and back.",
       .advice = "Let relight set all that depends on the light: what is kept from the light before is what differs.",
       .check = change_of_light,
       .has_small_pictures = true},
      {.name = "change_of_view",
       .sentence = "After another view, and a picture of another size, it answers as a fresh object does.",
       .advice = "Let resolve set all that depends on view and size, and resize what has the size of the picture.",
       .check = change_of_view,
       .has_small_pictures = true},
      {.name = "counts_of_now",
       .sentence = "Counts, except times, depend on the present scene, light and picture alone, not on earlier ones.",
       .advice = "Count sizes, not room: vectors and textures that stay large after a larger picture are not all in "
                 "use. Set counters to zero at the beginning of their stage.",
       .check = counts_of_now,
       .has_small_pictures = true,
       .sanitized = Sanitized::part},
      {.name = "change_of_scene",
       .sentence = "The same object answers in a second and third scene, and in the first again, as a fresh one does.",
       .advice = "Let build begin from nothing: clear lists, and forget what was made for meshes by their number or "
                 "address.",
       .check = change_of_scene,
       .has_small_pictures = true},
      {.name = "two_objects",
       .sentence = "Two objects that live at once do not disturb each other.",
       .advice = "Keep what a stage makes in the object: look for static variables and for names of OpenGL that are "
                 "shared.",
       .check = two_objects,
       .has_small_pictures = true},
  };
}

}  // namespace gnomon::conformance
