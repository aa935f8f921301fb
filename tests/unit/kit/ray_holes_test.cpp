// Rays through casters with holes: by hand, at every unit of length, and against all triangles in double.
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/rays/rays.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "masked.h"
#include "small_world.h"

namespace gnomon::ray_holes_test {

using masked::mask_of;

/// Lengths of this many meters a unit: as it is, and so small and so large that the scene is traced in a frame of its own.
constexpr double units[] = {1, 0x1p-14, 0x1p40};

/// A ground under a card of 4 x 4 texels, each a half wide.
Scene card_over_ground(double unit, std::shared_ptr<const AlphaMask> mask) {
  const auto length = static_cast<float>(unit);
  Scene scene;
  scene.meshes = {hand_made::square(4 * length, 0), masked::card(length, length, std::move(mask))};
  return scene;
}

/// The center of a texel of that card, at a height.
glm::dvec3 over(int texel, double height) { return {-0.75 + 0.5 * (texel % 4), height, -0.75 + 0.5 * (texel / 4)}; }

/// A ray straight up through each texel from half the card's height, or from `height`.
ShadowPacket straight_up(double unit, double height = 0.5) {
  ShadowPacket packet;
  for (int k = 0; k < ray_lanes; ++k) set_ray(packet, k, unit * over(k, height), unit * glm::dvec3(0, 2, 0), 1);
  return packet;
}

std::uint32_t bits_of(const AlphaMask& mask) {
  std::uint32_t bits = 0;
  for (int k = 0; k < 16; ++k) bits |= static_cast<std::uint32_t>(mask.is_solid(k % 4, k / 4)) << k;
  return bits;
}

constexpr std::uint32_t nobody[16] = {no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh,
                                      no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh};

TEST(ray_holes, sixteen_rays_are_blocked_where_the_bits_are_set) {
  Random random(2);
  for (const double unit : units)
    for (int round = 0; round < 20; ++round) {
      const auto mask = masked::random_mask(random, 4, 4);
      const Scene scene = card_over_ground(unit, mask);
      const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
      EXPECT_TRUE(rays.has_alpha_masks());
      ShadowPacket packet = straight_up(unit);
      EXPECT_EQ(rays.occluded(0xffff, packet, {nobody, nobody}), bits_of(*mask)) << unit;
      packet = straight_up(unit);
      EXPECT_EQ(rays.occluded(0x0f0f, packet, {nobody, nobody}), bits_of(*mask) & 0x0f0f) << unit;
      packet = straight_up(unit);
      const RayScene::Blocked blocked = rays.blocked(0xffff, packet, {nobody, nobody}, 1e-5 * unit);
      EXPECT_EQ(blocked.at_all, bits_of(*mask)) << unit;
      // The diagonal of the card goes through the centers of four texels.
      EXPECT_EQ(blocked.clearly, bits_of(*mask) & ~0x8421u) << unit;
    }
}

TEST(ray_holes, a_hole_is_met_and_is_no_hit) {
  const auto mask = mask_of({"#...", ".#..", "..#.", "...#"});
  for (const double unit : units) {
    const Scene scene = card_over_ground(unit, mask);
    const RayScene rays(scene, Truth::mesh, RayScene::Which::seen);
    for (int texel = 0; texel < 16; ++texel) {
      // Aside of the diagonal, so that one triangle is met.
      const glm::dvec3 from = unit * (over(texel, 3) + glm::dvec3(0.1, 0, 0));
      const RayScene::Hit hit = rays.closest(from, {0, -1, 0});
      const bool is_solid = texel % 5 == 0;
      EXPECT_EQ(hit.mesh, is_solid ? 1u : 0u) << unit << ' ' << texel;
      EXPECT_NEAR(hit.t / unit, is_solid ? 2 : 3, 1e-5) << unit << ' ' << texel;
      int met = 0;
      for (const RayScene::Met& triangle : rays.met(from, unit * glm::dvec3(0, -2.5, 0))) met += triangle.mesh == 1;
      EXPECT_EQ(met, 1) << unit << ' ' << texel;
    }
  }
}

// From below, the card is the nearer one; through its hole the ray goes on to the second card, which is solid there.
TEST(ray_holes, a_ray_goes_on_behind_a_hole) {
  Scene scene;
  scene.meshes = {masked::card(1, 1, mask_of({"#.", "#."})), masked::card(1, 2, mask_of({".#", ".#"})),
                  hand_made::square(1, 3)};
  const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
  EXPECT_EQ(rays.closest({-0.5, 0, 0.2}, {0, 1, 0}).mesh, 0u);
  EXPECT_EQ(rays.closest({0.5, 0, 0.2}, {0, 1, 0}).mesh, 1u);
  EXPECT_EQ(rays.closest({-0.5, 1.5, 0.2}, {0, 1, 0}).mesh, 2u);
  ShadowPacket packet;
  for (int k = 0; k < ray_lanes; ++k) set_ray(packet, k, {k % 2 ? 0.5f : -0.5f, 1.5f, 0.2f}, {0, 1, 0}, 1);
  EXPECT_EQ(rays.occluded(0xffff, packet, {nobody, nobody}), 0xaaaau);
}

// Its own triangle is no hit wherever it is solid; the other one of the card is by its texels.
TEST(ray_holes, the_receivers_own_triangle_is_left_out_with_its_holes) {
  const auto mask = mask_of({"##", ".."});
  Scene scene;
  scene.meshes = {masked::card(1, 1, mask)};
  const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
  // Triangle 0 has z above x, and row 1 of the mask has z above 0.
  const glm::dvec3 places[] = {{-0.5, 0, -0.25}, {-0.5, 0, 0.5}, {0.25, 0, -0.5}, {0.75, 0, 0.5}};
  const bool is_solid[] = {true, false, true, false};
  for (std::uint32_t own = 0; own < 2; ++own) {
    ShadowPacket packet;
    std::uint32_t mesh[16] = {}, triangle[16];
    std::ranges::fill(triangle, own);
    std::uint32_t expected = 0;
    for (int k = 0; k < ray_lanes; ++k) {
      set_ray(packet, k, places[k % 4], {0, 2, 0}, 1);
      const std::uint32_t met = k % 4 < 2 ? 0 : 1;
      expected |= static_cast<std::uint32_t>(is_solid[k % 4] && met != own) << k;
    }
    EXPECT_EQ(rays.occluded(0xffff, packet, {mesh, triangle}), expected) << own;
  }
}

TEST(ray_holes, only_meshes_that_are_traced_count) {
  Scene scene = card_over_ground(1, mask_of({"#."}));
  EXPECT_TRUE(RayScene(scene, Truth::mesh, RayScene::Which::casters).has_alpha_masks());
  scene.meshes[1].casts = false;
  EXPECT_FALSE(RayScene(scene, Truth::mesh, RayScene::Which::casters).has_alpha_masks());
  EXPECT_TRUE(RayScene(scene, Truth::mesh, RayScene::Which::seen).has_alpha_masks());
  scene.meshes[1].alpha_mask = nullptr;
  EXPECT_FALSE(RayScene(scene, Truth::mesh, RayScene::Which::seen).has_alpha_masks());
}

/// The nearest triangle that is solid where the ray meets it, in double; nothing where float32 may decide: a border of a
/// triangle or of a hole is near, or two hits are.
std::optional<small_world::Hit> by_all_triangles(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& way) {
  small_world::Hit best;
  double second = INFINITY;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Triangle corners = mesh.corners(t);
      const glm::dvec3 a(corners.points[0]), e1 = glm::dvec3(corners.points[1]) - a, e2 = glm::dvec3(corners.points[2]) - a,
                                             p = glm::cross(way, e2), s = origin - a, q = glm::cross(s, e1);
      const double determinant = glm::dot(e1, p), u = glm::dot(s, p) / determinant, v = glm::dot(way, q) / determinant,
                   at = glm::dot(e2, q) / determinant;
      constexpr double near = 1e-3;
      if (!(at > -near) || !(u > -near && v > -near && u + v < 1 + near)) continue;
      if (std::abs(determinant) < 0.02 * glm::length(way) * glm::length(e1) * glm::length(e2)) return std::nullopt;
      if (at < near || u < near || v < near || u + v > 1 - near) return std::nullopt;
      if (mesh.alpha_mask) {
        const Around found = around(*mesh.alpha_mask, texel_place(mesh, t, origin, glm::dvec4(way, 0)),
                                    texel_rounding(mesh, t, way, std::max(extent(origin), scene.bounds().extent())));
        if (found == Around::both) return std::nullopt;
        if (found == Around::hole) continue;
      }
      if (at < best.t) {
        second = best.t;
        best = {at, m, t};
      } else {
        second = std::min(second, at);
      }
    }
  }
  return second - best.t < 1e-3 ? std::nullopt : std::optional(best);
}

