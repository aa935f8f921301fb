// Means of hard shadows: what they are of, and where they converge to.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/pictures/layers.h>

#include <cmath>
#include <map>

#include "averaged_hard_rig.h"

namespace averaged_hard_test {
using namespace averaged_hard_rig;

/// Half of the soups stand in the way of the light: casters touch it and cross it.
Scene soup(int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  Scene scene;
  scene.meshes.push_back(small_world::ground(4));
  scene.meshes.push_back(small_world::random_soup(random, 12, 2, 0.2f, seed % 2 ? 2.0f : 4.5f, 0.8f));
  scene.views = {{.name = "view", .eye = {3, 5, 6}, .target = {0, 0.3f, 0}}};
  return scene;
}

// All points of a light of no size are the point: n equal masks of zeros and ones have that mask as their mean, exactly.
TEST_F(AveragedHard, a_light_that_shrinks_to_a_point_gives_the_hard_mask_of_its_technique) {
  for (int seed = 1; seed <= 6; ++seed) {
    const World world(soup(seed), Truth::mesh);
    const GBuffer g = world.gbuffer(world.scene.views[0], 64, 48);
    const glm::vec3 center(0.3f, 4, -0.2f);
    const Light point{.name = "point", .kind = PointLight{center}};
    for (const char* of : {"svbsp", "embree_rays", "stencil_volume", "shadow_map", "exact_rays"}) {
      const std::vector<float> hard = mask_of(of, "", world.scene, point, g);
      for (const LightKind& kind :
           {LightKind(RectLight{center, {1e-20f, 0, 0}, {0, 0, 1e-20f}}), LightKind(DiscLight{center, {0.2f, -1, 0}, 1e-20f}),
            LightKind(SphereLight{center, 1e-20f})})
        EXPECT_EQ(mask_of("averaged_hard", fmt::format("of={},samples=7", of), world.scene, {.name = "dot", .kind = kind}, g),
                  hard)
            << of << " seed " << seed;
    }
  }
}

// With rays and sixteen sets of places it samples what area_rays samples: the same places for every fourth pixel. Rays to an
// area start a quarter as high, and where the light is cut by the horizon area_rays puts all of its places above it.
TEST_F(AveragedHard, of_rays_it_is_area_rays_with_the_same_places) {
  const World world(generated_scene("box_city:count=12"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 96, 64);
  const Light light = lamp({-2, 9, 3}, 1.5f);
  const std::string settings = "samples=16,pattern=interleaved,seed=3";
  const std::vector<float> rays = mask_of("area_rays", settings, world.scene, light, g);
  const std::vector<float> averaged = mask_of("averaged_hard", "of=embree_rays," + settings, world.scene, light, g);
  int asked = 0, in_penumbra = 0, different = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(world.scene, g, light, i)) {
      EXPECT_EQ(averaged[i], 1);
      continue;
    }
    const LightFigure face(light, g.position(i), g.normal(i));
    if (!(face.horizon().x > std::abs(face.horizon().y) + std::abs(face.horizon().z))) continue;
    ++asked;
    in_penumbra += rays[i] > 0 && rays[i] < 1;
    different += std::abs(rays[i] - averaged[i]) > 1e-6;
    EXPECT_LE(std::abs(rays[i] - averaged[i]), 1.0 / 16 + 1e-6) << i;
  }
  EXPECT_GT(in_penumbra, 100);
  EXPECT_LE(different, asked / 500);
}

// A wall through the middle of a lamp sees its half; of the half that it sees nothing is hidden. A screen covers the left half
// of what the ground sees.
TEST_F(AveragedHard, points_below_the_horizon_count_neither_as_lit_nor_as_dark) {
  Scene scene;
  scene.meshes.push_back(small_world::make_mesh({{0, -3, -3}, {0, 3, -3}, {0, 3, 3}, {0, -3, 3}}, {{0, 1, 2}, {0, 2, 3}}));
  scene.views = {{.name = "view", .eye = {5, 0, 0}, .target = {0, 0, 0}}};
  const World world(scene, Truth::mesh);
  const GBuffer g = world.gbuffer(scene.views[0], 24, 24);
  for (const char* of : {"svbsp", "embree_rays"})
    for (const float mask : mask_of("averaged_hard", fmt::format("of={},samples=32", of), scene, lamp({0, 4, 0}, 1), g))
      EXPECT_EQ(mask, 1) << of;
}

