// Lights with area behind casters that let a part of the light through: shares derived on paper, the reference and its classes.
#include <gnomon/error.h>
#include <gnomon/kit/area/path_light.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "glass.h"
#include "measure/frame/certify_soft.h"
#include "measure/frame/soft_reference.h"

namespace gnomon::soft_glass_test {

constexpr glm::dvec3 up(0, 1, 0);
constexpr float far_away = 900;

/// A square lamp of 1 m at (0, 2, 0) over points of a floor. The way from the point at x to a place of the lamp at s meets a
/// sheet at y = 1 at (x + s) / 2: what a sheet over x < 0 covers of the lamp is s < -x, the share covered(x) of it.
Light lamp(double unit = 1) {
  const auto length = static_cast<float>(unit);
  return {.name = "lamp", .kind = RectLight{{0, 2 * length, 0}, {length / 2, 0, 0}, {0, 0, length / 2}}};
}
double covered(double x) { return std::clamp(0.5 - x, 0.0, 1.0); }

/// A rectangle from x0 to x1 at a height, 8 m along z.
Mesh strip(float x0, float x1, float height) {
  return hand_made::mesh_of({{x0, height, -4}, {x0, height, 4}, {x1, height, 4}, {x1, height, -4}}, {{0, 1, 2}, {0, 2, 3}});
}
Mesh sheet(float x0, float x1, float height, float share) {
  return glass::with_transmission(strip(x0, x1, height), glm::vec3(share));
}
Scene scene_of(std::vector<Mesh> casters, double unit = 1) {
  Scene scene;
  scene.name = "glass";
  scene.meshes = std::move(casters);
  for (Mesh& mesh : scene.meshes)
    for (glm::vec3& position : mesh.positions) position *= static_cast<float>(unit);
  return scene;
}

struct LampRays {
  RayScene casters;
  glm::vec3 point, lift;
  LightFigure figure;
  FaceRays rays;
  LampRays(const Scene& scene, double x, double unit = 1)
      : casters(scene, Truth::mesh, RayScene::Which::casters),
        point(unit * glm::dvec3(x, 0, 0.01)),
        lift(static_cast<float>(unit * 1e-6) * glm::vec3(up)),
        figure(lamp(unit), point, up),
        rays(casters, point + lift, lift, no_mesh, 0, figure) {}
  SampledShares shares(std::uint64_t seed = 1) const { return sample_shares(rays, seed, {}); }
};

TEST(SoftGlass, half_of_a_lamp_behind_a_sheet) {
  const Scene scene = scene_of({sheet(-4, 0, 1, 0.4f)});
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const SampledShares shares = LampRays(scene, 0).shares(seed);
    EXPECT_NEAR(shares.area, 0.7, 3 * shares.area_error);
    EXPECT_NEAR(shares.irradiance, 0.7, 3 * shares.irradiance_error);  // the lamp is the same on both sides of the point
    EXPECT_LE(shares.area_error, 0.002);
    EXPECT_LT(shares.area_error, 0.7);
  }
}

// Errors are of eight replicas: of Student's law of seven degrees of freedom 2 % lie beyond 3. Of 300 more than 15 are as
// likely as 0.0008.
TEST(SoftGlass, any_share_of_a_lamp_behind_any_sheet) {
  Random random(3);
  constexpr int rounds = 300;
  int beyond_3 = 0;
  double sum = 0;
  for (int k = 0; k < rounds; ++k) {
    const auto t = static_cast<float>(random.uniform(0, 1));
    const double x = random.uniform(-0.6, 0.6);
    const SampledShares shares = LampRays(scene_of({sheet(-4, 0, 1, t)}), x).shares(static_cast<std::uint64_t>(k));
    const double off = shares.area - (1 - (1 - t) * covered(x));
    EXPECT_LT(std::abs(off), 12 * shares.area_error) << t << " at " << x;
    beyond_3 += std::abs(off) > 3 * shares.area_error;
    sum += off;
  }
  EXPECT_LE(beyond_3, 15);
  EXPECT_LT(std::abs(sum / rounds), 5 * 0.002 / std::sqrt(rounds));
}

