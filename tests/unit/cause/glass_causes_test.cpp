// Causes behind casters that let a part of the light through.
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include "cause_world.h"
#include "glass.h"

namespace gnomon::glass_causes_test {

using cause_world::Causes;
using cause_world::on_ground;
using cause_world::World;

/// A sheet of 5 m at a height of 6 m, above the middle of what the eye sees; the eye looks through it.
Scene one_sheet(float share) {
  Mesh sheet = glass::glass_card(2.5f, 6, share);
  sheet.seen = false;
  return on_ground({sheet});
}

struct GlassWorld : World {
  explicit GlassWorld(Scene scene) : World(std::move(scene)) {}
  std::vector<Cause> found(const std::function<std::optional<Explanation>(std::uint32_t)>& why) {
    Reference r = reference();
    r.kind = AnswerKind::transmitted;
    const auto explain = [&](std::span<const std::uint32_t> pixels) {
      std::vector<std::optional<Explanation>> all;
      for (const std::uint32_t i : pixels) all.push_back(why(i));
      return all;
    };
    return find_causes({scene, casters, gbuffer, light, r, mask, {}, explain, LightShareKind::area, own_causes, rasterizes});
  }
  std::size_t tested(const std::function<bool(std::size_t)>& wanted) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) count += classes[i] == PixelClass::T && wanted(i);
    return count;
  }
};

std::size_t count(std::span<const Cause> causes, Cause cause) {
  return static_cast<std::size_t>(std::ranges::count(causes, cause));
}

TEST(glass_causes, every_pixel_off_by_more_than_a_twentieth_has_a_cause_and_no_other) {
  GlassWorld world(one_sheet(0.5f));
  const auto behind = [&](std::size_t i) { return world.truth[i] == 0.5f; };
  ASSERT_GT(world.tested(behind), 500u);
  for (const float answer : {0.48f, 0.53f, 0.4f, 0.7f}) {
    for (std::size_t i = 0; i < world.mask.size(); ++i)
      if (behind(i)) world.mask[i] = answer;
    const std::vector<Cause> found = world.found([](std::uint32_t) { return std::nullopt; });
    const std::size_t wrong = std::abs(answer - 0.5f) > 0.05f ? world.tested(behind) : 0;
    EXPECT_EQ(found.size() - count(found, Cause::none), wrong) << answer;
  }
}

// The border of a sheet is an edge, though both of its sides are on one side of one half.
TEST(glass_causes, the_border_of_a_sheet_is_an_edge) {
  GlassWorld world(one_sheet(0.75f));
  for (std::size_t i = 0; i + 1 < world.mask.size(); ++i) world.mask[i] = world.truth[i + 1];
  const std::vector<Cause> found = world.found([](std::uint32_t) { return std::nullopt; });
  const std::size_t edges = count(found, Cause::edge) + count(found, Cause::edge_raster) + count(found, Cause::mask_shift);
  EXPECT_GT(edges, 50u);
  EXPECT_EQ(edges, found.size() - count(found, Cause::none));
}

// A map whose texels hold what arrives at their centers, exactly: all that is wrong are its texels.
TEST(glass_causes, a_perfect_map_of_large_texels_errs_by_resolution_alone) {
  Mesh second = glass::glass_card(1.7f, 4, 0.6f);
  second.seen = false;
  for (glm::vec3& p : second.positions) p += glm::vec3(0.61f, 0, 0.37f);
  Scene scene = one_sheet(0.5f);
  scene.meshes.push_back(second);
  GlassWorld world(std::move(scene));
  constexpr double texel = 0.5;
  const LightRays rays(world.scene, world.casters, world.gbuffer, world.light);
  const auto center = [&](std::uint32_t i) {
    const glm::dvec3 p = world.gbuffer.position(i);
    return glm::dvec3((std::floor(p.x / texel) + 0.5) * texel, p.y, (std::floor(p.z / texel) + 0.5) * texel);
  };
  for (std::uint32_t i = 0; i < world.mask.size(); ++i)
    if (world.gbuffer.mesh[i] == 0) {
      const LightRays::Start start{i, center(i), 0};
      world.mask[i] = rays.shares(std::span(&start, 1))[0];
    }
  const auto why = [&](std::uint32_t i) {
    Explanation why{.texel_width = texel};
    why.taps = {{center(i) + glm::dvec3(0, 20, 0), {0, -1, 0}, 1, INFINITY}};
    return std::optional(why);
  };
  const std::vector<Cause> found = world.found(why);
  EXPECT_GT(count(found, Cause::edge_resolution), 50u);
  EXPECT_EQ(count(found, Cause::edge_resolution), found.size() - count(found, Cause::none));
}

TEST(glass_causes, shares_multiply_along_rays) {
  GlassWorld world(one_sheet(0.5f));
  const LightRays rays(world.scene, world.casters, world.gbuffer, world.light);
  std::vector<LightRays::Start> starts;
  for (std::uint32_t i = 0; i < world.mask.size(); ++i)
    if (world.classes[i] == PixelClass::T) starts.push_back({i, world.gbuffer.position(i), 0});
  const std::vector<float> shares = rays.shares(starts);
  for (std::size_t s = 0; s < starts.size(); ++s) EXPECT_EQ(shares[s], world.truth[starts[s].pixel]) << s;
}