/// Root mean square of the error over seeds and pixels in penumbra, against exact shares.
double error_of(const World& world, const GBuffer& g, const Light& light, const std::vector<float>& truth,
                const std::string& settings) {
  double squares = 0;
  int count = 0;
  const auto technique = registry().technique("averaged_hard").make();
  technique->apply(settings);
  technique->setup();
  technique->build(world.scene);
  for (int seed = 1; seed <= 12; ++seed) {
    technique->parameter("seed").set(std::to_string(seed));
    technique->relight(light);
    VisibilityMask mask(g.width, g.height);
    technique->resolve(g, mask);
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!(truth[i] > 0.02 && truth[i] < 0.98)) continue;
      squares += std::pow(mask.read()[i] - truth[i], 2);
      ++count;
    }
  }
  return std::sqrt(squares / count);
}

// Of n independent places the error falls as n^-0.5. Of n cells the edge of a shadow across the light cuts some n^0.5, and each
// of these is decided by one place: n^0.25 / n = n^-0.75. From 8 to 512 places: the factor of 64 gives 1/8 and 1/23.
TEST_F(AveragedHard, the_error_falls_with_the_exponent_of_the_pattern) {
  const World world(generated_scene("box_city:count=12"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 48, 32);
  for (const Light& light : {lamp({-2, 9, 3}, 1.5f), Light{.name = "globe", .kind = SphereLight{{-2, 9, 3}, 1.5f}}}) {
    const std::vector<float> truth = mask_of("exact_area", "", world.scene, light, g);
    for (const auto& [pattern, exponent] :
         std::map<std::string, double>{{"random", -0.5}, {"stratified", -0.75}, {"low_discrepancy", -0.75}}) {
      const auto error = [&, &pattern = pattern](int n) {
        return error_of(world, g, light, truth, fmt::format("of=svbsp,samples={},pattern={}", n, pattern));
      };
      const double few = error(8), many = error(512), found = std::log(many / few) / std::log(64.0);
      RecordProperty(fmt::format("{}_{}", light.name, pattern), fmt::format("{:.2f}", found));
      EXPECT_NEAR(found, exponent, 0.12) << light.name << ' ' << pattern << ": " << few << " to " << many;
    }
  }
}

// Whatever the registry has for lights without area, of plugins too. What may hold too much reports its bytes before
// resolve.
TEST_F(AveragedHard, every_hard_technique_can_be_averaged) {
  const World world(generated_scene("sphere_over_plane:segments=12"), Truth::mesh);
  const GBuffer g = world.gbuffer(world.scene.views[0], 32, 24);
  const Light light = lamp({-2, 5, 2}, 0.5f);
  const auto names = made("averaged_hard", "");
  const std::vector<std::string> all = names->parameter("of").probes();
  EXPECT_GE(all.size(), 18u);
  std::vector<std::string> unsupported;
  for (const std::string& of : all) {
    const auto technique = made("averaged_hard", fmt::format("of={},samples=3", of));
    if (!technique->supports(world.scene, light, world.scene.views[0])) {
      unsupported.push_back(of);
      continue;
    }
    technique->setup();
    technique->build(world.scene);
    technique->relight(light);
    VisibilityMask mask(g.width, g.height);
    technique->resolve(g, mask);
    for (const float value : mask.read()) EXPECT_TRUE(value >= 0 && value <= 1) << of;
  }
  EXPECT_LE(unsupported.size(), 2u) << joined(unsupported);
}

// The lamp is as high over the plate as the plate over the ground: the edge at x = 0 throws the shadow of a point at x to -x,
// so that eight points between -1 and 1 leave eight edges between two of the 400 pixels that lie 0.0055 m apart along x.
TEST_F(AveragedHard, layers_show_the_first_hard_shadow_and_an_edge_for_each_point) {
  Scene scene;
  scene.meshes = {small_world::ground(4),
                  small_world::make_mesh({{-3, 1, -3}, {-3, 1, 3}, {0, 1, 3}, {0, 1, -3}}, {{0, 1, 2}, {0, 2, 3}})};
  const Light light = lamp({0, 2, 0}, 1);
  hand_made::Picture picture(400, 1);
  for (std::size_t i = 0; i < 400; ++i) picture.set(i, {(static_cast<float>(i) - 200) * 0.0055f, 0, 0.3f}, {0, 1, 0}, 0, 0);
  const GBuffer& g = picture.gbuffer;
  const auto technique = made("averaged_hard", "of=exact_rays,samples=8");
  technique->setup();
  technique->build(scene);
  technique->relight(light);
  VisibilityMask mask(g.width, g.height);
  technique->resolve(g, mask);

  const std::vector<float> gray = heat_layer(g, std::vector<float>(g.size(), 0)), edges = technique->draw_debug("edges");
  const std::vector<Swatch> legend = heat_legend();
  int count = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (edges[3 * i] == gray[3 * i] && edges[3 * i + 2] == gray[3 * i + 2]) continue;
    for (std::size_t k = 0; k < legend.size(); ++k)
      if (std::abs(edges[3 * i] - legend[k].color.x) < 1e-6 && std::abs(edges[3 * i + 2] - legend[k].color.z) < 1e-6)
        count += static_cast<int>(k) + 1;
  }
  EXPECT_EQ(count, 8);

  const glm::vec3 first = light_points(light, "low_discrepancy", 8, places_seed(1, 0))[0];
  const Light point{.name = "lamp", .kind = PointLight{first}};
  EXPECT_EQ(technique->draw_debug("hard"), shaded_layer(scene, g, point, mask_of("exact_rays", "", scene, point, g)));
  EXPECT_THROW(technique->draw_debug("map"), Error);
}