TEST(SoftGlass, a_sheet_over_the_whole_lamp_lets_through_what_it_lets_through) {
  Random random(5);
  for (int k = 0; k < 30; ++k) {
    const auto t = static_cast<float>(random.uniform(0, 1));
    const SampledShares shares = LampRays(scene_of({sheet(-3, 4, 1, t)}), random.uniform(-1, 1)).shares();
    for (const double share : {shares.area, shares.irradiance, shares.area_half, shares.irradiance_half})
      EXPECT_NEAR(share, t, 1e-12);
    EXPECT_EQ(static_cast<float>(shares.area), t);
    EXPECT_DOUBLE_EQ(shares.area_error, 1.0 / shares.rays);
    EXPECT_LE(shares.pilot_rays, 64u);  // all rays see the same
  }
}

TEST(SoftGlass, sheets_multiply_in_any_order) {
  Random random(7);
  for (int k = 0; k < 20; ++k) {
    std::vector<Mesh> sheets;
    double product = 1;
    for (std::uint32_t i = 0, count = 2 + random.below(4); i < count; ++i) {
      const auto t = static_cast<float>(random.uniform(0.3, 1)), height = static_cast<float>(random.uniform(0.2, 1.8));
      sheets.push_back(sheet(-3, 4, height, t));
      product *= t;
    }
    const SampledShares shares = LampRays(scene_of(sheets), 0.2).shares();
    EXPECT_NEAR(shares.area, product, 0x1p-24);
    random.shuffle(sheets);
    EXPECT_NEAR(LampRays(scene_of(sheets), 0.2).shares().area, shares.area, 0x1p-24);
  }
}

TEST(SoftGlass, what_is_blocked_stays_blocked) {
  const Scene scene = scene_of({sheet(-4, 4, 1.5f, 0.4f), strip(-4, 0, 1), sheet(-4, 4, 0.5f, 0.5f)});
  for (const double x : {-0.3, 0.0, 0.2}) {
    const SampledShares shares = LampRays(scene, x).shares();
    EXPECT_NEAR(shares.area, 0.2 * (1 - covered(x)), 3 * shares.area_error);
  }
  EXPECT_EQ(LampRays(scene, -0.6).shares().area, 0);
}

// Texels of 4 m: the first covers x < 0.
TEST(SoftGlass, texels_are_looked_up_in_any_unit_of_length) {
  Mesh card = strip(-4, 4, 1);
  card = glass::with_transmission(card, glass::texels(2, 1, {0.2f, 0.8f}), {{0, 0}, {0, 1}, {1, 1}, {1, 0}});
  for (const int power : {-60, -12, 0, 9, 40}) {
    const double unit = std::exp2(power);
    const Scene scene = scene_of({card}, unit);
    for (const double x : {-0.4, -0.1, 0.0, 0.35}) {
      const SampledShares shares = LampRays(scene, x, unit).shares();
      EXPECT_NEAR(shares.area, 0.2 * covered(x) + 0.8 * (1 - covered(x)), 3 * shares.area_error) << power << " at " << x;
    }
  }
}

// The numbers of blocked rays, of the places that sample_shares traces, and nothing else.
TEST(SoftGlass, without_transmission_the_share_is_that_of_the_blocked_bits) {
  Random random(11);
  const Scene opaque = scene_of({strip(-4, 0, 1)});
  for (int k = 0; k < 30; ++k) {
    const LampRays lamp_rays(opaque, random.uniform(-0.6, 0.6));
    const auto seed = static_cast<std::uint64_t>(k);
    const SampledShares shares = lamp_rays.shares(seed);
    EXPECT_FALSE(lamp_rays.rays.has_transmission());
    const Scramble scramble(2 * seed + 1);
    int count = 0, blocked = 0;
    for (std::uint32_t round = 0; round < shares.rays / 16; ++round) {
      const FaceHits hits = lamp_rays.rays.ask(scramble.of_each(round));
      count += std::popcount(hits.asked);
      blocked += std::popcount(hits.blocked);
      EXPECT_EQ(hits.dimmed, 0u);
      EXPECT_EQ(hits.hidden_count(), std::popcount(hits.blocked));
      for (int lane = 0; lane < 16; ++lane) EXPECT_EQ(hits.seen(lane), hits.blocked >> lane & 1 ? 0 : 1);
    }
    EXPECT_EQ(static_cast<std::uint32_t>(count), shares.rays);
    EXPECT_EQ(shares.area, 1 - static_cast<double>(blocked) / count);
  }
}

