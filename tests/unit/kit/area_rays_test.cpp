// Rays to a light with area, against what casters leave of it in closed form.
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace gnomon::area_rays_test {

/// A floor of one point at the origin that casts nothing, under casters.
Scene scene_of(const std::vector<Triangle>& casters) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  for (const Triangle& caster : casters)
    for (const glm::vec3& corner : caster.points) mesh.positions.push_back(corner);
  for (std::uint32_t t = 0; t < casters.size(); ++t) mesh.triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
  finish(mesh);
  return scene;
}

constexpr glm::dvec3 up(0, 1, 0);

struct Both {
  SampledShares rays;
  LightShares exact;
};

Both ask(const Scene& scene, const Light& light, const AreaTarget& target, std::uint64_t seed = 1) {
  const LightFigure face(light, {}, up);
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  const glm::vec3 lift(0, 1e-6f, 0);
  const FaceRays rays(casters, lift, lift, no_mesh, 0, face);
  LightPieces pieces;
  AreaTally tally;
  return {sample_shares(rays, seed, target), AreaScene(scene).seen({}, face, pieces, tally)};
}

Light disc() { return {.kind = DiscLight{{0.5f, 3, 0}, {0, -1, 0}, 1}}; }

TEST(AreaRays, what_is_lit_or_dark_is_so_with_the_error_of_one_ray) {
  const AreaTarget target{.error = 0.004, .cap = 4096};
  const Scene empty = scene_of({{{{90, 1, 0}, {91, 1, 0}, {90, 1, 1}}}});
  const SampledShares lit = ask(empty, disc(), target).rays;
  EXPECT_EQ(lit.area, 1);
  EXPECT_EQ(lit.irradiance, 1);
  EXPECT_GE(lit.rays, 250u);
  EXPECT_LT(lit.rays, 350u);
  EXPECT_DOUBLE_EQ(lit.area_error, 1.0 / lit.rays);
  const Scene wall = scene_of({{{{-90, 1, -90}, {90, 1, -90}, {0, 1, 90}}}});
  const SampledShares dark = ask(wall, disc(), target).rays;
  EXPECT_EQ(dark.area, 0);
  EXPECT_EQ(dark.irradiance, 0);
  EXPECT_DOUBLE_EQ(dark.irradiance_error, 1.0 / dark.rays);
}

TEST(AreaRays, the_cap_ends_what_the_target_cannot) {
  const Scene half = scene_of({{{{0.1f, 1, -90}, {-90, 1, 0}, {0.1f, 1, 90}}}});
  const SampledShares shares = ask(half, disc(), {.error = 1e-5, .cap = 1024}).rays;
  EXPECT_LE(shares.rays, 1024u);
  EXPECT_GT(shares.rays, 700u);
  EXPECT_GT(shares.area_error, 1e-5);
}

// Of seven degrees of freedom, Student's law has 8.56 % beyond 2, 1.99 % beyond 3 and 0.52 % beyond 4 standard errors. 300
// shares of one law: at most 60 beyond 2 and 18 beyond 3 but once in a hundred thousand runs, were they exactly of that law.
TEST(AreaRays, differ_from_the_exact_share_by_no_more_than_their_error_says) {
  Random random(5);
  std::size_t asked = 0, beyond_2 = 0, beyond_3 = 0;
  double sum = 0;
  for (int round = 0; round < 300; ++round) {
    std::vector<Triangle> casters;
    for (int k = 0; k < 1 + round % 5; ++k) {
      const glm::dvec3 place = random.uniform({-0.5, 0.6, -0.5}, {0.5, 1.6, 0.5});
      const auto corner = [&] { return glm::vec3(place + random.uniform(glm::dvec3(-0.6), glm::dvec3(0.6))); };
      const glm::vec3 a = corner(), b = corner(), c = corner();
      casters.push_back({{a, b, c}});
    }
    Light light = disc();
    if (round % 3 == 1) light.kind = SphereLight{{0, 2.5f, 0}, 0.5f};
    if (round % 3 == 2) light.kind = RectLight{{0, 2, 0}, {0.7f, 0, 0.3f}, {0, 0.4f, 0.8f}};
    const Both both = ask(scene_of(casters), light, {}, static_cast<std::uint64_t>(round));
    if (both.exact.area.best == 0 || both.exact.area.best == 1) continue;
    ++asked;
    const double area = (both.rays.area - both.exact.area.best) / both.rays.area_error;
    const double irradiance = (both.rays.irradiance - both.exact.irradiance.best) / both.rays.irradiance_error;
    beyond_2 += std::abs(area) > 2;
    beyond_3 += std::max(std::abs(area), std::abs(irradiance)) > 3;
    sum += both.rays.area - both.exact.area.best;
  }
  EXPECT_GT(asked, 200u);
  EXPECT_LE(beyond_2, asked / 5);
  EXPECT_LE(beyond_3, asked * 6 / 100);
  EXPECT_LT(std::abs(sum / static_cast<double>(asked)), 5 * 0.002 / std::sqrt(asked));
}

