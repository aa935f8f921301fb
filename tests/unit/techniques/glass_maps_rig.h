#pragma once
// Scenes of glass, and the techniques that draw depth maps run on them, for tests of their parameter glass.
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/maps/glass_setting.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "masked.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

namespace glass_maps_rig {
using namespace gnomon;

inline constexpr const char* maps[] = {"shadow_map",
                                       "cascaded_map",
                                       "warped_map",
                                       "virtual_map",
                                       "variance_map",
                                       "moment_map",
                                       "exponential_map",
                                       "exponential_variance_map",
                                       "percentage_closer_soft",
                                       "backprojected_map"};
inline constexpr const char* hard_homes[] = {"shadow_map", "virtual_map", "variance_map"};
inline constexpr const char* soft_maps[] = {"percentage_closer_soft", "backprojected_map"};

inline const Light sun{.name = "sun", .kind = DirectionalLight{{0.3f, -1, 0.2f}}};
inline const Light point{.name = "point", .kind = PointLight{{0.7f, 5, 0.4f}}};
inline const Light lamp{.name = "lamp",
                        .kind = RectLight{.center = {0.5f, 5, 0}, .half_u = {0.4f, 0, 0}, .half_v = {0, 0, 0.4f}}};
inline const Light disc_lamp{.name = "disc_lamp",
                             .kind = DiscLight{.center = {0.5f, 5, 0}, .normal = {0, -1, 0}, .radius = 0.4f}};

inline bool is_soft(std::string_view id) { return std::ranges::find(soft_maps, id) != std::end(soft_maps); }

inline Mesh moved(Mesh mesh, const glm::vec3& by) {
  for (glm::vec3& p : mesh.positions) p += by;
  finish(mesh);
  return mesh;
}
inline Mesh of_glass(Mesh mesh, std::shared_ptr<const Transmission> glass, bool is_seen) {
  mesh.transmission = std::move(glass);
  mesh.seen = is_seen;
  return mesh;
}
inline std::shared_ptr<const Transmission> clear(float share) { return std::make_shared<const Transmission>(glm::vec3(share)); }

/// Over a ground, beside an opaque card: a card of glass with holes, a body of glass, and smoke whose texels let everything
/// through, nothing, and all between: 1 - 0.97 and 0.03 are less than 1/20.
inline Scene glass_over_ground(bool is_seen = false) {
  const std::vector<float> smoke = {1, 0.97f, 0.5f, 0.03f, 0, 1, 0.97f, 0.5f, 0.03f};
  Scene scene;
  scene.name = "glass_over_ground";
  scene.meshes = {hand_made::square(3, 0), moved(hand_made::square(0.4f, 1.5f), {0.9f, 0, -0.9f}),
                  of_glass(moved(masked::card(0.6f, 1, masked::checker(4, 4)), {-0.3f, 0, -0.5f}), clear(0.5f), is_seen),
                  of_glass(small_world::box({-1.8f, 0.4f, 0.1f}, {-1.2f, 0.9f, 0.7f}), clear(0.4f), is_seen),
                  of_glass(moved(masked::card(0.6f, 0.8f, nullptr), {0.3f, 0, 0.9f}),
                           std::make_shared<const Transmission>(3, 3, 1, smoke), is_seen)};
  for (Mesh& mesh : scene.meshes) finish(mesh);
  scene.views = {{.name = "view", .eye = {1.5f, 4, 3}, .target = {0, 0.4f, 0}}};
  scene.lights = {sun, point};
  return scene;
}
/// A sheet of glass over a ground.
inline Scene sheet_over_ground(float share) {
  Scene scene;
  scene.name = "sheet_over_ground";
  scene.meshes = {hand_made::square(3, 0), of_glass(hand_made::square(1, 1), clear(share), false)};
  scene.views = {{.name = "view", .eye = {1.5f, 4, 3}, .target = {0, 0.4f, 0}}};
  return scene;
}

/// What the rules make of a scene, as scenes without transmission. A body of glass is drawn whole, as an open mesh is.
inline Scene taken_for(GlassAs as, Scene scene) {
  for (Mesh& mesh : scene.meshes) {
    if (!mesh.transmission) continue;
    if (as == GlassAs::none) {
      mesh.casts = false;
    } else {
      mesh.transmission = nullptr;
      if (!mesh.alpha_mask) mesh.uv.clear();
      ++mesh.facts.boundary_edge_count;
    }
  }
  return scene;
}
struct Rule {
  GlassAs as;
  const char *value, *why;
  std::string setting() const { return fmt::format("glass={}", value); }
};
inline constexpr Rule rules[] = {{GlassAs::opaque, "opaque", "glass is taken for opaque"},
                                 {GlassAs::none, "none", "glass is left out"}};

class TestRig : public testing::Test {
 protected:
  TestRig() { process_context(); }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }

  static GBuffer picture(const Scene& scene) {
    return make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), scene.views[0], 160, 120, Truth::mesh);
  }
  static Support support(const char* id, const std::string& settings, const Scene& scene, const Light& light) {
    const TechniqueEntry& entry = registry().technique(id);
    const auto technique = entry.make();
    technique->apply(settings);
    return support_of(entry.about, *technique, scene, light, scene.views[0]);
  }
  static small_world::Run run(const char* id, const std::string& settings, const Scene& scene, const Light& light,
                              const GBuffer& gbuffer) {
    EXPECT_TRUE(support(id, settings, scene, light)) << id << ' ' << settings;
    small_world::Run run{registry().technique(id).make(), {}};
    run.technique->apply(settings);
    run.technique->setup();
    run.technique->build(scene);
    answer(run, light, gbuffer);
    return run;
  }
  static void answer(small_world::Run& run, const Light& light, const GBuffer& gbuffer) {
    run.technique->relight(light);
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    run.technique->resolve(gbuffer, mask);
    const auto pixels = mask.read();
    run.mask.assign(pixels.begin(), pixels.end());
  }
  static std::vector<float> decided(const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    std::vector<float> visibility(gbuffer.size());
    ExactScene(scene).decide(gbuffer, light, visibility);
    return visibility;
  }
  static std::string cause(const Technique& technique, std::size_t pixel) {
    const auto why = technique.explain(pixel);
    return why ? why->cause : "";
  }
};

}  // namespace glass_maps_rig
