// Scenes that combine holes, glass, casters that move, several lights, and lights with area.
#include <gnomon/kit/bases/light_objects.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <optional>

#include "measure/conformance/combined_scene.h"
#include "measure/conformance/judgement.h"
#include "measure/conformance/motion_world.h"

namespace gnomon::conformance {
namespace {

/// Of the scenes that are drawn: with and without holes, glass that is the same everywhere, glass with texels, and each pair.
constexpr std::array<std::uint64_t, 7> usual_seeds = {1, 2, 3, 4, 5, 6, 7};
/// Of a side of a technique's own pictures. What it promises is promised of its defaults: fewer texels may break it.
constexpr int least_texels = 256;
/// Shadows that a mask is judged by add up to this many pixels at least.
constexpr double least_shadow = 30;

std::vector<std::uint64_t> wanted_seeds(const Trial& trial) {
  if (const char* const text = std::getenv("GNOMON_SEED")) {
    const std::string_view digits(text);
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), seed);
    if (error != std::errc() || end != digits.end()) throw CannotAsk("GNOMON_SEED = {} is no whole number", text);
    return {seed};
  }
  if (trial.is_short()) return {3, 6};
  return {usual_seeds.begin(), usual_seeds.end()};
}

bool has_one_of(std::string_view text, std::span<const std::string_view> words) {
  return std::ranges::any_of(words, [&](std::string_view word) { return text.find(word) != std::string_view::npos; });
}

/// What stands in a technique's way, by words of its reason.
struct Named {
  bool holes = false, glass = false, light = false, other = false;
};

Named named_in(const std::string& why, const Scene& scene, const Light& light) {
  static constexpr std::string_view holes[] = {"alpha mask", "alpha_mask", " hole"};
  static constexpr std::string_view glass[] = {"transmission", "glass", "part of the light"};
  static constexpr std::string_view lights[] = {"area", "penumbra", " light"};
  static constexpr std::string_view others[] = {"device", "mesh", "caster", "triangle", "shape", "plane", "move", "motion"};
  Named named{.holes = has_one_of(why, holes), .glass = has_one_of(why, glass)};
  named.light = has_one_of(why, lights) || why.find(kind_name(light)) != std::string::npos;
  named.other = has_one_of(why, others) ||
                std::ranges::any_of(scene.meshes, [&](const Mesh& mesh) { return why.find(mesh.name) != std::string::npos; });
  return named;
}

/// The case without what was named: solid cards, opaque ones, a light with area in place of one without, and the other way.
Support support_without(const Trial& trial, const Named& named, Scene scene, Light light, const std::string& settings) {
  for (Mesh& mesh : scene.meshes) {
    if (named.holes) mesh.alpha_mask.reset();
    if (named.glass) mesh.transmission.reset();
    if (!mesh.needs_uv()) mesh.uv.clear();
  }
  if (named.light) {
    const glm::vec3 place(0, 8, 0);
    light = has_area(light) ? Light{.name = "point", .kind = PointLight{place}}
                            : Light{.name = "disc", .kind = DiscLight{.center = place, .radius = 0.5f}};
  }
  return trial.support(scene, light, settings);
}

/// A reason names what is not supported: holes, glass, the light, or something else of the scene or the device. Without what it
/// names the case is supported, or for another reason not.
void expect_reason(Trial& trial, const Scene& scene, const Light& light, const std::string& why, const std::string& settings) {
  if (why.empty()) return trial.found("it is unsupported, and gives no reason");
  const Named named = named_in(why, scene, light);
  if (!named.holes && !named.glass && !named.light) {
    trial.expect(named.other,
                 fmt::format("it is unsupported, and the reason names nothing of scene, light or device: '{}'", why));
    return;
  }
  const Support without = support_without(trial, named, scene, light, settings);
  trial.expect(without || without.why() != why,
               fmt::format("it is unsupported without what the reason names, too, and for the same reason: '{}'", why));
}

/// One drawn scene, and the lights under which a technique supports it in every frame that is looked at.
class Case {
 public:
  Case(Trial& trial, std::uint64_t seed, const std::string& settings)
      : world(combined_scene(seed), trial.entry().about.sees, is_sanitized ? 2 : 1),
        frames{0, 1 + static_cast<int>(seed * 5 % 15), 17 + static_cast<int>(seed * 7 % 15)},
        trial_(trial),
        settings_(settings) {
    std::vector<std::string> names = {"casters that move"};
    for (const Feature feature : features_of(world.scene())) names.emplace_back(name(feature));
    title_ = fmt::format("combined scene of seed {} ({})", seed, joined(names));
  }

  /// Under these lights every frame is supported. Looks at the reasons of the others.
  void find_lights() {
    std::vector<Light> all = world.scene().lights;
    for (const int frame : frames) {
      go_to(frame);
      std::erase_if(all, [&](const Light& light) {
        const Support found = support(light);
        if (found) return false;
        trial_.at(light);
        expect_reason(trial_, world.scene(), light, found.why(), settings_);
        return true;
      });
    }
    lights = std::move(all);
  }

  void go_to(int frame) {
    world.go_to(frame);
    trial_.at(fmt::format("{}, frame {}", title_, frame), settings_);
  }
  /// In the present frame.
  Support support(const Light& light) const { return trial_.support(world.scene(), light, settings_); }

  MovingWorld world;
  std::array<int, 3> frames;  ///< where it is built, updated, and updated again
  std::vector<Light> lights;

 private:
  Trial& trial_;
  std::string title_, settings_;
};

/// Whether glass alone is what a support is approximate about.
bool is_about_glass(const Support& support) {
  return support.kind() == Support::Kind::approximate && support.why().find("glass") != std::string::npos;
}