// Behind a clear sheet, too, where the reference is lit by more than one half.
TEST(glass_causes, a_sheet_without_a_shadow_is_a_missing_caster) {
  for (const float share : {0.3f, 0.8f, 0.94f}) {
    GlassWorld world(one_sheet(share));
    std::ranges::fill(world.mask, 1.0f);
    const std::vector<Cause> found = world.found([](std::uint32_t) { return std::nullopt; });
    EXPECT_GT(count(found, Cause::missing_caster), 500u) << share;
    EXPECT_EQ(count(found, Cause::missing_caster), found.size() - count(found, Cause::none)) << share;
  }
}

// The mask has more than a tenth of what the sheet takes: 0.4 of 0.7, and 0.1 of 0.2.
TEST(glass_causes, a_shadow_that_is_too_light_is_not_missing) {
  for (const auto& [share, answer] : {std::pair(0.3f, 0.6f), {0.8f, 0.9f}}) {
    GlassWorld world(one_sheet(share));
    for (std::size_t i = 0; i < world.mask.size(); ++i)
      if (world.truth[i] == share) world.mask[i] = answer;
    const std::vector<Cause> found = world.found([](std::uint32_t) { return std::nullopt; });
    EXPECT_GT(count(found, Cause::region), 500u) << share;
    EXPECT_EQ(count(found, Cause::missing_caster), 0u) << share;
  }
}

TEST(glass_causes, a_caster_takes_more_than_a_twentieth) {
  for (const float share : {0.0f, 0.5f, 0.94f, 0.96f, 1.0f}) {
    const GlassWorld world(one_sheet(share));
    for (std::size_t i = 0; i < world.mask.size(); ++i)
      EXPECT_EQ(world.nearest_caster[i], world.truth[i] < 0.95f ? 1 : no_mesh) << share << ' ' << i;
  }
}

// Sheets at 3 and 8 m that let all light through where x < 0, and one that does not at 6 m.
TEST(glass_causes, texels_that_let_all_light_through_are_no_casters) {
  Scene scene = one_sheet(0.5f);
  for (const float height : {3.0f, 8.0f}) {
    scene.meshes.push_back(glass::glass_card(2.5f, height, glass::texels(2, 1, {1, 0.8f})));
    scene.meshes.back().seen = false;
  }
  const GlassWorld world(std::move(scene));
  const LightRays rays(world.scene, world.casters, world.gbuffer, world.light);
  const glm::dvec3 up(0, 1, 0);
  for (const double x : {-1.0, 1.0}) {
    const std::uint32_t pixel = world.pixel(x, 0.3);
    const glm::dvec3 point = world.point(pixel);
    const bool is_there = x > 0;
    EXPECT_EQ(world.nearest_caster[pixel], is_there ? 2u : 1u) << x;
    EXPECT_EQ(rays.nearest(pixel).mesh, is_there ? 2u : 1u) << x;
    EXPECT_NEAR(rays.nearest(pixel).distance, is_there ? 3 : 6, 1e-4) << x;
    EXPECT_NEAR(rays.farthest(pixel), is_there ? 8 : 6, 1e-4) << x;
    const LightRays::Surface surface = rays.surface_at(point + 4.0 * up, up);
    EXPECT_EQ(surface.mesh, 2u) << x << ": drawn by who takes glass for opaque";
    EXPECT_NEAR(surface.off, 1, 1e-4) << x;
    EXPECT_NEAR(rays.farthest_along(point, up), 8, 1e-4) << x;
  }
}

// The ray tracer reports that some ways in the plane of a triangle meet it: the opaque one shows it.
TEST(glass_causes, shares_are_whole_beside_a_triangle_in_whose_plane_ways_pass_it) {
  Random random(41);
  constexpr std::size_t size = 128;
  std::size_t reported = 0;
  for (int s = 0; s < 60; ++s) {
    const glass::TiltedTriangle triangle(random);
    const Light light = hand_made::point_light(triangle.at(4, 1.6));
    hand_made::Picture picture(size, 1);
    std::vector<LightRays::Start> starts;
    for (std::size_t i = 0; i < size; ++i) {
      picture.set(i, triangle.at(-4 + 0.02 * static_cast<double>(i), 1.6), triangle.along, no_mesh, 0);
      starts.push_back({i, picture.gbuffer.position(i), 0});
    }
    const auto shares_in = [&](const Scene& scene) {
      const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
      return LightRays(scene, casters, picture.gbuffer, light).shares(starts);
    };
    EXPECT_EQ(shares_in(triangle.scene), std::vector<float>(size, 1)) << s;
    reported += static_cast<std::size_t>(std::ranges::count(shares_in(triangle.opaque), 0.0f));
  }
  EXPECT_GT(reported, 10u);
}

}  // namespace gnomon::glass_causes_test