// Glass that no ray meets, glass that lets all through and glass that lets nothing through are traced the other way, and change
// nothing: counts are whole numbers. Weights are added up in double there, in float32 here.
TEST(SoftGlass, glass_that_dims_nothing_changes_nothing) {
  Random random(13);
  const Mesh opaque = strip(-4, 0, 1), beside = sheet(far_away, far_away + 1, 1, 0.5f), clear = sheet(-4, 4, 1.5f, 1),
             dark = sheet(-4, 0, 1, 0);
  for (int k = 0; k < 20; ++k) {
    const double x = random.uniform(-0.7, 0.7);
    const SampledShares expected = LampRays(scene_of({opaque}), x).shares();
    for (const Scene& scene : {scene_of({opaque, beside}), scene_of({opaque, clear}), scene_of({dark})}) {
      const LampRays lamp_rays(scene, x);
      EXPECT_TRUE(lamp_rays.rays.has_transmission());
      const SampledShares shares = lamp_rays.shares();
      EXPECT_EQ(shares.area, expected.area);
      EXPECT_EQ(shares.rays, expected.rays);
      EXPECT_EQ(shares.area_error, expected.area_error);
      EXPECT_NEAR(shares.irradiance, expected.irradiance, 1e-6);
    }
  }
}

/// A floor seen from above, through casters that only cast.
struct Traced {
  Scene scene;
  GBuffer gbuffer;
  SoftReference soft;
};
Traced traced(std::vector<Mesh> casters, const Light& light) {
  Scene scene = scene_of(std::move(casters));
  for (Mesh& mesh : scene.meshes) mesh.seen = false;
  scene.meshes.insert(scene.meshes.begin(), hand_made::square(2, 0));
  scene.meshes[0].casts = false;
  const View view{.eye = {0.01f, 6, 0.02f}, .target = {0.01f, 0, 0.02f}, .up = {0, 0, -1}};
  GBuffer gbuffer = make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, 48, 48, Truth::mesh);
  SoftReference soft = trace_soft(scene, RayScene(scene, Truth::mesh, RayScene::Which::casters), gbuffer, light, {}, {});
  return {std::move(scene), std::move(gbuffer), std::move(soft)};
}

TEST(SoftGlass, the_reference_is_that_derived_on_paper) {
  const Traced t = traced({sheet(-4, 0, 1, 0.4f)}, lamp());
  int tested = 0, penumbra = 0, floor = 0, beyond_3 = 0;
  for (std::size_t i = 0; i < t.gbuffer.size(); ++i) {
    if (t.gbuffer.is_background(i)) continue;
    ++floor;
    if (t.soft.classes[i] != PixelClass::T) continue;
    ++tested;
    const double x = t.gbuffer.position(i).x, expected = 1 - 0.6 * covered(x);
    EXPECT_NEAR(t.soft.area[i], expected, 12 * t.soft.area_error[i]) << x;
    beyond_3 += std::abs(t.soft.area[i] - expected) > 3 * t.soft.area_error[i];
    if (covered(x) < 0.35 || covered(x) == 1) continue;
    ++penumbra;
    // The way to the sheet is half of that to the lamp, which is 2 to 2.9 m long here.
    EXPECT_GT(t.soft.caster_distance[i], 1);
    EXPECT_LT(t.soft.caster_distance[i], 1.6f);
  }
  EXPECT_GT(penumbra, 150);
  EXPECT_LT(beyond_3, tested / 50);
  EXPECT_GT(tested, floor * 9 / 10);
}

