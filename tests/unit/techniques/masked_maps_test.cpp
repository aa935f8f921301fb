// What draws leaves holes out: maps of every kind, projected casters, and the depth of the picture.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "masked.h"
#include "measure/conformance/gl_state.h"

namespace masked_maps_test {
using namespace gnomon;

/// A card with 8 x 8 texels, set like the squares of a chessboard, over a ground, beside an opaque card.
Scene cards_over_ground() {
  Scene scene;
  scene.name = "cards_over_ground";
  scene.meshes = {hand_made::square(3, 0), masked::card(1, 1, masked::checker(8, 8)), hand_made::square(0.4f, 1.5f)};
  for (Mesh& mesh : scene.meshes) finish(mesh);
  scene.views = {{.name = "view", .eye = {1.5f, 4, 3}, .target = {0, 0.4f, 0}}};
  scene.lights = {{.name = "point", .kind = PointLight{{0.7f, 5, 0.4f}}},
                  {.name = "sun", .kind = DirectionalLight{{0.3f, -1, 0.2f}}},
                  {.name = "spot", .kind = SpotLight{.position = {0.5f, 5, 0}, .direction = {-0.1f, -1, 0}}}};
  return scene;
}

class MaskedMaps : public testing::Test {
 protected:
  MaskedMaps() { process_context(); }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }

  /// Mean of |V - V_exact| over the pixels that face the light, of one mesh where that is given.
  static double error(const std::string& id, const std::string& settings, const Scene& scene, const Light& light,
                      const GBuffer& gbuffer, std::optional<std::uint32_t> mesh = {}) {
    const TechniqueEntry& entry = registry().technique(id);
    const auto technique = entry.make();
    technique->apply(settings);
    EXPECT_TRUE(support_of(entry.about, *technique, scene, light, scene.views[0])) << id;
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    technique->resolve(gbuffer, mask);
    std::vector<float> truth(gbuffer.size());
    ExactScene(scene).decide(gbuffer, light, truth);
    const auto pixels = mask.read();
    double sum = 0;
    int count = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (!faces_light(scene, gbuffer, light, i) || (mesh && gbuffer.mesh[i] != *mesh)) continue;
      sum += std::abs(pixels[i] - truth[i]);
      ++count;
    }
    return sum / count;
  }
  static GBuffer picture(const Scene& scene) {
    return make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), scene.views[0], 192, 144, Truth::mesh);
  }
};

struct Case {
  const char *id, *settings;
  double most;
  const char* lights;
};

// A card of 2 m at a map of 1024 texels: edges of squares of 1/4 m are off by half a texel of some 6 mm on each side, 2 % of
// the card's shadow, which is a tenth of the picture; filters of several texels blur more.
TEST_F(MaskedMaps, every_map_sees_holes) {
  const Scene scene = cards_over_ground();
  const GBuffer gbuffer = picture(scene);
  const Case cases[] = {{"shadow_map", "resolution=2048", 0.01, "point sun spot"},
                        {"shadow_map", "resolution=2048,filter=pcf", 0.02, "point sun spot"},
                        {"cascaded_map", "", 0.01, "sun"},
                        {"warped_map", "", 0.01, "sun"},
                        {"virtual_map", "", 0.01, "point sun spot"},
                        {"variance_map", "", 0.05, "point sun"},
                        {"moment_map", "", 0.05, "point sun"},
                        {"exponential_map", "", 0.05, "point sun"},
                        {"exponential_variance_map", "", 0.05, "point sun"},
                        {"planar_projected", "", 0.01, "point sun spot"}};
  Scene filled = scene;
  filled.meshes[1].alpha_mask = nullptr;
  for (const Case& one : cases)
    for (const Light& light : scene.lights) {
      if (std::string_view(one.lights).find(light.name) == std::string_view::npos) continue;
      std::vector<float> truth(gbuffer.size()), of_filled(gbuffer.size());
      ExactScene(scene).decide(gbuffer, light, truth);
      ExactScene(filled).decide(gbuffer, light, of_filled);
      double holes = 0;
      for (std::size_t i = 0; i < gbuffer.size(); ++i) holes += truth[i] - of_filled[i];
      ASSERT_GT(holes / double(gbuffer.size()), 0.05) << "light falls through the holes";
      EXPECT_LT(error(one.id, one.settings, scene, light, gbuffer), one.most)
          << one.id << ":" << one.settings << " " << light.name;
    }
}

