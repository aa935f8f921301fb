// No length is special, neither of a scene nor of a direction: a scene twice as large has the same shadows.
#include <array>
#include <cmath>

#include "measure/conformance/trial.h"
#include "measure/scene/parts.h"

namespace gnomon::conformance {
namespace {

/// Factors of lengths and of directions: powers of two, by which float32 multiplies exactly.
struct Scaling {
  float length, direction;

  /// Of a light's kind or a shape.
  void operator()(auto& item) const {
    const auto lengthen = [&](const char*, auto& part) { part *= length; };
    const auto stretch = [&](const char*, glm::vec3& axis) { axis *= direction; };
    for_each_part(item, lengthen, lengthen, stretch, lengthen);
  }
  void operator()(View& view) const {
    view.eye *= length;
    view.target *= length;
    view.up *= direction;
  }
};

Scene scaled(Scene scene, const Scaling& by) {
  for (Mesh& mesh : scene.meshes) {
    for (glm::vec3& p : mesh.positions) p *= by.length;
    if (mesh.shape) std::visit(by, *mesh.shape);
  }
  for (Light& light : scene.lights) std::visit(by, light.kind);
  for (View& view : scene.views) by(view);
  return scene;
}

/// The same pixels, larger or smaller: the technique is checked, not the rays that make G-buffers.
GBuffer scaled(const GBuffer& gbuffer, const Scaling& by) {
  const auto storage = std::make_shared<std::array<std::vector<float>, 3>>();
  GBuffer result = gbuffer;
  by(result.view);
  const std::span<const float> from[] = {gbuffer.px, gbuffer.py, gbuffer.pz};
  std::span<const float>* const to[] = {&result.px, &result.py, &result.pz};
  for (int k = 0; k < 3; ++k) {
    for (const float p : from[k]) (*storage)[k].push_back(p * by.length);
    *to[k] = (*storage)[k];
  }
  result.storage =
      std::make_shared<std::pair<std::shared_ptr<const void>, std::shared_ptr<const void>>>(gbuffer.storage, storage);
  return result;
}

/// Share of the pixels at which a driver, which draws the same shapes from other numbers, may decide otherwise.
constexpr double most_drawn = 0.001;

void expect_alike(Trial& trial, const std::vector<float>& before, const std::vector<float>& after, const GBuffer& gbuffer) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (before[i] != after[i] && count++ == 0) first = i;
  const double most = draws(trial.entry().about) ? most_drawn * static_cast<double>(before.size()) : 0;
  if (static_cast<double>(count) <= most) return;
  trial.found(fmt::format("{} of {} pixels differ, the first is {} and {}", count, before.size(), before[first], after[first]),
              first, gbuffer);
}

/// A scene, its supported lights, and the mask of one object under each of them.
struct ScaleCase {
  const World& world;
  GBuffer gbuffer;
  std::string settings;
  std::vector<Light> lights;
  std::unique_ptr<Technique> technique = {};
  std::vector<std::vector<float>> masks = {};
};

void check_scaled(Trial& trial, const ScaleCase& original, const std::string& reference, int length, int direction) {
  const Scaling by{std::ldexp(1.0f, length), std::ldexp(1.0f, direction)};
  const Scene& scene = original.world.scene;
  const Scene other = scaled(scene, by);
  const GBuffer picture = scaled(original.gbuffer, by);
  trial.at(fmt::format("{}, lengths times 2^{}, directions times 2^{}", reference, length, direction), original.settings);
  for (std::size_t k = 0; k < original.lights.size(); ++k) {
    Light light = original.lights[k];
    std::visit(by, light.kind);
    trial.at(light);
    const Support is = trial.support(other, light, original.settings),
                  was = trial.support(scene, original.lights[k], original.settings);
    if (is.kind() > was.kind()) continue;  // it reports lower support
    expect_alike(trial, original.masks[k], trial.answer(*original.technique, other, light, picture), picture);
  }
}

// All kinds of lights at the defaults; the first two with every choice, which selects a method, while numbers set an amount.
// One object answers all of them: another rule checks what it keeps from an earlier scene.
void scale(Trial& trial) {
  const char* const reference = "sphere_over_plane:segments=16";
  const auto w = trial.world(reference);
  const auto is_choice = [](const Parameter& parameter) { return dynamic_cast<const Choice*>(&parameter) != nullptr; };
  for (const std::string& settings : settings_of(trial.entry(), is_choice)) {
    const auto named = trial.entry().make();
    named->apply(settings);
    if (!settings.empty() && named->settings().empty()) continue;  // the default
    trial.at(reference, settings);
    ScaleCase original{*w, w->gbuffer(), settings, trial.supported_lights(w->scene, settings)};
    if (!settings.empty() && original.lights.size() > 2) original.lights.resize(2);
    if (original.lights.empty()) continue;
    original.technique = trial.set_up(settings);
    for (const Light& light : original.lights) {
      trial.at(light);
      original.masks.push_back(trial.answer(*original.technique, w->scene, light, original.gbuffer));
    }
    check_scaled(trial, original, reference, -20, 8);
    if (!settings.empty()) continue;
    check_scaled(trial, original, reference, -10, -8);
    check_scaled(trial, original, reference, 10, 3);
  }
}

}  // namespace

std::vector<Rule> scale_rules() {
  return {Rule("scale", scale, {.has_small_pictures = true, .sanitized = Sanitized::nothing},
               "Scale does not matter: a scene 2^10 times larger, or 2^10 or 2^20 times smaller, has the same mask, and so has "
               "one whose directions have other lengths, unless the technique's support is lower there.",
               "Look for a constant in meters, such as a near plane or an epsilon, and for a direction that is compared with "
               "one: take a share of the scene's extent, or of the distance that is at hand.")};
}

}  // namespace gnomon::conformance