// A sheet right over the floor that lets all light through keeps none off.
TEST(SoftGlass, the_caster_is_what_keeps_light_off) {
  const Traced t = traced({strip(-4, 0, 1)}, lamp()), below = traced({strip(-4, 0, 1), sheet(-4, 4, 0.25f, 1)}, lamp());
  EXPECT_EQ(below.soft.area, t.soft.area);
  int penumbra = 0;
  for (std::size_t i = 0; i < t.gbuffer.size(); ++i) {
    penumbra += t.soft.caster_distance[i] > 0;
    EXPECT_NEAR(below.soft.caster_distance[i], t.soft.caster_distance[i], 1e-5) << i;
  }
  EXPECT_GT(penumbra, 200);
}

// A lamp in the plane of a sheet: whether rays that end there meet it is rounding. A sheet that takes 0.995 of the light moves
// no share by as much as counts, which is four times 0.002.
TEST(SoftGlass, what_rounding_decides_is_uncertain_by_what_it_changes) {
  const auto uncertain = [](float share) {
    return count_classes(traced({sheet(-4, 4, 2, share)}, lamp()).soft.classes)[static_cast<std::size_t>(PixelClass::U)];
  };
  EXPECT_GT(uncertain(0.5f), 1000u);
  EXPECT_EQ(uncertain(0.995f), 0u);
}

TEST(SoftGlass, a_certificate_says_that_it_has_none) {
  const Traced t = traced({sheet(-4, 0, 1, 0.4f)}, lamp());
  try {
    certify_soft(t.scene, lamp(), t.gbuffer, {});
    FAIL() << "it was certified";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("(transmission)"), std::string::npos) << error.what();
  }
}

TEST(SoftGlass, light_paths_do_not_go_through) {
  Traced t = traced({sheet(-4, 0, 1, 0.4f)}, lamp());
  ASSERT_TRUE(untraceable_light(t.scene));
  EXPECT_NE(untraceable_light(t.scene)->find("transmission"), std::string::npos);
  const RayScene casters(t.scene, Truth::mesh, RayScene::Which::casters);
  EXPECT_THROW(trace_paths({t.scene, casters, casters}, t.gbuffer, lamp(), {}), Error);
  t.scene.meshes[1].transmission = nullptr;
  EXPECT_FALSE(untraceable_light(t.scene));
  t.scene.meshes[1].albedo = glm::vec3(1.2f);
  EXPECT_TRUE(untraceable_light(t.scene));
}

// A strip of a lamp, 1e-7 m wide, in the plane of a triangle that hides none of it.
TEST(SoftGlass, a_triangle_in_whose_plane_rays_pass_it_dims_none) {
  Random random(17);
  int reported = 0;
  for (int s = 0; s < 60; ++s) {
    const glass::TiltedTriangle triangle(random);
    const glm::dvec3 across = 1e-7 * glm::cross(triangle.along, triangle.aside);
    const Light strip{.name = "strip", .kind = RectLight{triangle.at(3, 1.8), 0.2 * triangle.aside, across}};
    const glm::vec3 point = triangle.at(-3, 1.6);
    const LightFigure figure(strip, point, triangle.along);
    const RayScene casters(triangle.scene, Truth::mesh, RayScene::Which::casters);
    const RayScene opaque(triangle.opaque, Truth::mesh, RayScene::Which::casters);
    const FaceRays rays(casters, point, {}, no_mesh, 0, figure), blocked(opaque, point, {}, no_mesh, 0, figure);
    const Scramble scramble(static_cast<std::uint64_t>(s));
    for (std::uint32_t group = 0; group < 8; ++group) {
      const Squares squares = scramble.of_first(group);
      const FaceHits hits = rays.ask(squares);
      EXPECT_EQ(hits.asked, 0xffffu);
      EXPECT_EQ(hits.hidden_count(), 0) << s << ' ' << group;
      reported += std::popcount(blocked.ask(squares).blocked);
    }
  }
  EXPECT_GT(reported, 10);
}

}  // namespace gnomon::soft_glass_test
