// What casters leave of a light with area, against closed forms and against scan lines without polygons.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::light_pieces_test {

using Caster = std::array<glm::dvec3, 3>;

const glm::dvec3 up(0, 0, 1);

/// The light of the test vector extra_lambert_square_light: 2 x 2 m, 2 m above the point.
Light square_light(Emits emits = Emits::on_both_sides) { return {.kind = RectLight{{0, 0, 2}, {1, 0, 0}, {0, 1, 0}, emits}}; }

LightShares seen(const Light& light, const std::vector<Caster>& casters, const glm::dvec3& point = {},
                 const glm::dvec3& normal = up) {
  const LightFigure face(light, point, normal);
  EXPECT_TRUE(face.is_seen());
  LightPieces pieces;
  pieces.start(face);
  for (const Caster& c : casters) pieces.subtract(c[0] - point, c[1] - point, c[2] - point);
  return pieces.shares();
}

/// Two triangles of a parallelogram.
std::vector<Caster> quad(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
  return {{corner, corner + u, corner + u + v}, {corner, corner + u + v, corner + v}};
}

/// All of x < 0 at the height z.
std::vector<Caster> half_plane(double z) { return quad({0, 50, z}, {-50, 0, 0}, {0, -100, 0}); }

void expect_shares(const LightShares& shares, double area, double irradiance, double tolerance = 1e-11) {
  EXPECT_NEAR(shares.area.best, area, tolerance);
  EXPECT_NEAR(shares.irradiance.best, irradiance, tolerance);
  EXPECT_LE(shares.area.low, shares.area.best + 1e-15);
  EXPECT_LE(shares.area.best, shares.area.high + 1e-15);
  EXPECT_LE(shares.irradiance.low, shares.irradiance.best + 1e-15);
  EXPECT_LE(shares.irradiance.best, shares.irradiance.high + 1e-15);
}

TEST(LightPieces, nothing_between_leaves_all_and_a_wall_leaves_nothing) {
  for (const LightKind& kind : {LightKind(RectLight{{0, 0, 2}, {1, 0, 0}, {0, 1, 0}}),
                                LightKind(DiscLight{{0, 0, 2}, {0, 0, -1}, 1}), LightKind(SphereLight{{0, 0, 2}, 1})}) {
    expect_shares(seen({.kind = kind}, {}), 1, 1, 0);
    expect_shares(seen({.kind = kind}, quad({-9, -9, 0.5}, {18, 0, 0}, {0, 18, 0})), 0, 0, 0);
    expect_shares(seen({.kind = kind}, quad({-9, -9, 3.5}, {18, 0, 0}, {0, 18, 0})), 1, 1, 0);   // beyond the light
    expect_shares(seen({.kind = kind}, quad({-9, -9, -0.5}, {18, 0, 0}, {0, 18, 0})), 1, 1, 0);  // below the point
  }
}

// Vector extra_lambert_area_vs_irradiance: from (3, 0, 0) the near half gives 0.7119... of the irradiance.
TEST(LightPieces, area_and_irradiance_of_half_a_square_are_those_of_the_vectors) {
  expect_shares(seen(square_light(), half_plane(2 - 1e-9)), 0.5, 0.5, 1e-8);
  expect_shares(seen(square_light(), half_plane(2 - 1e-9), {3, 0, 0}), 0.5, 0.711956869845, 1e-8);
}

// A half plane at the height z = 1 with its border above x = b cuts the light, seen from (0, 0, 0), at x = 2 b. Of a disc of
// radius 1 it leaves the segment x > 2 b.
TEST(LightPieces, a_half_plane_cuts_a_segment_off_a_disc) {
  const Light disc{.kind = DiscLight{{0, 0, 2}, {0, 0, 1}, 1}};
  for (const double border : {-0.45, -0.2, 0.0, 0.1, 0.37}) {
    const double x = 2 * border, kept = (std::acos(x) - x * std::sqrt(1 - x * x)) / std::numbers::pi;
    const LightShares shares = seen(disc, quad({border, 50, 1}, {-50, 0, 0}, {0, -100, 0}));
    EXPECT_NEAR(shares.area.best, kept, 3e-6) << border;
    EXPECT_LE(shares.area.low, kept);
    EXPECT_GE(shares.area.high, kept);
    EXPECT_LT(shares.area.high - shares.area.low, 0.002);
  }
}

