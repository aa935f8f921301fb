#pragma once
// Small scenes under a sun with a reference and a mask to be spoiled, for tests of the causes of errors.
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "hand_made.h"
#include "measure/cause/causes.h"
#include "measure/frame/light_rays.h"
#include "test_map.h"

namespace gnomon::cause_world {

using Causes = std::map<std::string, std::uint64_t>;

/// A scene seen straight from above: pixel columns run along x, rows along z. At the height 10 of the eye, 64 pixels
/// across 8.28 m of ground: one pixel is 0.129 m.
struct World {
  explicit World(Scene the_scene, Light the_light = hand_made::sun({0, -1, 0}),
                 View view = {.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}}, Truth geometry = Truth::mesh)
      : scene(std::move(the_scene)), light(std::move(the_light)), casters(scene, geometry, RayScene::Which::casters) {
    const RayScene everything(scene, geometry, RayScene::Which::seen);
    gbuffer = make_gbuffer(scene, everything, view, 64, 64, geometry);
    truth.resize(gbuffer.size());
    trace_shadows(casters, scene, gbuffer, light, truth);
    classes = classify(scene, casters, gbuffer, light, truth, find_silhouettes(everything, gbuffer));
    nearest_caster = find_nearest_casters(scene, casters, gbuffer, light, truth);
    mask = truth;
  }

  Reference reference() const { return {truth, classes, nearest_caster, nullptr}; }
  /// The causes that occur; one account for all pixels.
  Causes causes(const std::function<std::optional<Explanation>(std::uint32_t)>& why) const {
    const auto explain = [&](std::span<const std::uint32_t> pixels) {
      std::vector<std::optional<Explanation>> all;
      for (const std::uint32_t i : pixels) all.push_back(why(i));
      return all;
    };
    const Reference r = reference();
    const std::vector<Cause> found = find_causes(
        {scene, casters, gbuffer, light, r, mask, right_on_mesh, explain, LightShareKind::area, own_causes, rasterizes});
    EXPECT_EQ(found.size(), mask.size());
    for (std::size_t i = 0; i < found.size(); ++i)
      EXPECT_EQ(found[i] != Cause::none, classes[i] == PixelClass::T && is_wrong(mask[i], truth[i])) << i;
    Causes counts = count_causes(found, own_causes);
    std::erase_if(counts, [](const auto& item) { return item.second == 0; });
    return counts;
  }
  Causes causes() const {
    return causes([](std::uint32_t) { return std::nullopt; });
  }
  Causes causes(const TestMap& map) const {
    return causes([&](std::uint32_t i) { return map.explain(gbuffer, i); });
  }
  /// The mask of a map. With a filter, only pixels where it holds take the map's answer.
  void take(const TestMap& map, const std::function<bool(std::uint32_t, float)>& wanted = nullptr) {
    for (std::uint32_t i = 0; i < mask.size(); ++i) {
      if (!faces_light(scene, gbuffer, light, i)) continue;
      const float answer = map.visibility(gbuffer, i);
      if (!wanted || wanted(i, answer)) mask[i] = answer;
    }
  }
  std::uint64_t wrong() const {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) count += classes[i] == PixelClass::T && is_wrong(mask[i], truth[i]);
    return count;
  }
  /// The pixel whose point is nearest to (x, z) of the ground.
  std::uint32_t pixel(double x, double z) const {
    std::uint32_t best = 0;
    const auto distance = [&](std::uint32_t i) { return std::hypot(gbuffer.px[i] - x, gbuffer.pz[i] - z); };
    for (std::uint32_t i = 1; i < mask.size(); ++i)
      if (distance(i) < distance(best)) best = i;
    EXPECT_LT(distance(best), 0.1);
    return best;
  }
  glm::dvec3 point(std::uint32_t i) const { return gbuffer.position(i); }

  Scene scene;
  Light light;
  RayScene casters;
  GBuffer gbuffer;
  std::vector<float> truth, mask;
  std::vector<PixelClass> classes;
  std::vector<std::uint32_t> nearest_caster;
  std::vector<std::uint8_t> right_on_mesh;
  std::vector<CauseInfo> own_causes;
  bool rasterizes = true;
};

/// Horizontal rectangle at a height, and the ground: meshes 1 and 0.
inline Mesh plate(float x0, float x1, float z0, float z1, float height) {
  return hand_made::mesh_of({{x0, height, z0}, {x0, height, z1}, {x1, height, z1}, {x1, height, z0}}, {{0, 1, 2}, {0, 2, 3}});
}
inline Scene on_ground(std::vector<Mesh> more) {
  Scene scene;
  scene.meshes = {hand_made::square(6, 0)};
  scene.meshes.insert(scene.meshes.end(), more.begin(), more.end());
  return scene;
}

/// A sun at 45 degrees: a plate at height h has its shadow h beside it, where the eye above sees it.
inline const Light slanted = hand_made::sun({1, -1, 0});

/// A tap of that sun through the ground's point (x, z), from height 20, that holds a surface at a height; minus infinity:
/// nothing.
inline Tap through(double x, double z, double height) {
  const glm::dvec3 direction = glm::normalize(glm::dvec3(1, -1, 0));
  return {{x - 20, 20, z}, direction, 1, (20 - height) * std::sqrt(2.0)};
}
inline Explanation tapped(const Tap& tap, double texel_width, double bias = 0) {
  Explanation why;
  why.taps = {tap};
  why.texel_width = texel_width;
  why.bias = bias;
  return why;
}

/// A plate whose shadow on the ground is |x| < 1, |z| < 1.
inline World shadow_of_two_by_two() { return World(on_ground({plate(-3, -1, -1, 1, 2)}), slanted); }

/// A screen standing on the ground at x = 0, 3 m high, and a sun at 45 degrees: at s > 0 behind it the only occluder is
/// s sqrt(2) away.
inline World behind_a_screen() {
  const Mesh screen = hand_made::mesh_of({{0, 0, -3}, {0, 0, 3}, {0, 3, 3}, {0, 3, -3}}, {{0, 1, 2}, {0, 2, 3}});
  return World(on_ground({screen}), slanted);
}

}  // namespace gnomon::cause_world