// A leaning card is nearer to the light at one end: its shadow on the ground is in perspective, clipped or not.
TEST_F(MaskedMaps, the_mask_is_projected_with_a_leaning_card) {
  Scene scene = cards_over_ground();
  for (glm::vec3& point : scene.meshes[1].positions) point.y += 0.8f * point.x;
  finish(scene.meshes[1]);
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : scene.lights)
    for (const char* settings : {"", "unclipped=true"})
      EXPECT_LT(error("planar_projected", settings, scene, light, gbuffer, 0), 0.01) << light.name << ' ' << settings;
}

// A filled card of the same size, drawn after one with holes, is not affected by it, and the other way round.
TEST_F(MaskedMaps, a_mask_does_not_stay_for_the_next_scene) {
  const Scene scene = cards_over_ground();
  Scene filled = scene;
  filled.meshes[1].alpha_mask = nullptr;
  filled.meshes[1].uv.clear();
  const GBuffer first = picture(scene), second = picture(filled);
  for (int round = 0; round < 2; ++round) {
    EXPECT_LT(error("shadow_map", "resolution=2048", scene, scene.lights[1], first), 0.01);
    EXPECT_LT(error("shadow_map", "resolution=2048", filled, filled.lights[1], second), 0.01);
  }
}

// The first has places below 0.
TEST_F(MaskedMaps, two_masks_of_other_sizes_and_wraps_are_told_apart) {
  Scene scene = cards_over_ground();
  scene.meshes[1] = masked::card(0.8f, 1, masked::mask_of({"#...", "....", "..#.", "...."}, masked::Wrap::mirror), -3);
  scene.meshes.push_back(masked::card(0.9f, 2, masked::mask_of({"##...", "#....", "....#"}, masked::Wrap::clamp), 2));
  for (Mesh& mesh : scene.meshes) finish(mesh);
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : scene.lights) {
    EXPECT_LT(error("shadow_map", "resolution=4096", scene, light, gbuffer), 0.015) << light.name;
    EXPECT_LT(error("virtual_map", "", scene, light, gbuffer), 0.015) << light.name;
    EXPECT_LT(error("planar_projected", "", scene, light, gbuffer), 0.015) << light.name;
  }
}

// Depth is near_plane over the distance along the axis: behind a hole that of what the G-buffer shows there. Where a texel's
// edge passes within rounding of a pixel's center it may be the other.
TEST_F(MaskedMaps, the_depth_of_the_picture_has_holes) {
  const Scene scene = cards_over_ground();
  const GBuffer gbuffer = picture(scene);
  const double near = gbuffer_textures(gbuffer, scene).near_plane;
  const std::vector<float> depths = read_texels<float>(depth_stencil(scene, gbuffer).texture, GL_DEPTH_COMPONENT);
  const glm::dvec3 eye = gbuffer.view.eye, forward = glm::normalize(glm::dvec3(gbuffer.view.target) - eye);
  int wrong = 0, on_card = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i)) continue;
    on_card += gbuffer.mesh[i] == 1;
    const double distance = glm::dot(forward, glm::dvec3(gbuffer.position(i)) - eye);
    wrong += std::abs(depths[i] * distance / near - 1) > 1e-3;
  }
  EXPECT_GT(on_card, 500);
  EXPECT_LE(wrong, 20);
}

}  // namespace masked_maps_test
