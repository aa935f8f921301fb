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

}  // namespace gnomon::glass_causes_test
