// Causes behind casters with holes: the borders of holes are edges like all others.
#include <fmt/ranges.h>
#include <gnomon/kit/geometry/holes.h>
#include <gtest/gtest.h>

#include "cause_world.h"
#include "masked.h"

namespace gnomon::holes_causes_test {

using cause_world::Causes;
using cause_world::on_ground;
using cause_world::slanted;
using cause_world::World;
using masked::mask_of;

/// A card of 5 m at a height of 6 m with 10 x 10 texels of half a meter, nearly 4 pixels each. It hangs beside what the eye
/// sees, and its shadow is in the middle of that.
Scene one_card(std::shared_ptr<const AlphaMask> mask) {
  Mesh card = masked::card(2.5f, 6, std::move(mask));
  for (glm::vec3& p : card.positions) p.x -= 6;
  return on_ground({card});
}
Scene one_card() {
  Random random(9);
  return one_card(masked::random_mask(random, 10, 10));
}
/// The same without holes, and the ground alone.
Scene filled(Scene scene) {
  scene.meshes[1].alpha_mask = nullptr;
  scene.meshes[1].uv.clear();
  return scene;
}

/// The share of the named cause of the wrong pixels of the ground, which are 30 or more.
double share(World& world, const TestMap& map, const std::string& cause) {
  world.take(map, [&](std::uint32_t i, float) { return world.gbuffer.mesh[i] == 0; });
  EXPECT_GE(world.wrong(), 30u);
  const Causes causes = world.causes(map);
  const auto found = causes.find(cause);
  EXPECT_EQ(causes.count("unexplained"), 0u) << fmt::format("{}", fmt::join(causes, " "));
  return found == causes.end() ? 0 : static_cast<double>(found->second) / static_cast<double>(world.wrong());
}

TEST(holes_causes, a_texel_of_a_map_that_straddles_the_border_of_a_hole_is_too_large) {
  World world(one_card(), slanted);
  const TestMap map(world.scene, world.casters, world.light, {.texel = 0.2, .bias = 0.01, .receiver_plane = true});
  EXPECT_GE(share(world, map, "edge_resolution"), 0.95) << fmt::format("{}", fmt::join(world.causes(map), " "));
}

TEST(holes_causes, a_filter_wider_than_what_is_solid_is_too_wide) {
  // Slats of 0.25 m and gaps of 0.375 m: a filter of 0.5 m finds light everywhere.
  World world(one_card(mask_of({"##...##...##...##...##...##...##...##..."})), slanted);
  const TestMap map(world.scene, world.casters, world.light,
                    {.texel = 0.02, .bias = 0.01, .radius = 12, .receiver_plane = true});
  EXPECT_GE(share(world, map, "filter_width"), 0.9) << fmt::format("{}", fmt::join(world.causes(map), " "));
}

// Every piece of the card's shadow is of 8 pixels or more, and no tap holds the card.
TEST(holes_causes, a_card_that_is_not_in_the_map_is_missing) {
  World world(one_card(masked::checker(10, 10)), slanted);
  const Scene empty = on_ground({});
  const RayScene nothing(empty, Truth::mesh, RayScene::Which::casters);
  EXPECT_GE(share(world, TestMap(empty, nothing, world.light, {.texel = 0.02, .bias = 0.01}), "missing_caster"), 0.95);
}

// The map holds the card where the reference sees through it: as a coarser level of the texture may have it, or none at all.
TEST(holes_causes, a_hole_that_the_map_holds_as_solid_darkens_what_it_does_not_shadow) {
  World world(one_card(), slanted);
  const Scene solid = filled(world.scene);
  const RayScene rays(solid, Truth::mesh, RayScene::Which::casters);
  EXPECT_GE(share(world, TestMap(solid, rays, world.light, {.texel = 0.005, .bias = 0.01}), "over_dark"), 0.95);
}

// A mask that is wrong along the borders of holes alone, of a technique without taps.
TEST(holes_causes, the_border_of_a_hole_is_an_edge_of_the_reference) {
  World world(one_card(), slanted);
  for (std::size_t i = 0; i + 1 < world.mask.size(); ++i)
    if (world.gbuffer.mesh[i] == 0 && world.gbuffer.mesh[i + 1] == 0) world.mask[i] = world.truth[i + 1];
  ASSERT_GE(world.wrong(), 30u);
  EXPECT_EQ(world.causes(), (Causes{{"edge_raster", world.wrong()}}));
  world.rasterizes = false;
  EXPECT_EQ(world.causes(), (Causes{{"edge", world.wrong()}}));
}

// Columns 0 to 4 of the card are solid. The border is at x = -6, its shadow at x = 0.
TEST(holes_causes, a_way_beside_a_border_of_two_bits_may_be_either) {
  const auto half = mask_of({"#####....."});
  World world(one_card(half), slanted);
  const LightRays rays(world.scene, world.casters, world.gbuffer, world.light);
  const std::uint32_t pixel = world.pixel(1, 0.3);
  const auto is_at_border = [&](double x, double aside) { return rays.is_at_hole_border({pixel, {x, 0, 0.3}, 0.01}, aside); };
  EXPECT_TRUE(is_at_border(0, 0));
  EXPECT_FALSE(is_at_border(0.1, 0));
  EXPECT_FALSE(is_at_border(-0.1, 0));
  EXPECT_FALSE(is_at_border(0.5, 0.01)) << "between two holes";
  EXPECT_FALSE(is_at_border(-0.5, 0.01)) << "between two solid texels";
  // 0.05 m beside the border is a tenth of a texel. A move across a ray at 45 degrees is 1.41 times as long on the card.
  EXPECT_TRUE(is_at_border(0.05, 0.05));
  EXPECT_FALSE(is_at_border(0.05, 0.02));
  // Under a second card that is solid nothing is open.
  Scene covered = world.scene;
  covered.meshes.push_back(cause_world::plate(-4, -2, -3, 3, 3));
  const RayScene casters(covered, Truth::mesh, RayScene::Which::casters);
  const LightRays below(covered, casters, world.gbuffer, world.light);
  EXPECT_FALSE(below.is_at_hole_border({pixel, {0, 0, 0.3}, 0.01}, 0));
  // Without masks there is no border.
  const Scene solid = filled(world.scene);
  const RayScene solid_casters(solid, Truth::mesh, RayScene::Which::casters);
  EXPECT_FALSE(LightRays(solid, solid_casters, world.gbuffer, world.light).is_at_hole_border({pixel, {0, 0, 0.3}, 0.01}, 0));
}

TEST(holes_causes, a_surface_is_found_in_its_holes_too) {
  World world(one_card(mask_of({"#####....."})), slanted);
  const LightRays rays(world.scene, world.casters, world.gbuffer, world.light);
  const glm::dvec3 down(0, -1, 0);
  for (const double x : {-8.0, -4.0}) {
    EXPECT_EQ(rays.masked_mesh_at({x, 6.2, 0.3}, down, 0.3), 1u) << x;
    EXPECT_EQ(rays.masked_mesh_at({x, 5.8, 0.3}, down, 0.3), 1u) << x;
    EXPECT_EQ(rays.masked_mesh_at({x, 6.5, 0.3}, down, 0.3), no_mesh) << x;
    EXPECT_EQ(rays.masked_mesh_at({x, 0.1, 0.3}, down, 0.3), no_mesh) << "the ground has no mask";
  }
  EXPECT_EQ(rays.surface_at({-8, 6.2, 0.3}, down).mesh, 1u);
  EXPECT_EQ(rays.surface_at({-4, 6.2, 0.3}, down).mesh, 0u);
  // What is nearest to a point of the ground goes through the holes.
  EXPECT_EQ(rays.nearest(world.pixel(-1, 0.3)).mesh, 1u);
  EXPECT_EQ(rays.nearest(world.pixel(1, 0.3)).mesh, no_mesh);
}

}  // namespace gnomon::holes_causes_test