/// The mean over pixels that are decided of how far a mask is from the exact shares, and how many those are.
std::pair<double, int> mean_error(const Scene& scene, const GBuffer& g, const Light& light, const std::vector<float>& mask,
                                  const std::vector<float>& truth) {
  double sum = 0;
  int asked = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    EXPECT_TRUE(mask[i] >= 0 && mask[i] <= 1) << i;
    if (!faces_light(scene, g, light, i)) {
      EXPECT_EQ(mask[i], 1) << i;
      continue;
    }
    ++asked;
    sum += std::abs(mask[i] - truth[i]);
  }
  return {sum / std::max(asked, 1), asked};
}

// Lights inside of a closed box, across a wall, a hair above the ground and over slivers and triangles of no area: means of 64
// hard shadows stay as close to the exact shares as in the open. Of a sphere that a caster crosses the points lie on the
// surface, those of exact_area on the disc that is seen: they differ, and spheres are compared beside casters only.
TEST_F(AveragedHard, lights_in_and_across_casters_have_their_shares) {
  const Mesh ground = small_world::ground(4), room = small_world::box({-2, 1, -2}, {2, 3, 2});
  const Mesh wall =
      small_world::make_mesh({{0.3f, 0.5f, -3}, {0.3f, 0.5f, 3}, {0.3f, 4, 3}, {0.3f, 4, -3}}, {{0, 1, 2}, {0, 2, 3}});
  const Mesh slivers = small_world::make_mesh({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {0, 1, -1}, {0, 1, -1}, {1, 1.0001f, 1}},
                                              {{0, 1, 2}, {0, 3, 1}, {3, 4, 2}, {3, 3, 3}, {2, 5, 2}, {0, 2, 5}});
  const std::map<std::string, std::pair<std::vector<Mesh>, glm::vec3>> scenes{
      {"in a box", {{ground, room}, {0, 2, 0}}},
      {"across a wall", {{ground, wall}, {0.2f, 3, 0}}},
      {"close to the ground", {{ground, wall}, {1, 0.001f, 0}}},
      {"over slivers", {{ground, slivers}, {0, 3, 0}}}};
  for (const auto& [name, held] : scenes) {
    Scene scene;
    scene.meshes = held.first;
    scene.views = {{.name = "view", .eye = {3, 5, 6}, .target = {0, 0.3f, 0}}};
    const World world(scene, Truth::mesh);
    const GBuffer g = world.gbuffer(scene.views[0], 64, 48);
    for (const LightKind& kind :
         {LightKind(RectLight{held.second, {0.5f, 0, 0}, {0, 0, 0.5f}}), LightKind(SphereLight{held.second, 0.5f})}) {
      const Light light{.name = "lamp", .kind = kind};
      const bool is_crossed = name == "across a wall" || name == "close to the ground";
      if (is_crossed && std::holds_alternative<SphereLight>(kind)) continue;
      const std::vector<float> truth = mask_of("exact_area", "", scene, light, g);
      for (const char* of : {"svbsp", "embree_rays", "stencil_volume", "exact_rays"}) {
        const std::vector<float> mask = mask_of("averaged_hard", fmt::format("of={},samples=64", of), scene, light, g);
        const auto [error, asked] = mean_error(scene, g, light, mask, truth);
        EXPECT_GT(asked, 100) << name << ", " << kind_name(light);
        EXPECT_LT(error, 0.01) << of << ' ' << name << ", " << kind_name(light);
      }
    }
  }
}

}  // namespace averaged_hard_test