// A light of 2 km, 1 m above the point: half of its irradiance comes from 1 m around, a millionth of its area, which no ray is
// sent to. What is above the point hides that half; the error says that the rays do not tell.
TEST(AreaRays, a_place_that_outweighs_all_others_may_be_missed) {
  const Light sky{.kind = RectLight{{0, 1, 0}, {1000, 0, 0}, {0, 0, 1000}}};
  const Scene leaf = scene_of({{{{-0.5f, 0.5f, -0.5f}, {1, 0.5f, 0}, {-0.5f, 0.5f, 0.5f}}}});
  const Both both = ask(leaf, sky, {});
  EXPECT_LT(both.exact.irradiance.best, 0.8);
  EXPECT_GT(both.exact.area.best, 0.999);
  EXPECT_GT(both.rays.irradiance_error, 0.1);
  EXPECT_LE(both.rays.area_error, 0.002);
  // Where the heaviest ray weighs as much as twice the mean of all, nothing changes.
  EXPECT_LE(ask(leaf, {.kind = RectLight{{0, 2, 0}, {1, 0, 0}, {0, 0, 1}}}, {}).rays.irradiance_error, 0.002);
}

// Half of a light is hidden, at any distance and of any size that a scene may have.
TEST(AreaRays, weights_stay_within_float32) {
  for (const float size : {1e-18f, 1e-9f, 1.0f, 1e9f, 1e16f}) {
    const Scene half = scene_of({{{{0, size, -9 * size}, {-9 * size, size, 0}, {0, size, 9 * size}}}});
    const Light panel{.kind = RectLight{{0, 2 * size, 0}, {0.5f * size, 0, 0}, {0, 0, 0.5f * size}}};
    const LightFigure face(panel, {}, up);
    const RayScene casters(half, Truth::mesh, RayScene::Which::casters);
    const SampledShares shares = sample_shares(FaceRays(casters, {}, {}, no_mesh, 0, face), 1, {});
    EXPECT_NEAR(shares.area, 0.5, 5 * shares.area_error) << size;
    EXPECT_NEAR(shares.irradiance, 0.5, 5 * shares.irradiance_error) << size;
    EXPECT_LE(shares.irradiance_error, 0.002) << size;
  }
}

TEST(AreaRays, other_seeds_are_other_rays_and_the_same_seed_is_the_same) {
  const Scene half = scene_of({{{{0.1f, 1, -90}, {-90, 1, 0}, {0.1f, 1, 90}}}});
  const SampledShares a = ask(half, disc(), {}, 7).rays, again = ask(half, disc(), {}, 7).rays,
                      b = ask(half, disc(), {}, 8).rays;
  EXPECT_EQ(a.area, again.area);
  EXPECT_EQ(a.irradiance_error, again.irradiance_error);
  EXPECT_NE(a.area, b.area);
}

// The first 2^k places of a scramble have one in every cell of every division of the square into 2^k rectangles of sides 2^-a
// and 2^-(k - a): that is what a (0, 2) sequence promises, and what scrambling keeps.
TEST(Scramble, every_elementary_cell_holds_one_place) {
  constexpr int exponent = 6, count = 1 << exponent;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Scramble scramble(seed);
    for (int a = 0; a <= exponent; ++a) {
      std::array<int, count> in_cell{};
      for (std::uint32_t group = 0; group < count / 16; ++group) {
        const Squares squares = scramble.of_first(group);
        for (int k = 0; k < 16; ++k) {
          const int x = static_cast<int>(squares.x[k] * (1 << a)), y = static_cast<int>(squares.y[k] * (count >> a));
          ++in_cell[x * (count >> a) + y];
        }
      }
      for (const int places : in_cell) ASSERT_EQ(places, 1) << "seed " << seed << ", 2^-" << a;
    }
  }
}