// A square of half side 0.25 at half the height covers the middle quarter of the light: area 1/4. Irradiance by the square's
// own form factor: with a = h / d, F = 4 / (2 pi) * 2 a / sqrt(1 + a^2) * atan(a / sqrt(1 + a^2)), at a = 1/4 and a = 1/2.
TEST(LightPieces, a_square_before_a_square) {
  const auto form_factor = [](double a) {
    const double root = std::sqrt(1 + a * a);
    return 4 / std::numbers::pi * a / root * std::atan(a / root);
  };
  expect_shares(seen(square_light(), quad({-0.25, -0.25, 1}, {0.5, 0, 0}, {0, 0.5, 0})), 0.75,
                1 - form_factor(0.25) / form_factor(0.5));
}

TEST(LightPieces, casters_that_overlap_count_once_and_others_add_up) {
  const auto left = quad({-0.5, -0.5, 1}, {0.5, 0, 0}, {0, 1, 0});            // covers x < 0
  const auto middle = quad({-0.125, -0.25, 0.5}, {0.25, 0, 0}, {0, 0.5, 0});  // covers |x| < 0.5
  const auto right = quad({0.25, -0.5, 1}, {0.25, 0, 0}, {0, 1, 0});          // covers x > 0.5
  const auto both = [](std::vector<Caster> a, const std::vector<Caster>& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
  };
  EXPECT_NEAR(seen(square_light(), both(left, middle)).area.best, 0.25, 1e-12);
  EXPECT_NEAR(seen(square_light(), both(left, right)).area.best, 0.25, 1e-12);
  EXPECT_NEAR(seen(square_light(), both(middle, both(left, left))).area.best, 0.25, 1e-12);
  EXPECT_NEAR(seen(square_light(), both(both(left, right), middle)).area.best, 0, 1e-12);
}

// A light on edge to the floor, half of it below: the share is that of the upper half, z in 0 .. 1. A wall that covers x < 0
// takes half of it, and one below the horizon nothing.
TEST(LightPieces, what_is_below_the_horizon_counts_neither_way) {
  const Light light{.kind = RectLight{{0, 3, 0}, {1, 0, 0}, {0, 0, 1}}};
  expect_shares(seen(light, quad({0, 1, -9}, {-9, 0, 0}, {0, 0, 18})), 0.5, 0.5);
  expect_shares(seen(light, quad({-9, 1, -9}, {18, 0, 0}, {0, 0, 9})), 1, 1);
  EXPECT_NEAR(seen(light, quad({-9, 1, 0.2}, {18, 0, 0}, {0, 0, 9})).area.best, 0.6, 1e-12);
}

// From 2 m above the center of a sphere of radius 1 the tangents touch it in a circle of radius sqrt(3) / 2, 1.5 m away; a half
// plane at 0.75 m cuts it at twice its border.
TEST(LightPieces, a_sphere_is_the_disc_of_its_tangents) {
  const Light sphere{.kind = SphereLight{{0, 0, 2}, 1}};
  const LightFigure face(sphere, {}, up);
  EXPECT_NEAR(face.center().z, 1.5, 1e-15);
  EXPECT_NEAR(glm::length(face.half_u()), std::sqrt(3) / 2, 1e-15);
  const double x = 0.4 / (std::sqrt(3) / 2), kept = (std::acos(x) - x * std::sqrt(1 - x * x)) / std::numbers::pi;
  EXPECT_NEAR(seen(sphere, quad({0.2, 50, 0.75}, {-50, 0, 0}, {0, -100, 0})).area.best, kept, 3e-6);
}

TEST(LightFigure, what_cannot_be_seen) {
  const auto is_seen = [](const Light& light, const glm::dvec3& point, const glm::dvec3& normal = up) {
    return LightFigure(light, point, normal).is_seen();
  };
  EXPECT_FALSE(is_seen(square_light(), {0, 0, 3}));                            // below the horizon
  EXPECT_FALSE(is_seen(square_light(), {5, 0, 2}, {-1, 0, 0}));                // in its plane
  EXPECT_TRUE(is_seen(square_light(), {0, 0, 3}, {0, 0, -1}));                 // emits on both sides
  EXPECT_TRUE(is_seen(square_light(Emits::in_front), {0, 0, 3}, {0, 0, -1}));  // on the side of cross(half_u, half_v)
  EXPECT_FALSE(is_seen(square_light(Emits::in_front), {0, 0, 0}));
  const Light disc{.kind = DiscLight{{0, 0, 2}, {0, 0, -1}, 1, Emits::in_front}};
  EXPECT_TRUE(is_seen(disc, {0, 0, 0}));
  EXPECT_FALSE(is_seen(disc, {0, 0, 3}, {0, 0, -1}));
  EXPECT_FALSE(is_seen({.kind = SphereLight{{0, 0, 2}, 1}}, {0, 0, 1.5}));  // inside
}

