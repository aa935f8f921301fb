// Points of a light that everybody shares, and what they count.
#include <gnomon/error.h>
#include <gnomon/kit/area/light_points.h>
#include <gtest/gtest.h>

#include <cmath>

namespace light_points_test {
using namespace gnomon;

const Light rect{.name = "rect", .kind = RectLight{{1, 4, 2}, {0.5f, 0, 0.1f}, {0, 0.2f, 0.7f}}};
const Light disc{.name = "disc", .kind = DiscLight{{1, 4, 2}, {0.3f, -1, 0.2f}, 0.8f}};
const Light globe{.name = "globe", .kind = SphereLight{{1, 4, 2}, 0.8f}};

TEST(light_points, points_lie_on_the_light_in_every_pattern) {
  for (const std::string_view pattern : pattern_names()) {
    for (const glm::vec3& p : light_points(rect, pattern, 100, 3)) {
      const auto& r = std::get<RectLight>(rect.kind);
      const glm::dvec3 u = r.half_u, v = r.half_v, off = glm::dvec3(p) - glm::dvec3(r.center);
      // Of off = s u + t v, by Cramer's rule.
      const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), det = uu * vv - uv * uv;
      const double s = (glm::dot(off, u) * vv - glm::dot(off, v) * uv) / det,
                   t = (glm::dot(off, v) * uu - glm::dot(off, u) * uv) / det;
      EXPECT_LE(std::max(std::abs(s), std::abs(t)), 1 + 1e-6) << pattern;
      EXPECT_LT(glm::length(off - s * u - t * v), 1e-6) << pattern;
    }
    for (const glm::vec3& p : light_points(disc, pattern, 100, 3)) {
      const auto& d = std::get<DiscLight>(disc.kind);
      EXPECT_LE(glm::distance(p, d.center), d.radius * (1 + 1e-6)) << pattern;
      EXPECT_LT(std::abs(glm::dot(p - d.center, glm::normalize(d.normal))), 1e-6) << pattern;
    }
    for (const glm::vec3& p : light_points(globe, pattern, 100, 3))
      EXPECT_NEAR(glm::distance(p, {1, 4, 2}), 0.8, 1e-6) << pattern;
  }
}

// Of points that fill the light evenly the mean is its center, to the size over the square root of their number.
TEST(light_points, points_fill_the_light) {
  for (const Light& light : {rect, disc, globe})
    for (const std::string_view pattern : pattern_names()) {
      glm::dvec3 mean(0);
      const auto points = light_points(light, pattern, 1000, 7);
      ASSERT_EQ(points.size(), 1000u);
      for (const glm::vec3& p : points) mean += glm::dvec3(p) / 1000.0;
      EXPECT_LT(glm::distance(mean, {1, 4, 2}), 0.08) << light.name << ' ' << pattern;
    }
}

TEST(light_points, a_seed_gives_the_same_points_again_and_another_one_others) {
  for (const std::string_view pattern : pattern_names()) {
    EXPECT_EQ(light_points(disc, pattern, 20, 5), light_points(disc, pattern, 20, 5)) << pattern;
    EXPECT_NE(light_points(disc, pattern, 20, 5), light_points(disc, pattern, 20, 6)) << pattern;
  }
}

TEST(light_points, a_light_of_no_size_to_speak_of_is_its_center) {
  for (const LightKind& kind : {LightKind(RectLight{{1, 4, 2}, {1e-20f, 0, 0}, {0, 0, 1e-20f}}),
                                LightKind(DiscLight{{1, 4, 2}, {0, -1, 0}, 1e-20f}), LightKind(SphereLight{{1, 4, 2}, 1e-20f})})
    for (const glm::vec3& p : light_points({.name = "dot", .kind = kind}, "random", 40, 1)) EXPECT_EQ(p, glm::vec3(1, 4, 2));
  const Light point{.name = "point", .kind = PointLight{}};
  EXPECT_THROW(light_points(point, "random", 4, 1), gnomon::Error);
}

TEST(light_points, points_below_the_horizon_or_behind_the_light_count_nothing) {
  const glm::dvec3 wall_normal(1, 0, 0);
  const PointWeights from_wall(rect, {1, 1, 2}, wall_normal);  // a wall through the light's middle
  EXPECT_TRUE(from_wall.is_seen());
  EXPECT_EQ(from_wall.at({1.2f, 4, 2}), 1);
  EXPECT_EQ(from_wall.at({0.8f, 4, 2}), 0);
  const Light front{.name = "front", .kind = RectLight{{0, 4, 0}, {1, 0, 0}, {0, 0, 1}, Emits::in_front}};  // faces down
  EXPECT_TRUE(PointWeights(front, {0, 0, 0}, {0, 1, 0}).is_seen());
  EXPECT_FALSE(PointWeights(front, {0, 5, 0}, {0, -1, 0}).is_seen());
  EXPECT_EQ(PointWeights(front, {0, 5, 0}, {0, -1, 0}).at({0, 4, 0}), 0);
  EXPECT_FALSE(PointWeights(globe, {1, 4.1, 2}, {0, 1, 0}).is_seen()) << "inside the sphere";
}

// The disc that is seen of a sphere is cut by the horizon through its center in half, and by one that leaves s > h of the unit
// disc in (acos h - h sqrt(1 - h^2)) / pi. Points on the surface stand for it by their weights.
TEST(light_points, weights_of_a_sphere_measure_the_disc_that_is_seen) {
  const Light ball{.name = "ball", .kind = SphereLight{{0, 0, 3}, 1}};
  const auto points = light_points(ball, "low_discrepancy", 1 << 16, 1);
  const PointWeights weights(ball, {0, 0, 0}, {0, 0, 1});
  // The disc's radius is r sqrt(1 - r^2 / d^2), its distance d - r^2 / d.
  const double distance = 3 - 1.0 / 3, radius = std::sqrt(1 - 1.0 / 9);
  for (const double h : {0.0, 0.3, 0.7}) {
    double all = 0, beyond = 0;
    for (const glm::vec3& p : points) {
      const double weight = weights.at(p);
      all += weight;
      if (p.x / p.z * distance / radius > h) beyond += weight;
    }
    EXPECT_NEAR(beyond / all, (std::acos(h) - h * std::sqrt(1 - h * h)) / 3.14159265358979, 2e-3) << h;
  }
}

// A rectangle's points are those that area_rays samples: the square's share of both sides.
TEST(light_points, points_of_a_rectangle_are_places_of_its_square) {
  const auto& r = std::get<RectLight>(rect.kind);
  for (const std::string_view pattern : pattern_names()) {
    PatternPlaces places(pattern, 32, places_seed(9, 4));
    const auto points = light_points(rect, pattern, 32, places_seed(9, 4));
    for (std::uint32_t group = 0; group < 2; ++group) {
      const Squares squares = places.next(group);
      for (int k = 0; k < 16; ++k) {
        const glm::dvec3 place = glm::dvec3(r.center) + (2.0 * squares.x[k] - 1) * glm::dvec3(r.half_u) +
                                 (2.0 * squares.y[k] - 1) * glm::dvec3(r.half_v);
        EXPECT_LT(glm::distance(glm::dvec3(points[16 * group + static_cast<std::uint32_t>(k)]), place), 1e-6) << pattern;
      }
    }
  }
}

}  // namespace light_points_test