/// By what the technique promises, as the rules of one feature and of one light judge.
void judge_mask(Trial& trial, Case& drawn, const Light& light, const Technique& technique, const std::vector<float>& mask) {
  const About& about = trial.entry().about;
  if (is_sanitized || about.role == Role::baseline) return;
  const Support support = drawn.support(light);
  MovingWorld& world = drawn.world;
  const GBuffer& gbuffer = world.gbuffer();
  const World::Truthful truth = world.reference(light, about.estimates);
  const bool is_exact = about.promise == Promise::exact, is_whole = support.most_wrong().has_value();
  if (has_area(light) && is_exact) {
    judge_exact_soft(trial, mask, truth, gbuffer);
    return;
  }
  if (is_about_glass(support)) return;
  if (has_area(light)) {
    const bool has_covers = support.kind() == Support::Kind::approximate && !is_whole;
    const ErrorSums off = summed_errors(mask, truth, has_covers ? &technique : nullptr);
    trial.expect(off.unshadowed >= least_shadow,
                 fmt::format("shadows add up to {} pixels: too few to judge by", off.unshadowed));
    return judge_promise(trial, support, off, "mean error:", gbuffer);
  }
  if (world.scene().has_transmission() && !is_whole)
    return judge_glass(trial, light, technique, mask, truth, gbuffer, least_shadow);
  const Tally found = tally(mask, truth, technique, is_whole);
  trial.expect(static_cast<double>(found.dark) >= least_shadow,
               fmt::format("{} dark pixels that it covers: too few to judge by", found.dark));
  if (is_exact) return judge_exact(trial, support, found, mask, truth, gbuffer);
  judge_promise(trial, support, wrong_pixels(found), "pixels wrong:", gbuffer);
}

/// Objects of several lights, set up once for all scenes.
class Objects {
 public:
  Objects(const Trial& trial, const std::string& settings) : objects_(trial.entry(), settings) {}

  void build(const Scene& scene, std::size_t light_count) {
    if (objects_.hold(light_count) || !is_set_up_)
      objects_.each(Stage::setup, [](Technique& object, std::size_t) { object.setup(); });
    is_set_up_ = true;
    objects_.each(Stage::build, [&](Technique& object, std::size_t) { object.build(scene); });
  }
  void update(const Scene& scene, const Changes& changes) {
    objects_.each(Stage::update, [&](Technique& object, std::size_t) { object.update(scene, changes); });
  }
  void relight(const std::vector<Light>& lights) {
    objects_.each(Stage::relight, [&](Technique& object, std::size_t k) { object.relight(lights[k]); });
  }
  /// All lights have had their relight; the last light first.
  std::vector<std::vector<float>> resolve(const Trial& trial, const GBuffer& gbuffer) {
    std::vector<std::vector<float>> masks(objects_.count());
    for (std::size_t k = masks.size(); k-- > 0;) masks[k] = trial.resolve(objects_[k], gbuffer);
    return masks;
  }
  const Technique& operator[](std::size_t k) { return objects_[k]; }

 private:
  LightObjects objects_;
  bool is_set_up_ = false;
};

/// Follows a scene by updates, and compares with a build and with the truth.
void follow(Trial& trial, Case& drawn, Objects& moved, Objects& built) {
  MovingWorld& world = drawn.world;
  const auto& [start, middle, end] = drawn.frames;
  drawn.go_to(start);
  world.take_changes();
  moved.build(world.scene(), drawn.lights.size());
  moved.relight(drawn.lights);
  moved.resolve(trial, world.gbuffer());
  drawn.go_to(middle);
  moved.update(world.scene(), world.take_changes());
  moved.relight(drawn.lights);
  drawn.go_to(end);
  moved.update(world.scene(), world.take_changes());
  moved.relight(drawn.lights);
  const auto masks = moved.resolve(trial, world.gbuffer());
  built.build(world.scene(), drawn.lights.size());
  built.relight(drawn.lights);
  const auto fresh = built.resolve(trial, world.gbuffer());
  for (std::size_t k = 0; k < drawn.lights.size(); ++k) {
    const Light& light = drawn.lights[k];
    trial.at(light);
    trial.expect_mask(masks[k], world.scene(), world.gbuffer(), light);
    Equality(trial, world, light).expect(masks[k], fresh[k], "after two updates, and built there");
    judge_mask(trial, drawn, light, moved[k], masks[k]);
  }
}

// Scenes outlive the objects that were built on them.
void combined_features(Trial& trial) {
  std::vector<std::unique_ptr<Case>> cases;
  const std::string settings = with_small_pictures(trial.entry(), "", least_texels);
  Objects moved(trial, settings), built(trial, settings);
  for (const std::uint64_t seed : wanted_seeds(trial)) {
    Case& drawn = *cases.emplace_back(std::make_unique<Case>(trial, seed, settings));
    drawn.find_lights();
    if (!drawn.lights.empty()) follow(trial, drawn, moved, built);
  }
}

}  // namespace

std::vector<Rule> combined_rules() {
  return {
      Rule("combined_features", combined_features, {.sanitized = Sanitized::part},
           "In scenes drawn from seeds, which combine casters with holes, glass, casters that move and three lights at once, "
           "with area and without, it keeps its promise for every light after two updates, and answers as after a build. "
           "Where it is unsupported, the reason names what is: holes, glass, the light, a mesh or the device.",
           "The scene's name has its seed: GNOMON_SEED=3 gnomon check ID --rule combined_features draws that scene alone. "
           "Look first whether each feature holds alone (features, update_equals_build, further_lights).")};
}

}  // namespace gnomon::conformance