// Straight above it is 1. A light at the height 1 whose nearest border is at the distance 3: 1 / sqrt(10); of a disc its
// nearest point.
TEST(LightFigure, its_highest_place) {
  const auto highest = [](const Light& light, const glm::dvec3& point) { return LightFigure(light, point, up).highest(); };
  EXPECT_EQ(highest(square_light(), {0.3, -0.9, 1}), 1);
  EXPECT_NEAR(highest(square_light(), {4, 0.2, 1}), 1 / std::sqrt(10), 1e-12);
  EXPECT_NEAR(highest({.kind = DiscLight{{0, 0, 2}, {0, 0, 1}, 1}}, {4, 0, 1}), 1 / std::sqrt(10), 1e-4);
}

/// The share of a light that casters leave, by 4,000 scan lines: on each the covered parts are intervals.
double scanned_area(const LightFigure& face, const std::vector<Caster>& casters) {
  constexpr int line_count = 4000;
  double seen = 0, all = 0;
  for (int line = 0; line < line_count; ++line) {
    const double t = -1 + (2 * line + 1.0) / line_count;
    const double reach = face.is_disc() ? std::sqrt(1 - t * t) : 1;
    // Where f(s) = f0 + f1 s > 0 for all of several f: the interval low .. high.
    struct Interval {
      double low, high;
      void keep(double f0, double f1) {
        if (f1 > 0) low = std::max(low, -f0 / f1);
        if (f1 < 0) high = std::min(high, -f0 / f1);
        if (f1 == 0 && f0 <= 0) high = low;
      }
    };
    Interval whole{-reach, reach};
    whole.keep(face.horizon().x + face.horizon().z * t, face.horizon().y);
    if (whole.high <= whole.low) continue;
    const glm::dvec3 start = face.at({0, t}), way = face.half_u();
    std::vector<Interval> covered;
    for (const Caster& c : casters) {
      // The ray to a place meets the triangle between its ends: three signs for the cone, one for the plane between.
      const double turn = glm::dot(glm::cross(c[0], c[1]), c[2]);
      Interval part = whole;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 side = glm::cross(c[k], c[(k + 1) % 3]) * turn;
        part.keep(glm::dot(side, start), glm::dot(side, way));
      }
      const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
      const double from = glm::dot(normal, c[0]);  // the point lies at -from of the plane, the place must lie beyond
      const double sign = from > 0 ? 1 : -1;
      part.keep(sign * (glm::dot(normal, start) - from), sign * glm::dot(normal, way));
      if (part.high > part.low) covered.push_back(part);
    }
    std::ranges::sort(covered, {}, &Interval::low);
    double dark = 0, end = whole.low;
    for (const Interval& part : covered) {
      dark += std::max(0.0, part.high - std::max(part.low, end));
      end = std::max(end, part.high);
    }
    seen += whole.high - whole.low - dark;
    all += whole.high - whole.low;
  }
  return seen / all;
}

// Casters of every kind of place: across the light's plane, the horizon, the point's own level, slivers.
TEST(LightPieces, agree_with_scan_lines_over_random_casters) {
  Random random(16);
  double largest = 0;
  for (int round = 0; round < 60; ++round) {
    const auto around = [&](double size) { return random.uniform(glm::dvec3(-size), glm::dvec3(size)); };
    Light light;
    const glm::vec3 center(around(1) + glm::dvec3(0, 0, 1.2));
    if (round % 3 == 0) light.kind = RectLight{center, glm::vec3(around(1)), glm::vec3(around(1))};
    if (round % 3 == 1) light.kind = DiscLight{center, glm::vec3(around(1)), 0.8f};
    if (round % 3 == 2) light.kind = SphereLight{center, 0.3f};
    const LightFigure face(light, {}, up);
    if (!face.is_seen()) continue;
    std::vector<Caster> casters;
    for (int k = 0; k < 2 + round; ++k) {
      const glm::dvec3 place = around(1) + glm::dvec3(0, 0, 0.5);
      const double size = k % 7 == 0 ? 2 : 0.3;
      casters.push_back({place, place + around(size), place + around(k % 5 == 0 ? size / 100 : size)});
    }
    LightPieces pieces;
    pieces.start(face);
    for (const Caster& c : casters) pieces.subtract(c[0], c[1], c[2]);
    const double scanned = scanned_area(face, casters), error = std::abs(pieces.shares().area.best - scanned);
    EXPECT_LT(error, face.is_disc() ? 3e-4 : 5e-5) << "round " << round << ", " << pieces.shares().area.best << ", " << scanned;
    largest = std::max(largest, error);
  }
  RecordProperty("largest", std::to_string(largest));
}

}  // namespace gnomon::light_pieces_test
