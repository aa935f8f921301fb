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

// Larger pictures of the technique's own are drawn once, for their mask. A used object is then set to a smaller one, because
// the stage that a parameter spoils does not depend on its value. The sanitizers do not instrument drivers: under them such
// pictures are left out, a used object is set to one value of each parameter, and the sphere has fewer triangles.
constexpr double most_texels = 1024;
constexpr std::string_view smaller = "512";

// Both ends of each range and every choice. A value that is set on a used object takes effect from the stage that it spoils:
// the parameter's row names it correctly. One light is enough: the first that is supported with the value.
void parameter_ends(Trial& trial) {
  const char* const reference = trial.is_short() ? "sphere_over_plane:segments=6" : "sphere_over_plane:segments=16";
  const auto w = trial.enter(reference);
  const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 64, 36);
  const auto names = trial.entry().make();
  for (const Parameter* parameter : names->parameters()) {
    const std::vector<std::string> probes = parameter->probes();
    for (const std::string& value : probes) {
      const auto set_to = [&](std::string_view text) { return fmt::format("{}={}", parameter->name(), text); };
      const bool is_large = parameter->unit() == "texel" && std::stod(value) > most_texels;
      if (is_large && trial.is_short()) continue;
      const std::string settings = set_to(value);
      trial.at(reference, settings);
      const std::vector<Light> lights = trial.supported_lights(w->scene, settings);
      if (lights.empty()) continue;
      const Light& light = lights.size() > 1 ? lights[1] : lights[0];  // the sun where it is supported: one image, not six
      trial.at(light);
      const auto plain = trial.entry().make();
      plain->apply(settings);
      const std::string wanted = value == parameter->default_text() ? "" : settings;
      trial.expect(plain->settings() == wanted, fmt::format("its settings are '{}', not '{}'", plain->settings(), wanted));
      std::vector<float> fresh = trial.fresh_answer(w->scene, light, gbuffer, settings);
      trial.expect_mask(fresh, w->scene, gbuffer, light);
      if (!trial.support(w->scene, light) || (trial.is_short() && value != probes.front())) continue;
      const std::string set(is_large ? smaller : value);
      if (is_large) fresh = trial.fresh_answer(w->scene, light, gbuffer, set_to(set));
      const auto used = trial.set_up();
      trial.answer(*used, w->scene, light, gbuffer);
      used->parameter(parameter->name()).set(set);
      used->apply(with_small_pictures(trial.entry(), set_to(set)));  // of objects that it brought
      trial.expect_same(fresh, redo(trial, *used, parameter->spoils(), w->scene, light, gbuffer),
                        fmt::format("set on a used object, from {} on{}", name(parameter->spoils()),
                                    is_large ? fmt::format(", to {}", set) : ""),
                        &gbuffer);
    }
  }
}

// One object goes through all lights and back; each time it answers as a fresh one does.
void change_of_light(Trial& trial) {
  const auto w = trial.enter("box_city:count=12");
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
  const auto w = trial.enter("box_city:count=12");
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

// Counts of work and bytes depend on the present light and picture alone, not on earlier ones or the memory that these left.
// Checked with every choice and both ends of each range; under the sanitizers, which run these in parameter_ends, at the
// defaults.
void counts_of_now(Trial& trial) {
  const char* const reference = "sphere_over_plane:segments=24";
  const auto w = trial.enter(reference);
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
      Rule("parameter_ends", parameter_ends, {.has_small_pictures = true, .sanitized = Sanitized::part},
           "Both ends of every parameter, and every choice, run. A value set on a used object takes full effect from the "
           "stage that the parameter spoils.",
           "Name the earliest stage that reads the parameter in its row; read it in that stage and not in a constructor.",
           "Name the earliest stage that reads the parameter as its stage; read it from that request's settings."),
      Rule("change_of_light", change_of_light, {.has_small_pictures = true},
           "After relight under another light it answers as a fresh object does, through all lights and back.",
           "Let relight set all that depends on the light: what is kept from the light before is what differs."),
      Rule("change_of_view", change_of_view, {.has_small_pictures = true},
           "After another view, and a picture of another size, it answers as a fresh object does.",
           "Let resolve set all that depends on view and size, and resize what has the size of the picture."),
      Rule("counts_of_now", counts_of_now, {.has_small_pictures = true, .sanitized = Sanitized::part},
           "Counts, except times, depend on the present scene, light and picture alone, not on earlier ones.",
           "Count sizes, not room: vectors and textures that stay large after a larger picture are not all in use. Set "
           "counters to zero at the beginning of their stage.",
           "Count sizes, not room: arrays that stay large after a larger picture are not all in use. Set counters to "
           "zero at the beginning of their stage."),
      Rule("change_of_scene", change_of_scene, {.has_small_pictures = true},
           "The same object answers in a second and third scene, and in the first again, as a fresh one does.",
           "Let build begin from nothing: clear lists, and forget what was made for meshes by their number or address."),
      Rule("two_objects", two_objects, {.has_small_pictures = true}, "Two objects that live at once do not disturb each other.",
           "Keep what a stage makes in the object: look for static variables and for names of OpenGL that are shared.",
           "Each has a process of its own: look for files outside of the folder that hello names, and for servers "
           "that both talk to.")};
}

}  // namespace gnomon::conformance
