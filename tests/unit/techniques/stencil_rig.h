#pragma once
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"
#include "volume_scenes.h"

extern "C" void gnomon_technique_stencil_volume(gnomon::Registry&);

// Stencil volumes brought up to masks, and how these compare with each other and with exact signs.
namespace stencil_rig {
using namespace gnomon;
using namespace volume_scenes;

/// One object for all tests and each setup, since its shaders cost more than its pictures; every use begins at the defaults and
/// at `build`.
class TestRig : public testing::Test {
 protected:
  static void SetUpTestSuite() { process_context(); }
  static void TearDownTestSuite() { made_.clear(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static std::unique_ptr<Technique> make(const std::string& settings) {
    Registry registry;
    gnomon_technique_stencil_volume(registry);
    auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique;
  }
  static Technique& technique(const std::string& settings) {
    auto fresh = make(settings);
    std::string setup;  // what it depends on
    for (const Parameter* parameter : fresh->parameters())
      if (parameter->spoils() == Stage::setup) setup += parameter->text() + ' ';
    std::unique_ptr<Technique>& place = made_[setup];
    if (!place) {
      place = std::move(fresh);
      place->setup();
    }
    technique_ = place.get();
    for (Parameter* parameter : technique_->parameters()) parameter->set(parameter->default_text());
    technique_->apply(settings);
    return *technique_;
  }
  static Support supports(const std::string& settings, const Scene& scene, const Light& light, const View& view) {
    return make(settings)->supports(scene, light, view);
  }
  static std::vector<float> mask(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    Technique& t = technique(settings);
    t.build(scene);
    t.relight(light);
    VisibilityMask mask(g.width, g.height);
    t.resolve(g, mask);
    const auto pixels = mask.read();
    return {pixels.begin(), pixels.end()};
  }
  /// Of the last mask.
  static double count(std::string_view name) {
    for (const Count& count : technique_->counts())
      if (count.name == name) return count.value;
    ADD_FAILURE() << "no count " << name;
    return 0;
  }
  /// Every setting of every parameter with every other one, but for the near cap as published.
  static std::vector<std::string> every_setting() {
    std::vector<std::string> all{""};
    for (const auto fresh = make(""); const Parameter* parameter : fresh->parameters()) {
      if (parameter->name().starts_with("mask")) continue;  // for scenes with holes
      std::vector<std::string> longer;
      for (const std::string& settings : all)
        for (const std::string& value : parameter->probes())
          if (value != "rectangle")
            longer.push_back(fmt::format("{}{}{}={}", settings, settings.empty() ? "" : ",", parameter->name(), value));
      all = longer;
    }
    return all;
  }
  /// The masks of all settings that say full for this scene, light and view are the same; returns that mask.
  static std::vector<float> expect_all_agree(const Scene& scene, const Light& light, const GBuffer& g,
                                             const std::string& what) {
    std::vector<float> first;
    std::string first_settings;
    for (const std::string& settings : every_setting()) {
      if (supports(settings, scene, light, g.view).kind() != Support::Kind::full) continue;
      const std::vector<float> now = mask(settings, scene, light, g);
      if (first.empty()) {
        first = now, first_settings = settings;
        continue;
      }
      const auto [here, there] = std::ranges::mismatch(first, now);
      EXPECT_TRUE(here == first.end()) << what << ": " << settings << " differs from " << first_settings << " in "
                                       << differences(first, now) << " pixels, first " << here - first.begin();
    }
    return first;
  }
  static std::ptrdiff_t differences(const std::vector<float>& a, const std::vector<float>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), std::ptrdiff_t{0}, std::plus(), std::not_equal_to());
  }

  inline static std::map<std::string, std::unique_ptr<Technique>> made_;
  inline static Technique* technique_ = nullptr;  // the last one used
};

/// The answer of exact signs for every pixel, and for a ray beside its center.
struct Exact {
  const Scene& scene;
  const GBuffer& g;
  const Light& light;
  ExactScene casters;
  std::vector<float> visibility;

