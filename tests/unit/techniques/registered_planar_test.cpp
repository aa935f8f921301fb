// Registered planar shadows: sums of projections against exact shares, on both sides of a plane, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "device/context.h"
#include "hand_made.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_registered_planar(gnomon::Registry&);
extern "C" void gnomon_technique_exact_area(gnomon::Registry&);

namespace registered_planar_test {
using namespace gnomon;

class RegisteredPlanar : public testing::Test {
 protected:
  RegisteredPlanar() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
  static std::vector<float> run(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings) {
    return small_world::run(gnomon_technique_registered_planar, settings, scene, light, g).mask;
  }
  static std::vector<float> exact(const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_exact_area, "", scene, light, g).mask;
  }
  static Support supports(const Scene& scene, const Light& light, const std::string& settings = "") {
    Registry registry;
    gnomon_technique_registered_planar(registry);
    const auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique->supports(scene, light, {});
  }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

Scene box_on_ground() {
  Scene scene;
  scene.meshes.push_back(small_world::ground(3));
  scene.meshes.push_back(small_world::box({-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}));
  scene.meshes.push_back(small_world::box({0.8f, 0.5f, -1.2f}, {1.4f, 0.9f, -0.4f}));
  return scene;
}

const std::vector<Light> lights = {
    {.name = "rect", .kind = RectLight{{-1, 4, 1}, {0.5f, 0, 0}, {0, 0, 0.5f}}},
    {.name = "front", .kind = RectLight{{-1, 4, 1}, {0.5f, 0, 0.1f}, {0, 0.2f, 0.5f}, Emits::in_front}},
    {.name = "disc", .kind = DiscLight{{-1, 4, 1}, {0.2f, -1, 0}, 0.5f}},
    {.name = "globe", .kind = SphereLight{{-1, 4, 1}, 0.5f}},
};

// A texel of the ground is 6 m / 256, some tenth of a penumbra: what is left of the error is that of 256 places, some
// 256^-0.75.
TEST_F(RegisteredPlanar, it_agrees_with_exact_shares_under_every_kind_of_light) {
  const Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, 120, 90);
  for (const Light& light : lights) {
    const std::vector<float> mask = run(scene, light, g, "samples=256,resolution=256"), truth = exact(scene, light, g);
    double sum = 0, worst = 0;
    int asked = 0, in_penumbra = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) {
        EXPECT_EQ(mask[i], 1) << light.name;
        continue;
      }
      ++asked;
      in_penumbra += truth[i] > 0.05 && truth[i] < 0.95;
      sum += std::abs(mask[i] - truth[i]);
      worst = std::max<double>(worst, std::abs(mask[i] - truth[i]));
    }
    EXPECT_GT(in_penumbra, 100) << light.name;
    EXPECT_LT(sum / asked, 0.004) << light.name << ", worst " << worst;
  }
}

// A lamp that stands across the plane of a wall shows itself to both sides of it: each has what is before it.
TEST_F(RegisteredPlanar, both_sides_of_a_plane_have_sums_of_their_own) {
  Scene scene;
  scene.meshes.push_back(small_world::make_mesh({{0, -2, -2}, {0, 2, -2}, {0, 2, 2}, {0, -2, 2}}, {{0, 1, 2}, {0, 2, 3}}));
  scene.meshes.push_back(small_world::box({0.4f, 1, -0.3f}, {0.7f, 1.3f, 0.3f}));
  scene.meshes.push_back(small_world::box({-0.7f, 0.6f, -0.3f}, {-0.4f, 0.9f, 0.3f}));
  const Light light{.name = "lamp", .kind = RectLight{{0, 4, 0}, {1, 0, 0}, {0, 0, 0.5f}}};
  for (const float side : {1.0f, -1.0f}) {
    const GBuffer g = small_world::make_gbuffer(scene, {.eye = {6 * side, 1, 0.5f}, .target = {0, 0, 0}}, 90, 90);
    const std::vector<float> mask = run(scene, light, g, "samples=256,resolution=256"), truth = exact(scene, light, g);
    int in_penumbra = 0, wrong = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.is_background(i) || g.mesh[i] != 0) continue;
      in_penumbra += truth[i] > 0.05 && truth[i] < 0.95;
      wrong += std::abs(mask[i] - truth[i]) > 0.06;
    }
    EXPECT_GT(in_penumbra, 100) << side;
    EXPECT_LE(wrong, in_penumbra / 20) << side;
  }
}

