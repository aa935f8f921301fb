// Rays and exact curved shapes, in double, against closed forms and against marching in small steps.
#include "kit/rays/shape_rays.h"

#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <cmath>

namespace shape_rays_test {

using namespace gnomon;

glm::dvec3 point(Random& random, double half) { return random.uniform(glm::dvec3(-half), glm::dvec3(half)); }

/// A unit vector.
glm::dvec3 direction_of(Random& random) {
  for (;;)
    if (const glm::dvec3 p = point(random, 1); glm::length(p) > 0.1) return glm::normalize(p);
}

TEST(first_hit, sphere_is_met_at_both_roots) {
  // Unit sphere at the origin, ray along +x from x = -3, two units a step: in at t = 1, out at t = 2.
  const Sphere sphere;
  const ShapeHit in = first_hit(sphere, {-3, 0, 0}, {2, 0, 0}, 0, INFINITY);
  ASSERT_TRUE(in.found);
  EXPECT_DOUBLE_EQ(in.t, 1);
  EXPECT_EQ(in.normal, glm::dvec3(-1, 0, 0));
  EXPECT_DOUBLE_EQ(first_hit(sphere, {-3, 0, 0}, {2, 0, 0}, 1.5, INFINITY).t, 2);
  EXPECT_DOUBLE_EQ(first_hit(sphere, {0, 0, 0}, {0, 0, 5}, 0, INFINITY).t, 0.2);
  EXPECT_FALSE(first_hit(sphere, {-3, 0, 0}, {2, 0, 0}, 0, 0.99).found);
  EXPECT_FALSE(first_hit(sphere, {-3, 0, 0}, {-2, 0, 0}, 0, INFINITY).found);
  EXPECT_FALSE(first_hit(sphere, {-3, 1.0001, 0}, {2, 0, 0}, 0, INFINITY).found);
}

TEST(first_hit, sphere_far_away_loses_no_digits) {
  // Center 1e6 off, radius 1: the textbook discriminant b^2 - ac would carry errors of 1e12 * 2^-53, 1e-4 in t.
  const Sphere sphere{.center = {1e6f, 0, 0}};
  const ShapeHit hit = first_hit(sphere, {0, 0.6, 0}, {1, 0, 0}, 0, INFINITY);
  ASSERT_TRUE(hit.found);
  EXPECT_NEAR(hit.t, 1e6 - 0.8, 1e-9);  // half chord: sqrt(1 - 0.36) = 0.8
}

TEST(first_hit, cone_side_base_and_peak) {
  // Base radius 1 at y = 0, peak at y = 2. At height 1 the radius is 1/2, the outward normal (2, 1)/sqrt(5) in the plane.
  const Cone cone{.height = 2};
  const ShapeHit side = first_hit(cone, {-4, 1, 0}, {1, 0, 0}, 0, INFINITY);
  ASSERT_TRUE(side.found);
  EXPECT_DOUBLE_EQ(side.t, 3.5);
  EXPECT_NEAR(glm::distance(side.normal, glm::dvec3(-2, 1, 0) / std::sqrt(5.0)), 0, 1e-14);
  EXPECT_DOUBLE_EQ(first_hit(cone, {-4, 1, 0}, {1, 0, 0}, 3.6, INFINITY).t, 4.5);
  const ShapeHit base = first_hit(cone, {0.25, -1, 0.5}, {0, 1, 0}, 0, INFINITY);
  ASSERT_TRUE(base.found);
  EXPECT_DOUBLE_EQ(base.t, 1);
  EXPECT_EQ(base.normal, glm::dvec3(0, -1, 0));
  const ShapeHit peak = first_hit(cone, {0, 5, 0}, {0, -1, 0}, 0, INFINITY);
  ASSERT_TRUE(peak.found);
  EXPECT_NEAR(peak.t, 3, 1e-7);
  // Above the peak the equation has a second cone, upside down, that is not there.
  EXPECT_FALSE(first_hit(cone, {-4, 3, 0}, {1, 0, 0}, 0, INFINITY).found);
  EXPECT_FALSE(first_hit(cone, {-4, -0.1, 0}, {1, 0, 0}, 0, INFINITY).found);
  // Along a generator: the leading coefficient vanishes.
  EXPECT_TRUE(first_hit(cone, {-0.6, 0, 0}, {1, 2, 0}, 0, INFINITY).found);
}

TEST(first_hit, disc_within_its_radius_from_both_sides) {
  const Disc disc{.center = {0, 1, 0}, .normal = {0, 3, 0}, .radius = 2};
  const ShapeHit hit = first_hit(disc, {1.9, 4, 0}, {0, -1, 0}, 0, INFINITY);
  ASSERT_TRUE(hit.found);
  EXPECT_DOUBLE_EQ(hit.t, 3);
  EXPECT_EQ(hit.normal, glm::dvec3(0, 1, 0));
  EXPECT_TRUE(first_hit(disc, {1.9, -4, 0}, {0, 1, 0}, 0, INFINITY).found);
  EXPECT_FALSE(first_hit(disc, {2.1, 4, 0}, {0, -1, 0}, 0, INFINITY).found);
  EXPECT_FALSE(first_hit(disc, {-4, 1, 0}, {1, 0, 0}, 0, INFINITY).found) << "edge-on";
}

/// Signed distance-like function of a solid: negative inside. A sphere's and a cone's inside is where all terms are.
double outside(const Shape& shape, const glm::dvec3& p) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return glm::distance(p, glm::dvec3(sphere->center)) - sphere->radius;
  const auto& cone = std::get<Cone>(shape);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), x = p - glm::dvec3(cone.base);
  const double along = glm::dot(x, axis), off = glm::length(x - along * axis);
  return std::max({-along, along - cone.height, off - cone.radius * (1 - along / cone.height)});
}

