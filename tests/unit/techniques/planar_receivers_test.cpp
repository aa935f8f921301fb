// What planar projected shadows promise about receivers and casters: fact by fact, on paper and against rays.
#include "planar_rig.h"

namespace planar_receivers_test {
using namespace planar_rig;

// Light at height 4 over the ground, a table |x|, |z| <= 1 at height 1 and a tile 0.4 <= x <= 1, |z| <= 0.2 at height 2. Images
// are scaled about the light's foot: the tile's by (4 - 1) / (4 - 2) = 3/2 on the table, which ends at x = 1, and by
// 4 / (4 - 2) = 2 on the ground; the table's by 4 / (4 - 1) = 4/3 on the ground.
TEST_F(PlanarProjected, receivers_end_where_they_end_and_occlude_each_other) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::ground(1, 1), plate(0.4f, 1, -0.2f, 0.2f, 2)};
  const Light light{.kind = PointLight{{0, 4, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 160, 120);
  const auto mask = run(scene, light, g).mask;
  const auto in = [](double x, double x0, double x1, double z, double half) { return x > x0 && x < x1 && std::abs(z) < half; };
  EXPECT_GT(
      expect_on_ground(
          g, mask, [&](double x, double z) { return in(x, -4 / 3.0, 4 / 3.0, z, 4 / 3.0) || in(x, 0.8, 2, z, 0.4) ? 0 : 1; }),
      100);
  int on_table = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.mesh[i] != 1) continue;
    const bool is_dark = in(g.px[i], 0.6, 1, g.pz[i], 0.3);
    if (in(g.px[i], 0.599, 1, g.pz[i], 0.301) != in(g.px[i], 0.601, 1, g.pz[i], 0.299)) continue;
    EXPECT_EQ(mask[i], is_dark ? 0 : 1) << g.px[i] << ' ' << g.pz[i];
    on_table += is_dark;
  }
  EXPECT_GT(on_table, 30);
}

// Boxes that stand on the ground, hang over it and run into each other, among plates at many heights: every side is a receiver.
TEST_F(PlanarProjected, random_receivers_occlude_each_other_as_rays_say) {
  Agreement all;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    Random random(seed);
    const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    Scene scene;
    scene.meshes = {small_world::ground(3)};
    for (int k = 0; k < 5; ++k) {
      // One number after the other: the arguments of a call are drawn in another order by each compiler.
      const float z = number(-2, 1), y = k < 2 ? 0 : number(0, 2), x = number(-2, 1);
      const float depth = number(0.2, 1.5), height = number(0.2, 1.5), width = number(0.2, 1.5);
      scene.meshes.push_back(small_world::box({x, y, z}, glm::vec3(x, y, z) + glm::vec3(width, height, depth)));
    }
    for (int k = 0; k < 3; ++k) {
      const float height = number(0.2, 3), half = number(0.3, 1);
      scene.meshes.push_back(small_world::ground(half, height));
    }
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : {Light{.kind = PointLight{{number(-3, 3), number(1, 5), number(-3, 3)}}},
                               Light{.kind = DirectionalLight{{number(-1, 1), -1, number(-1, 1)}}},
                               Light{.kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}}})
      all.add(scene, light, g, run(scene, light, g, "min_share=0.001").mask);
  }
  all.expect(10000);
}

// A screen from y = -1 to y = 1 at x = 0, |z| <= 1, under a sun along (1, -1, 0): the part above the ground casts 0 <= x <= 1.
TEST_F(PlanarProjected, casters_that_cross_the_plane_cast_with_what_is_above_it) {
  Scene scene;
  scene.meshes = {small_world::ground(4), screen(0, -1, 1, -1, 1)};
  const Light sun{.kind = DirectionalLight{{1, -1, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 160, 120);
  EXPECT_GT(expect_on_ground(g, run(scene, sun, g).mask,
                             [](double x, double z) { return x > 0 && x < 1 && std::abs(z) < 1 ? 0 : 1; }),
            100);
  Agreement all;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    scene.meshes[1] = small_world::random_soup(random, 30, 2, -0.4f, 0.4f, 1);
    scene.meshes[1].receives = false;
    const GBuffer pierced = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : {sun, Light{.kind = PointLight{{1, 2.5f, 0.5f}}}, Light{.kind = PointLight{{0, 0.7f, 1}}}})
      all.add(scene, light, pierced, run(scene, light, pierced).mask);
  }
  all.expect(10000);
}

