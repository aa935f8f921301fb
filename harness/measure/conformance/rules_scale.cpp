// No length is special, neither of a scene nor of a direction: what is twice as large has the same shadows.
#include <array>
#include <cmath>

#include "measure/conformance/trial.h"

namespace gnomon::conformance {
namespace {

/// Lengths are multiplied by powers of two, which float32 does exactly, and directions by powers of their own.
struct Powers {
  int length, direction;
};

struct Scaling {
  float length, direction;

  void operator()(PointLight& l) const { l.position *= length; }
  void operator()(DirectionalLight& l) const { l.direction *= direction; }
  void operator()(SpotLight& l) const {
    l.position *= length;
    l.direction *= direction;
  }
  void operator()(RectLight& l) const {
    l.center *= length;
    l.half_u *= length;
    l.half_v *= length;
  }
  void operator()(DiscLight& l) const {
    l.center *= length;
    l.radius *= length;
    l.normal *= direction;
  }
  void operator()(SphereLight& l) const {
    l.center *= length;
    l.radius *= length;
  }
  void operator()(Sphere& s) const {
    s.center *= length;
    s.radius *= length;
  }
  void operator()(Cone& s) const {
    s.base *= length;
    s.radius *= length;
    s.height *= length;
    s.axis *= direction;
  }
  void operator()(Disc& s) const {
    s.center *= length;
    s.radius *= length;
    s.normal *= direction;
  }
  void operator()(Triangle& s) const {
    for (glm::vec3& p : s.points) p *= length;
  }
  void operator()(Plane& s) const {
    s.center *= length;
    s.half_u *= length;
    s.half_v *= length;
  }
  void operator()(Box& s) const {
    s.min *= length;
    s.max *= length;
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

Light scaled(Light light, const Scaling& by) {
  std::visit(by, light.kind);
  return light;
}

/// The very pixels, larger or smaller: a technique is asked, and not the rays that make G-buffers.
GBuffer scaled(const GBuffer& gbuffer, const Scaling& by) {
  using Floats = std::vector<float>;
  const auto storage = std::make_shared<std::array<Floats, 3>>();
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

/// Pixels of a picture that a driver may turn over, which draws the same shapes from other numbers.
constexpr double most_drawn = 0.001;

void expect_alike(Trial& trial, const std::vector<float>& before, const std::vector<float>& after, const GBuffer& gbuffer) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = before.size(); i-- > 0;) {
    if (before[i] == after[i]) continue;
    ++count;
    first = i;
  }
  const double most = trial.uses_gl() ? most_drawn * static_cast<double>(before.size()) : 0;
  if (static_cast<double>(count) <= most) return;
  trial.found(fmt::format("{} of {} pixels differ, the first is {} and {}", count, before.size(), before[first], after[first]),
              first, gbuffer);
}

/// A scene, and lights that are supported there, with what one object says of them.
struct ScaleCase {
  const World& world;
  GBuffer gbuffer;
  std::string settings;
  std::vector<Light> lights;
  std::unique_ptr<Technique> technique;
  std::vector<std::vector<float>> masks;
};

void ask_scaled(Trial& trial, const ScaleCase& original, const std::string& reference, const Powers& powers) {
  const Scaling by{std::ldexp(1.0f, powers.length), std::ldexp(1.0f, powers.direction)};
  const Scene& scene = original.world.scene;
  const Scene other = scaled(scene, by);
  const GBuffer picture = scaled(original.gbuffer, by);
  trial.at(fmt::format("{}, lengths times 2^{}, directions times 2^{}", reference, powers.length, powers.direction),
           original.settings);
  for (std::size_t k = 0; k < original.lights.size(); ++k) {
    const Light light = scaled(original.lights[k], by);
    trial.at(light);
    const Support is = trial.support(other, light, original.settings),
                  was = trial.support(scene, original.lights[k], original.settings);
    if (is.kind() > was.kind()) continue;  // it says so
    expect_alike(trial, original.masks[k], trial.answer(*original.technique, other, light, picture), picture);
  }
}

// All kinds of lights as it comes; the first two with every choice, which decides how it is asked, while numbers say how often.
// One object answers all of them: what it keeps from an earlier scene is another rule's affair.
void scale(Trial& trial) {
  const char* const reference = "sphere_over_plane:segments=16";
  const auto w = trial.world(reference);
  const auto is_choice = [](const Parameter& parameter) { return dynamic_cast<const Choice*>(&parameter) != nullptr; };
  for (const std::string& settings : settings_of(trial.entry(), is_choice)) {
    const auto named = trial.entry().make();
    named->apply(settings);
    if (!settings.empty() && named->settings().empty()) continue;  // the default
    trial.at(reference, settings);
    ScaleCase original{.world = *w,
                       .gbuffer = w->gbuffer(),
                       .settings = settings,
                       .lights = trial.supported_lights(w->scene, settings),
                       .technique = {},
                       .masks = {}};
    if (!settings.empty() && original.lights.size() > 2) original.lights.resize(2);
    if (original.lights.empty()) continue;
    original.technique = trial.set_up(settings);
    for (const Light& light : original.lights) {
      trial.at(light);
      original.masks.push_back(trial.answer(*original.technique, w->scene, light, original.gbuffer));
    }
    ask_scaled(trial, original, reference, {-20, 8});
    if (!settings.empty()) continue;
    ask_scaled(trial, original, reference, {-10, -8});
    ask_scaled(trial, original, reference, {10, 3});
  }
}

}  // namespace

std::vector<Rule> scale_rules() {
  return {
      {.name = "scale",
       .sentence =
           "Scale does not matter: a scene 2^10 times larger, or 2^10 or 2^20 times smaller, has the same mask, and so has "
           "one whose directions have other lengths, unless the technique's support is lower there.",
       .advice = "Look for a constant in meters, such as a near plane or an epsilon, and for a direction that is compared "
                 "with one: take a share of the scene's extent, or of the distance that is at hand.",
       .check = scale,
       .has_small_pictures = true,
       .sanitized = Sanitized::nothing},
  };
}

}  // namespace gnomon::conformance