// Over many seeds the first place, and each of its replicas, is anywhere: means of 1/2 and correlations of 0 to within 5
// standard errors of 4,000 draws.
TEST(Scramble, places_are_uniform_and_replicas_independent) {
  constexpr int draws = 4000;
  double x = 0, y = 0, xy = 0, apart = 0;
  for (int seed = 0; seed < draws; ++seed) {
    const Squares squares = Scramble(static_cast<std::uint64_t>(seed)).of_each(3);
    x += squares.x[0];
    y += squares.y[2];
    xy += (squares.x[1] - 0.5) * (squares.y[1] - 0.5);
    apart += (squares.x[4] - 0.5) * (squares.x[5] - 0.5);
  }
  EXPECT_NEAR(x / draws, 0.5, 5 * std::sqrt(1.0 / 12 / draws));
  EXPECT_NEAR(y / draws, 0.5, 5 * std::sqrt(1.0 / 12 / draws));
  EXPECT_NEAR(xy / draws, 0, 5.0 / 12 / std::sqrt(draws));
  EXPECT_NEAR(apart / draws, 0, 5.0 / 12 / std::sqrt(draws));
}

// Packets hold the places of the rounds and no others, square k of sequence k % 8, and those of a packet lie together: a packet
// of a whole chunk has them in two cells of 64, one beside the other.
TEST(SortedRounds, keep_places_and_sequences_and_bring_neighbors_together) {
  const Scramble scramble(9);
  for (const auto& [from, to] :
       {std::pair(0u, 4u), std::pair(4u, 16u), std::pair(0u, 32u), std::pair(32u, 64u), std::pair(33u, 34u)}) {
    std::multiset<std::array<float, 3>> asked, got;
    for (std::uint32_t round = from; round < to; ++round) {
      const Squares squares = scramble.of_each(round);
      for (int k = 0; k < 16; ++k) asked.insert({static_cast<float>(k % 8), squares.x[k], squares.y[k]});
    }
    SortedRounds sorted;
    sorted.sort(scramble, from, to);
    EXPECT_EQ(sorted.packet_count(), to - from);
    for (std::uint32_t packet = 0; packet < sorted.packet_count(); ++packet) {
      const Squares& squares = sorted.squares(packet);
      for (int k = 0; k < 16; ++k) got.insert({static_cast<float>(k % 8), squares.x[k], squares.y[k]});
      if (to - from < 32) continue;
      const auto [left, right] = std::ranges::minmax(squares.x);
      const auto [low, high] = std::ranges::minmax(squares.y);
      EXPECT_EQ(std::floor(right * 4), std::floor(left * 4));
      EXPECT_EQ(std::floor(high * 8), std::floor(low * 8));
    }
    EXPECT_EQ(asked, got) << from << " .. " << to;
  }
}

// The concentric map keeps areas: of places spread evenly, a ring and a sector get their share.
TEST(PlacesOn, a_disc_is_filled_evenly) {
  const LightFigure face({.kind = DiscLight{{0, 2, 0}, {0, -1, 0}, 1}}, {}, up);
  const Scramble scramble(3);
  int inner = 0, quarter = 0;
  constexpr int groups = 256;
  for (std::uint32_t group = 0; group < groups; ++group) {
    const Squares squares = places_on(face, scramble.of_first(group));
    for (int k = 0; k < 16; ++k) {
      const glm::dvec2 place(2 * squares.x[k] - 1, 2 * squares.y[k] - 1);  // the box is the whole disc
      EXPECT_LE(glm::dot(place, place), 1 + 1e-6);
      inner += glm::dot(place, place) < 0.25;
      quarter += place.x > 0 && place.y > 0;
    }
  }
  EXPECT_NEAR(inner / (16.0 * groups), 0.25, 0.005);
  EXPECT_NEAR(quarter / (16.0 * groups), 0.25, 0.005);
}

}  // namespace gnomon::area_rays_test