// A screen at x = 1, |z| <= 1/2, from y = 1 to y = 3, and a light at (0, 2, 0). The way from (x, 0, z) to the light passes x =
// 1 at height 2 - 2/x and at z/x: it meets the screen where x >= 2 and |z| <= x/2. What is above the light casts nothing,
// neither there nor mirrored.
TEST_F(PlanarProjected, casters_above_the_light_cast_nothing_and_those_beside_it_to_infinity) {
  Scene scene;
  scene.meshes = {small_world::ground(5), screen(1, 1, 3, -0.5f, 0.5f), plate(-2, -1, -1, 1, 3)};
  const Light lamp{.kind = PointLight{{0, 2, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {3, 9, 6}, .target = {0, 0, 0}}, 160, 120);
  EXPECT_GT(
      expect_on_ground(g, run(scene, lamp, g).mask, [](double x, double z) { return x > 2 && std::abs(z) < x / 2 ? 0 : 1; }),
      100);
  Agreement all;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    scene.meshes = {small_world::ground(4), small_world::random_soup(random, 30, 2, 0.5f, 4.5f, 0.8f)};
    scene.meshes[1].receives = false;
    const GBuffer around = small_world::make_gbuffer(scene, {.eye = {3, 9, 6}}, 96, 72);
    all.add(scene, lamp, around, run(scene, lamp, around).mask);
  }
  all.expect(3000);
}

// A sun is the limit of a lamp that goes away: 2^20 m off, rays through a scene of 8 m still differ by 8 / 2^20 in direction,
// which moves the shadow of what is 3 m high by 23 micrometers, 1/2000 of a pixel.
TEST_F(PlanarProjected, lights_at_infinity_are_the_limit_of_lamps) {
  Agreement all;
  int changed = 0, far_from_edge = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937 soup(seed);
    Random random(seed);
    Scene scene;
    scene.meshes = {small_world::ground(3), small_world::random_soup(soup, 30, 1.5f, -0.5f, 2.5f, 0.6f),
                    small_world::box({-2.5f, 0, -1}, {-1.5f, 1, 0.5f})};
    scene.meshes[1].receives = false;
    View from = view;
    if (seed % 2 == 0) from.eye.y = -5;
    glm::dvec3 to = small_world::direction_of(random);
    to.y = std::copysign(std::max(std::abs(to.y), 0.3), from.eye.y);  // from above, or from below
    const Light sun{.kind = DirectionalLight{glm::vec3(-to)}};
    const Light lamp{.kind = PointLight{glm::vec3(glm::normalize(glm::dvec3(glm::vec3(to))) * 0x1p20)}};
    const GBuffer g = small_world::make_gbuffer(scene, from, 96, 72);
    const std::vector<float> mask = run(scene, sun, g).mask, limit = run(scene, lamp, g).mask;
    all.add(scene, sun, g, mask);
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (mask[i] == limit[i]) continue;
      ++changed;
      far_from_edge += !near_edge(by_rays(scene, sun), g, i, 0.02);
    }
  }
  all.expect(1000);
  EXPECT_LE(changed, 10);
  EXPECT_EQ(far_from_edge, 0);
}

// Plates |z| <= 1, |x| <= 1/2 at heights 1, 1.5 and 2 under a sun along (1, -1, 0): their shadows are 1, 1.5 and 2 aside, and
// together 1/2 <= x <= 5/2. Closed casters project twice wherever they cast, and are no darker.
TEST_F(PlanarProjected, shadows_that_overlap_are_not_darker) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  for (const float height : {1.0f, 1.5f, 2.0f}) scene.meshes.push_back(plate(-0.5f, 0.5f, -1, 1, height));
  const Light sun{.kind = DirectionalLight{{1, -1, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 160, 120);
  EXPECT_GT(expect_on_ground(g, run(scene, sun, g).mask,
                             [](double x, double z) { return x > 0.5 && x < 2.5 && std::abs(z) < 1 ? 0 : 1; }),
            100);
  // The shadow of many is the union of their shadows.
  std::mt19937 random(1);
  scene.meshes.resize(1);
  for (int k = 0; k < 6; ++k) {
    scene.meshes.push_back(small_world::random_soup(random, 5, 1, 0.3f, 2, 0.8f));
    scene.meshes.back().receives = false;
  }
  const GBuffer many = small_world::make_gbuffer(scene, view, 96, 72);
  const Light lamp{.kind = PointLight{{1, 4, 0.5f}}};
  std::vector<float> together(many.size(), 1);
  for (std::size_t k = 1; k < scene.meshes.size(); ++k) {
    Scene alone = scene;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) alone.meshes[m].casts = m == k;
    const std::vector<float> mask = run(alone, lamp, many).mask;
    for (std::size_t i = 0; i < many.size(); ++i) together[i] = std::min(together[i], mask[i]);
  }
  EXPECT_EQ(run(scene, lamp, many).mask, together);
  EXPECT_GT(std::ranges::count(together, 0.0f), 300);
}

}  // namespace planar_receivers_test