  Exact(const Scene& s, const GBuffer& gbuffer, const Light& l) : scene(s), g(gbuffer), light(l), casters(s) {
    visibility.resize(g.size());
    casters.decide(g, light, visibility);
  }
  /// Whether a pixel may be `value` whose sample point lies `by` pixels off its center. Where another triangle than that of the
  /// pixel is seen there, the pixel is on an edge, where side quads begin, and both values may be.
  bool may_be(float value, std::size_t i, const glm::dvec2& by) const {
    const View& view = g.view;
    const glm::dvec3 eye = view.eye, forward = glm::normalize(glm::dvec3(view.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(view.up))), up = glm::cross(right, forward);
    const double tangent = std::tan(glm::radians(double(view.fov_y_degrees)) / 2);
    const double x = double(i % g.width) + 0.5 + by.x, y = double(i / g.width) + 0.5 + by.y;
    const glm::dvec3 ray =
        forward + right * (tangent * g.width / g.height * (2 * x / g.width - 1)) + up * (tangent * (1 - 2 * y / g.height));
    const small_world::Hit hit = small_world::nearest(scene, eye, ray, 0);
    if (hit.mesh != g.mesh[i] || hit.triangle != g.triangle[i]) return true;
    const Triangle corner = corners(scene.meshes[hit.mesh], hit.triangle);
    const glm::dvec3 point = eye + ray * hit.t, a = corner.points[0];
    glm::dvec3 normal = glm::cross(glm::dvec3(corner.points[1]) - a, glm::dvec3(corner.points[2]) - a);
    if (glm::dot(normal, ray) > 0) normal = -normal;
    if (glm::dot(normal, to_light(homogeneous(light), point)) <= 0 || !in_spot_cone(light, point)) return value == 1;
    ExactTally tally;
    return casters.occluded({glm::vec3(point), hit.mesh, hit.triangle}, homogeneous(light), tally).blocked == (value == 0);
  }
  /// Whether a move of the sample point by the rasterizer's rounding of vertices, 1/512 px along x and y, gives `value`.
  bool snaps_to(std::size_t i, float value) const {
    for (const double x : {-1, 0, 1})
      for (const double y : {-1, 0, 1})
        if (may_be(value, i, glm::dvec2(x, y) / 512.0)) return true;
    return false;
  }
  /// Whether the answer is another one within 1.5 px.
  bool near_boundary(std::size_t i) const {
    const int x = static_cast<int>(i) % g.width, y = static_cast<int>(i) / g.width;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, g.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, g.width - 1); ++u)
        if (visibility[std::size_t(v) * g.width + u] != visibility[i]) return true;
    return false;
  }
};

/// How a mask compares with exact signs over the pixels that face the light.
struct Tally {
  int tested = 0, dark = 0, wrong = 0;
  int not_snapped = 0;  ///< wrong, not grazing (2 degrees), and not by the rasterizer's rounding
  int unexplained = 0;  ///< of these, those not at a boundary of the exact answer either
  void add(const Exact& exact, const std::vector<float>& mask) {
    const GBuffer& g = exact.g;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (!faces_light(exact.scene, g, exact.light, i)) {
        EXPECT_EQ(mask[i], 1) << "pixel " << i << " does not face the light";
        continue;
      }
      ++tested, dark += exact.visibility[i] == 0;
      if (mask[i] == exact.visibility[i]) continue;
      ++wrong;
      const glm::dvec3 to = to_light(homogeneous(exact.light), g.position(i));
      const bool grazing = glm::dot(glm::dvec3(g.normal(i)), to) < 0.035 * glm::length(to);
      if (grazing || exact.snaps_to(i, mask[i])) continue;
      ++not_snapped, unexplained += !exact.near_boundary(i);
    }
  }
};

inline std::vector<Light> lights_around(Random& random) {
  const glm::vec3 above = random_point(random, {-2, 3.5f, -2}, {2, 6, 2});
  return {{.name = "point", .kind = PointLight{above}},
          {.name = "among", .kind = PointLight{random_point(random, {-1, 0.5f, -1}, {1, 2, 1})}},
          {.name = "sun", .kind = DirectionalLight{random_point(random, {-1, -1, -1}, {1, -0.3f, 1})}},
          {.name = "below", .kind = PointLight{random_point(random, {-2, -4, -2}, {2, -1, 2})}},
          {.name = "spot", .kind = SpotLight{above, -above, 15, 30}}};
}

inline View random_view(Random& random, bool among) {
  return {.eye = among ? random_point(random, {-1, 0.5f, -1}, {1, 2, 1}) : random_point(random, {-2, 2, 4}, {2, 5, 6}),
          .target = random_point(random, glm::vec3(-0.5f), glm::vec3(0.5f)),
          .fov_y_degrees = among ? 90.0f : 45.0f};
}

inline Scene casters_over_ground(Random& random, int count, const Kinds& kinds = {}) {
  Scene scene = scene_of({small_world::ground(3)});
  for (Mesh& mesh : random_casters(random, count, {-2, 0.1f, -2}, {2, 2.5f, 2}, kinds)) scene.meshes.push_back(mesh);
  scene.meshes[0].casts = random.below(2);
  return scene;
}

/// `layers` horizontal squares above the eye's head, and a post in sight.
inline Scene under_roofs(int layers) {
  Scene scene = scene_of({small_world::ground(6), small_world::box({-0.5f, 0, -3}, {0.25f, 1, -2.5f})});
  for (int i = 0; i < layers; ++i) {
    Mesh roof = small_world::ground(1.5f, 3 + 0.25f * static_cast<float>(i));
    scene.meshes.push_back(roof);
  }
  return scene;
}

}  // namespace stencil_rig
