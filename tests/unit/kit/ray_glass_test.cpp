// Rays through casters with transmission: by hand, at every unit of length, and against all triangles in double.
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/rays/rays.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <set>

#include "glass.h"
#include "small_world.h"

namespace gnomon::ray_glass_test {

using glass::glass_card;
using Triangles = std::vector<Crossings::Crossed>;

/// Lengths of this many meters a unit: as it is, and so small and so large that the scene is traced in a frame of its own.
constexpr double units[] = {1, 0x1p-14, 0x1p40};

constexpr std::uint32_t nobody[16] = {no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh,
                                      no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh, no_mesh};

Mesh in_units(Mesh mesh, double unit) {
  for (glm::vec3& p : mesh.positions) p *= static_cast<float>(unit);
  finish(mesh);
  return mesh;
}

/// Sixteen rays straight up from a height, beside each other and aside of all diagonals, two units long.
ShadowPacket straight_up(double unit, double height) {
  ShadowPacket packet;
  for (int k = 0; k < ray_lanes; ++k)
    set_ray(packet, k, unit * glm::dvec3(-0.8 + 0.1 * k, height, -0.05 - 0.01 * k), unit * glm::dvec3(0, 2, 0), 1);
  return packet;
}
/// Which triangle of a card such a ray meets: 0 has z above x.
std::uint32_t half_of_card(int lane) { return -0.05 - 0.01 * lane > -0.8 + 0.1 * lane ? 0 : 1; }

Triangles sorted(Crossings& crossings) {
  const auto all = crossings.sorted();
  return {all.begin(), all.end()};
}

// Cards at heights 1 and 2 of glass and an opaque one at 3, which the rays from 0.5 do not reach and those from 1.5 do.
TEST(ray_glass, glass_blocks_nothing_and_is_reported) {
  for (const double unit : units) {
    Scene scene;
    for (const Mesh& mesh : {glass_card(1, 1, 0.5f), glass_card(1, 2, 0.0f), hand_made::square(1, 3)})
      scene.meshes.push_back(in_units(mesh, unit));
    const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
    EXPECT_TRUE(rays.has_transmission());
    std::array<Crossings, ray_lanes> crossings;
    for (const double height : {0.5, 1.5}) {
      const std::uint32_t blocked = height > 1 ? 0xffffu : 0;
      ShadowPacket packet = straight_up(unit, height);
      EXPECT_EQ(rays.occluded(0xffff, packet, {nobody, nobody}), blocked) << unit;
      packet = straight_up(unit, height);
      EXPECT_EQ(rays.blocked(0xffff, packet, {nobody, nobody}, 1e-5 * unit).at_all, blocked) << unit;
      packet = straight_up(unit, height);
      EXPECT_EQ(rays.crossed(0xffff, packet, {nobody, nobody}, crossings), blocked) << unit;
      if (blocked) continue;
      for (int k = 0; k < ray_lanes; ++k) {
        const std::uint32_t half = half_of_card(k);
        EXPECT_EQ(sorted(crossings[k]), (Triangles{{0, half}, {1, half}})) << unit << ' ' << k;
      }
    }
  }
}

// What an earlier call left is gone, also of lanes that are off now; these report nothing.
TEST(ray_glass, lanes_that_are_off_cross_nothing) {
  Scene scene;
  scene.meshes = {glass_card(1, 1, 0.5f)};
  const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
  std::array<Crossings, ray_lanes> crossings;
  for (const std::uint32_t valid : {0xffffu, 0x0f0fu, 0u}) {
    ShadowPacket packet = straight_up(1, 0.5);
    EXPECT_EQ(rays.crossed(valid, packet, {nobody, nobody}, crossings), 0u);
    for (int k = 0; k < ray_lanes; ++k) EXPECT_EQ(sorted(crossings[k]).size(), valid >> k & 1) << k;
  }
}

// Its own triangle is not crossed; the other one of the card is.
TEST(ray_glass, the_receivers_own_triangle_is_left_out) {
  Scene scene;
  scene.meshes = {glass_card(1, 1, 0.5f)};
  const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
  std::array<Crossings, ray_lanes> crossings;
  for (std::uint32_t own = 0; own < 2; ++own) {
    std::uint32_t mesh[16] = {}, triangle[16];
    std::ranges::fill(triangle, own);
    ShadowPacket packet = straight_up(1, 0.5);
    rays.crossed(0xffff, packet, {mesh, triangle}, crossings);
    for (int k = 0; k < ray_lanes; ++k)
      EXPECT_EQ(sorted(crossings[k]), half_of_card(k) == own ? Triangles{} : (Triangles{{0, half_of_card(k)}})) << k;
  }
}

// The mask is solid where z is below 0, where all rays are, or nowhere there.
TEST(ray_glass, only_the_solid_parts_of_a_mask_are_crossed) {
  for (const bool is_solid : {true, false}) {
    Scene scene;
    scene.meshes = {glass::with_transmission(
        masked::card(1, 1, is_solid ? masked::mask_of({"##", ".."}) : masked::mask_of({"..", "##"})), glm::vec3(0.5f))};
    const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
    std::array<Crossings, ray_lanes> crossings;
    ShadowPacket packet = straight_up(1, 0.5);
    EXPECT_EQ(rays.crossed(0xffff, packet, {nobody, nobody}, crossings), 0u);
    for (int k = 0; k < ray_lanes; ++k) EXPECT_EQ(sorted(crossings[k]).size(), is_solid ? 1u : 0u) << k;
  }
}

TEST(ray_glass, what_a_segment_meets_is_opaque) {
  for (const double unit : units) {
    Scene scene;
    for (const Mesh& mesh : {glass_card(1, 1, 0.5f), hand_made::square(1, 2), glass_card(1, 3, 0.0f)})
      scene.meshes.push_back(in_units(mesh, unit));
    const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
    const std::vector<RayScene::Met> met = rays.met(unit * glm::dvec3(0.3, 0, 0.1), unit * glm::dvec3(0, 4, 0));
    ASSERT_EQ(met.size(), 1u) << unit;
    EXPECT_EQ(met[0].mesh, 1u) << unit;
  }
}

TEST(ray_glass, the_eye_sees_glass_where_it_is_said_to) {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), glass_card(1, 1, 0.5f)};
  const glm::dvec3 eye(0.3, 3, 0.1), down(0, -1, 0);
  EXPECT_EQ(RayScene(scene, Truth::mesh, RayScene::Which::seen).closest(eye, down).mesh, 1u);
  scene.meshes[1].seen = false;
  const RayScene seen(scene, Truth::mesh, RayScene::Which::seen);
  EXPECT_EQ(seen.closest(eye, down).mesh, 0u);
  EXPECT_FALSE(seen.has_transmission());
  // It casts all the same.
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  EXPECT_TRUE(casters.has_transmission());
  std::array<Crossings, ray_lanes> crossings;
  ShadowPacket packet = straight_up(1, 0.5);
  casters.crossed(1, packet, {nobody, nobody}, crossings);
  EXPECT_EQ(sorted(crossings[0]).size(), 1u);
  scene.meshes[1].casts = false;
  EXPECT_FALSE(RayScene(scene, Truth::mesh, RayScene::Which::casters).has_transmission());
}