TEST(ray_holes, the_closest_hit_is_that_of_all_triangles_in_double) {
  Random random(23);
  int compared = 0, hits = 0;
  for (int s = 0; s < 12; ++s) {
    const double unit = units[s % 3];
    const auto mask = masked::any_mask(random, 40);
    Scene scene;
    scene.meshes = {masked::random_cards(random, 20, 2 * unit, unit, mask), hand_made::square(static_cast<float>(5 * unit), 0)};
    const RayScene rays(scene, Truth::mesh, RayScene::Which::seen);
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 origin = unit * random.uniform(glm::dvec3(-3, 0.5, -3), glm::dvec3(3, 3, 3)),
                       way = unit * random.uniform(glm::dvec3(-1), glm::dvec3(1));
      const auto expected = by_all_triangles(scene, origin, way);
      if (!expected) continue;
      const double length = glm::length(way);
      const RayScene::Hit hit = rays.closest(origin, way / length);
      EXPECT_EQ(hit.mesh, expected->mesh) << s << ' ' << i;
      if (hit.mesh != no_mesh) {
        EXPECT_EQ(hit.triangle, expected->triangle) << s << ' ' << i;
        EXPECT_NEAR(hit.t / length, expected->t, 1e-4 * (1 + expected->t)) << s << ' ' << i;
      }
      ShadowPacket packet;
      for (int k = 0; k < ray_lanes; ++k) set_ray(packet, k, origin, way, INFINITY);
      EXPECT_EQ(rays.occluded(1, packet, {nobody, nobody}), expected->mesh != no_mesh ? 1u : 0u) << s << ' ' << i;
      ++compared;
      hits += expected->mesh == 0;
    }
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(hits, compared / 40);
}

}  // namespace gnomon::ray_holes_test