// Two boxes one behind the other, seen from the light, hide it once.
TEST_F(RegisteredPlanar, triangles_that_hide_the_same_point_count_once) {
  Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, 80, 60);
  const std::vector<float> once = run(scene, lights[0], g, "");
  const Mesh box = scene.meshes[1];
  for (int k = 0; k < 3; ++k) scene.meshes.push_back(box);
  EXPECT_EQ(run(scene, lights[0], g, ""), once);
}

TEST_F(RegisteredPlanar, a_light_that_shrinks_to_a_point_is_its_hard_shadow_but_for_a_texel) {
  const Scene scene = box_on_ground();
  const GBuffer g = small_world::make_gbuffer(scene, view, 80, 60);
  const std::vector<float> mask =
      run(scene, {.name = "dot", .kind = RectLight{{-1, 4, 1}, {1e-20f, 0, 0}, {0, 0, 1e-20f}}}, g, "");
  const Light point{.name = "point", .kind = PointLight{{-1, 4, 1}}};
  int asked = 0, wrong = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, point, i)) continue;
    ++asked;
    wrong += std::abs(mask[i] - (small_world::caster_distance(scene, point, g.position(i)) < INFINITY ? 0 : 1)) > 0.5;
  }
  EXPECT_LE(wrong, asked / 200);
}

// A texture of 16 texels over 6 m, one of them around: its texels are 6 m / 14 wide. The plate covers x < 0 of the ground under
// a light of no size: seven texels of each row are dark.
TEST_F(RegisteredPlanar, the_layer_shows_texels_in_turn_and_what_they_hold) {
  Scene scene;
  scene.meshes = {small_world::ground(3),
                  small_world::make_mesh({{-3, 0.5f, -3}, {-3, 0.5f, 3}, {0, 0.5f, 3}, {0, 0.5f, -3}}, {{0, 1, 2}, {0, 2, 3}})};
  scene.meshes[1].receives = false;
  constexpr float texel = 6.0f / 14;
  hand_made::Picture picture(14 * 4 + 1, 1);
  for (std::size_t i = 0; i < 14 * 4; ++i)
    picture.set(i, {-3 + (static_cast<float>(i) + 0.5f) / 4 * texel, 0, 0.5f * texel}, {0, 1, 0}, 0, 0);
  picture.set(14 * 4, {-1, 0.5f, 0}, {0, 1, 0}, 1, 0);
  const auto run =
      small_world::run(gnomon_technique_registered_planar, "samples=4,resolution=16", scene,
                       {.name = "dot", .kind = RectLight{{0, 4, 0}, {1e-6f, 0, 0}, {0, 0, 1e-6f}}}, picture.gbuffer);
  const std::vector<float> shown = run.technique->draw_debug("texture");
  const std::vector<Swatch> legend = run.technique->debug_layers()[0].legend;
  const auto swatch_of = [&](std::size_t i) {
    for (std::size_t k = 0; k < legend.size(); ++k)
      if (glm::distance(glm::vec3(shown[3 * i], shown[3 * i + 1], shown[3 * i + 2]), glm::vec3(legend[k].color)) < 1e-5f)
        return static_cast<int>(k);
    return -1;
  };
  const int first = swatch_of(0);
  EXPECT_TRUE(first == 2 || first == 3) << first;
  for (std::size_t i = 0; i < 14 * 4; ++i) EXPECT_EQ(swatch_of(i), (first + i / 4) % 2 + (i / 4 < 7 ? 2 : 0)) << i;
  EXPECT_EQ(swatch_of(14 * 4), -1) << "no texture is looked up there";
  EXPECT_THROW(run.technique->draw_debug("map"), std::exception);
}

TEST_F(RegisteredPlanar, what_it_cannot_do_is_refused_with_numbers) {
  const Scene scene = box_on_ground();
  EXPECT_EQ(supports(scene, lights[0], "min_share=0.001").kind(), Support::Kind::full);
  EXPECT_EQ(supports(scene, lights[0], "min_share=0.1").kind(), Support::Kind::approximate);
  EXPECT_EQ(supports(scene, {.name = "point", .kind = PointLight{{0, 4, 0}}}).why(),
            "the light has no area: its shadows are hard, see planar_projected");
  // Ground, five sides of one box, six of the other: 12 planes, and 2 sums of float32 for each texel of both sides: 3 GiB.
  const Support large = supports(scene, lights[3], "resolution=4096,min_share=0.001");
  EXPECT_EQ(large.kind(), Support::Kind::unsupported);
  EXPECT_NE(large.why().find("planes take up to "), std::string::npos) << large.why();
  Registry registry;
  gnomon_technique_registered_planar(registry);
  try {
    registry.techniques()[0].make()->apply("samples=1000000");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "registered_planar.samples = 1000000 is outside 1 .. 1024 point");
  }
}

}  // namespace registered_planar_test