TEST(first_hit, random_rays_agree_with_marching_through_the_solid) {
  // March each ray in small steps: the first change of side is where first_hit must be, within a step. Rays whose nearest
  // approach is within 0.01 of the surface may slip through between two steps and are left out.
  Random random(7);
  constexpr double step = 0.002;
  int hits = 0;
  for (int i = 0; i < 1500; ++i) {
    const Shape shape = i % 2 ? Shape(Sphere{glm::vec3(point(random, 1)), float(random.uniform(0.3, 1.5))})
                              : Shape(Cone{glm::vec3(point(random, 1)), glm::vec3(direction_of(random) * 3.0),
                                           float(random.uniform(0.3, 1.5)), float(random.uniform(0.5, 2))});
    const glm::dvec3 origin = point(random, 3), direction = glm::normalize(point(random, 1.5) - origin);
    const bool starts_inside = outside(shape, origin) < 0;
    EXPECT_EQ(contains(shape, origin), starts_inside);
    double crossing = INFINITY, nearest = INFINITY;
    for (double t = 0; t < 12 && crossing == INFINITY; t += step) {
      const double d = outside(shape, origin + t * direction);
      nearest = std::min(nearest, d);
      if ((d < 0) != starts_inside) crossing = t;
    }
    const ShapeHit hit = first_hit(shape, origin, direction, 0, INFINITY);
    if (crossing == INFINITY && nearest < 0.01) continue;
    ASSERT_EQ(hit.found, crossing != INFINITY) << i;
    if (!hit.found) continue;
    ++hits;
    // A thin corner between two steps may hide an earlier crossing; then the hit is earlier, and on the surface all the same.
    EXPECT_LT(hit.t, crossing + 1e-9) << i;
    EXPECT_NEAR(outside(shape, origin + hit.t * direction), 0, 1e-9) << i;
    EXPECT_NEAR(glm::length(hit.normal), 1, 1e-12);
    EXPECT_GE(starts_inside ? glm::dot(hit.normal, direction) : -glm::dot(hit.normal, direction), -1e-9) << "outward";
  }
  EXPECT_GT(hits, 200);
}

TEST(shape_bounds, hold_the_shape_and_little_more) {
  Random random(8);
  for (int i = 0; i < 40; ++i) {
    const glm::vec3 center(point(random, 100)), axis(direction_of(random));
    const float radius = float(random.uniform(0.01, 10)), height = float(random.uniform(0.01, 10));
    for (const Shape& shape :
         {Shape(Sphere{center, radius}), Shape(Disc{center, axis, radius}), Shape(Cone{center, axis, radius, height})}) {
      const Bounds box = shape_bounds(shape);
      // Inscribed vertices: inside the box, and within the sag of 256 segments of every side of it.
      Bounds vertices;
      for (const glm::vec3& p : tessellate(shape, 256, "s").positions) vertices.add(p);
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(box.min[k], vertices.min[k]);
        EXPECT_GE(box.max[k], vertices.max[k]);
        EXPECT_NEAR(box.min[k], vertices.min[k], 2e-3 * radius + 1e-4);
        EXPECT_NEAR(box.max[k], vertices.max[k], 2e-3 * radius + 1e-4);
      }
    }
  }
}

}  // namespace shape_rays_test