/// What a ray meets.
struct AllMet {
  bool is_blocked = false;
  Triangles glass;  ///< sorted
};
/// Of all triangles, in double; nothing where float32 may decide: a border of a triangle or of a hole is near, or the origin.
std::optional<AllMet> by_all_triangles(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& way) {
  AllMet met;
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
      if (mesh.transmission)
        met.glass.push_back({m, t});
      else
        met.is_blocked = true;
    }
  }
  return met;
}

TEST(ray_glass, what_rays_cross_is_that_of_all_triangles_in_double) {
  Random random(29);
  int compared = 0, blocked = 0, several = 0;
  for (int s = 0; s < 12; ++s) {
    const double unit = units[s % 3];
    const auto half = static_cast<float>(2 * unit), size = static_cast<float>(unit);
    Scene scene;
    scene.meshes = {
        glass::random_glass_cards(random, 20, half, size, glass::constant(glm::vec3(0.5f))),
        masked::random_cards(random, 4, half, size, nullptr),
        glass::random_glass_cards(random, 10, half, 2 * size, glass::any_texels(random, 8)),
        glass::with_transmission(masked::random_cards(random, 10, half, size, masked::any_mask(random, 20)), glm::vec3(0.25f))};
    const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
    std::array<Crossings, ray_lanes> crossings;
    for (int i = 0; i < 60; ++i) {
      ShadowPacket packet, again;
      std::optional<AllMet> expected[ray_lanes];
      for (int k = 0; k < ray_lanes; ++k) {
        const glm::dvec3 origin = glm::vec3(unit * random.uniform(glm::dvec3(-3, 0, -3), glm::dvec3(3, 3, 3)));
        const glm::dvec3 way = glm::vec3(unit * random.uniform(glm::dvec3(-1), glm::dvec3(1)));
        expected[k] = by_all_triangles(scene, origin, way);
        set_ray(packet, k, origin, way, INFINITY);
      }
      again = packet;
      const std::uint32_t found = rays.crossed(0xffff, packet, {nobody, nobody}, crossings);
      EXPECT_EQ(rays.occluded(0xffff, again, {nobody, nobody}), found) << s << ' ' << i;
      for (int k = 0; k < ray_lanes; ++k) {
        if (!expected[k]) continue;
        const AllMet& all = *expected[k];
        ++compared;
        EXPECT_EQ(found >> k & 1, all.is_blocked) << s << ' ' << i << ' ' << k;
        const Triangles crossed = sorted(crossings[k]);
        if (!all.is_blocked)
          EXPECT_EQ(crossed, all.glass) << s << ' ' << i << ' ' << k;
        else
          EXPECT_TRUE(std::ranges::includes(all.glass, crossed)) << s << ' ' << i << ' ' << k;
        blocked += all.is_blocked;
        several += !all.is_blocked && all.glass.size() > 1;
      }
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_GT(blocked, compared / 50);
  EXPECT_GT(several, compared / 20);
}

// Ways aimed at the shared edges of a wavy sheet, where Embree may report a triangle twice: each is counted once.
TEST(ray_glass, a_triangle_reported_twice_counts_once) {
  Random random(31);
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  constexpr std::uint32_t side = 20;
  for (std::uint32_t z = 0; z <= side; ++z)
    for (std::uint32_t x = 0; x <= side; ++x) positions.emplace_back(x, random.uniform(1, 1.5), z);
  for (std::uint32_t z = 0; z < side; ++z)
    for (std::uint32_t x = 0; x < side; ++x) {
      const std::uint32_t a = z * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      triangles.insert(triangles.end(), {{a, c, d}, {a, d, b}});
    }
  Scene scene;
  scene.meshes = {glass::with_transmission(hand_made::mesh_of(positions, triangles), glm::vec3(0.5f))};
  const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
  std::array<Crossings, ray_lanes> crossings;
  int at_edges = 0;
  for (int i = 0; i < 500; ++i) {
    ShadowPacket packet;
    for (int k = 0; k < ray_lanes; ++k) {
      const glm::uvec3& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
      const auto corner = static_cast<int>(random.below(3));
      const glm::dvec3 a(positions[t[corner]]), b(positions[t[(corner + 1) % 3]]),
          target = a + random.uniform(0.1, 0.9) * (b - a);
      const glm::dvec3 origin = random.uniform(glm::dvec3(0), glm::dvec3(side, 0.9, side));
      // Almost straight up, so that the sheet is crossed once.
      const glm::dvec3 from(target.x + 0.01 * (origin.x - target.x), origin.y, target.z + 0.01 * (origin.z - target.z));
      set_ray(packet, k, from, 4.0 * (target - from), 1);
    }
    EXPECT_EQ(rays.crossed(0xffff, packet, {nobody, nobody}, crossings), 0u);
    for (int k = 0; k < ray_lanes; ++k) {
      const Triangles crossed = sorted(crossings[k]);
      EXPECT_LE(crossed.size(), 2u);
      at_edges += crossed.size() == 2;
      EXPECT_EQ(std::set<Crossings::Crossed>(crossed.begin(), crossed.end()).size(), crossed.size());
      const Crossings::Product product = crossings[k].product([](std::uint32_t, std::uint32_t) { return glm::vec3(0.5f); });
      EXPECT_EQ(product.surfaces, static_cast<int>(crossed.size()));
    }
  }
  EXPECT_GT(at_edges, 50);
}

// Embree reports now and then that a ray meets a triangle in whose plane it lies, wherever that is: the opaque one shows it.
TEST(ray_glass, a_triangle_in_whose_plane_a_ray_passes_it_is_not_crossed) {
  Random random(37);
  std::array<Crossings, ray_lanes> crossings;
  int reported = 0;
  for (int s = 0; s < 90; ++s) {
    const double unit = units[s % 3];
    const glass::TiltedTriangle triangle(random, unit);
    const RayScene rays(triangle.scene, Truth::mesh, RayScene::Which::casters);
    const RayScene opaque(triangle.opaque, Truth::mesh, RayScene::Which::casters);
    const glm::dvec3 light = triangle.at(4, 1.6);
    for (int i = 0; i < 8; ++i) {
      ShadowPacket packet;
      for (int k = 0; k < ray_lanes; ++k) {
        const glm::dvec3 origin = triangle.at(-4 + 0.02 * (16 * i + k), 1.6);
        // Half of them go on behind the light.
        set_ray(packet, k, origin, light - origin, k % 2 ? 1 : INFINITY);
      }
      ShadowPacket again = packet;
      reported += std::popcount(opaque.occluded(0xffff, again, {nobody, nobody}));
      EXPECT_EQ(rays.crossed(0xffff, packet, {nobody, nobody}, crossings), 0u);
      for (int k = 0; k < ray_lanes; ++k) EXPECT_TRUE(crossings[k].empty()) << s << ' ' << i << ' ' << k;
    }
  }
  EXPECT_GT(reported, 20);
}

// A sheet of texels before an opaque card: half of it is not there.
TEST(ray_glass, the_closest_caster_is_behind_texels_that_let_all_light_through) {
  for (const double unit : units) {
    Scene scene;
    for (const Mesh& mesh : {glass_card(1, 1, glass::texels(2, 1, {1, 0.5f})), glass_card(1, 2, 1), hand_made::square(1, 3)})
      scene.meshes.push_back(in_units(mesh, unit));
    const RayScene rays(scene, Truth::mesh, RayScene::Which::casters);
    for (const double x : {-0.4, 0.4}) {
      const glm::dvec3 origin = unit * glm::dvec3(x, 0, 0.1), up(0, 1, 0);
      EXPECT_EQ(rays.closest(origin, up).mesh, 0u) << unit;
      const RayScene::Hit hit = rays.closest_caster(origin, up);
      EXPECT_EQ(hit.mesh, x < 0 ? 2u : 0u) << unit << ' ' << x;
      EXPECT_NEAR(hit.t, (x < 0 ? 3 : 1) * unit, 1e-6 * unit) << unit << ' ' << x;
    }
  }
}

}  // namespace gnomon::ray_glass_test
