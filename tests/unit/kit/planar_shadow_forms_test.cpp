// The paper's formulas as printed and as meant: where they hold, what they miss, and what is said where they do not apply.
#include <gtest/gtest.h>

#include <numbers>

#include "planar_conic.h"
#include "planar_questions.h"

namespace planar_shadow_forms_test {
using namespace gnomon;
using namespace planar_questions;
using planar_brute::Answer;
using planar_conic::Conic;

constexpr double pi = std::numbers::pi;
const glm::dvec4 ground(0, 1, 0, 0);

/// A shape that the paper has, over the ground at most 3 high, and a light above all of it; one in six is at infinity.
/// Places are in steps of 2^-10, so that float32 holds them, sums of them and what they move to by whole numbers.
Question paper_question(Random& random) {
  const auto number = [&](double low, double high) {
    return static_cast<float>(std::round(random.uniform(low, high) * 1024) / 1024);
  };
  const float size = number(0.2, 1);
  const glm::vec3 at(number(-2, 2), number(0, 1), number(-2, 2));
  Question q{Disc{at, {0, 1, 0}, size}, {random.uniform(glm::dvec3(-6, 3.5, -6), glm::dvec3(6, 9, 6)), 1}, ground};
  if (random.below(6) == 0) q.light.w = 0;
  switch (random.below(4)) {
    case 0:
      return q;
    case 1:
      q.shape = Sphere{at + glm::vec3(0, size, 0), size};
      return q;
    case 2:
      q.shape = Cone{at, {0, 2, 0}, size, number(0.2, 2)};
      return q;
    default:
      break;
  }
  // The base in any direction along the ground, its corners level.
  const glm::vec3 half(size, 0, number(-1, 1));
  q.shape = Triangle{{at - half, at + half, at + glm::vec3(0, number(0.2, 2), 0)}};
  return q;
}

// Discs and triangles: the paper is right. Spheres and cones: it shades nothing that is lit, and misses something.
TEST(PlanarShadowForms, paper_is_right_for_flat_shapes_and_a_part_of_the_truth_for_solids) {
  Random random(1);
  int missing = 0, dark = 0;
  for (int i = 0; i < 2000; ++i) {
    const Question q = paper_question(random);
    SCOPED_TRACE(print(q));
    ASSERT_EQ(PlanarShadow::objection(q.shape, q.light, q.plane, ShadowForm::paper), "");
    ASSERT_EQ(PlanarShadow::objection(q.shape, q.light, q.plane, ShadowForm::printed), "");
    const PlanarShadow paper(q.shape, q.light, q.plane, ShadowForm::paper);
    const bool is_flat = std::holds_alternative<Disc>(q.shape) || std::holds_alternative<Triangle>(q.shape);
    const Ball ball = ball_around(q.shape);
    for (int k = 0; k < 40; ++k) {
      const glm::dvec3 point = random_point(random, q, ball);
      const Answer truth = planar_brute::answer(q.shape, q.light, point);
      if (truth == Answer::unsure) continue;
      dark += truth == Answer::dark;
      missing += truth == Answer::dark && !paper.contains(point);
      if (is_flat)
        ASSERT_EQ(paper.contains(point), truth == Answer::dark);
      else
        ASSERT_FALSE(paper.contains(point) && truth == Answer::lit);
    }
    for (const auto& loop : paper.outlines(24)) ASSERT_GE(planar_conic::area(loop), 0);
  }
  EXPECT_GT(dark, 10000);
  EXPECT_GT(missing, dark / 50);
}

// With h = y_i - d and K = h^2 - r^2 the ellipse has semi-axes y_i r sqrt(x_i^2 + K) / K and y_i r / sqrt K, the circle the
// radius r y_i / h: their areas are as K^1.5 / (h^2 sqrt(x_i^2 + K)) to 1. x_i is the light's distance from the vertical
// through the center, in any direction.
TEST(PlanarShadowForms, area_of_the_papers_circle_to_that_of_the_ellipse_is_the_closed_form) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const double r = static_cast<float>(random.uniform(0.1, 1)), d = static_cast<float>(r + random.uniform(0, 2));
    const Sphere sphere{{static_cast<float>(random.uniform(-2, 2)), static_cast<float>(d), 0.5f}, static_cast<float>(r)};
    const glm::dvec4 light(random.uniform(-5, 5), d + r + random.uniform(0.1, 5), random.uniform(-5, 5), 1);
    const double x_i = std::hypot(light.x - sphere.center.x, light.z - 0.5), h = light.y - d, k = h * h - r * r;
    const double closed = std::pow(k, 1.5) / (h * h * std::sqrt(x_i * x_i + k));
    const PlanarShadow paper(sphere, light, ground, ShadowForm::paper), exact(sphere, light, ground);
    ASSERT_EQ(paper.parts().size(), 1u);
    const double radius = paper.parts()[0].radius(), ellipse = Conic(exact.tests()[0]).area();
    ASSERT_NEAR(pi * radius * radius / ellipse, closed, 1e-9 * closed);
    // 1024 points inscribed miss the share (2 pi / 1024)^2 / 6 of a circle; the ellipse's are spread unevenly.
    ASSERT_NEAR(planar_conic::area(paper.outlines(1024)[0]), pi * radius * radius, 7e-6 * radius * radius * pi);
    ASSERT_NEAR(planar_conic::area(exact.outlines(1024)[0]), ellipse, 1e-3 * ellipse);
    ASSERT_LT(planar_conic::area(exact.outlines(1024)[0]), ellipse);
  }
}

// The image of the base has radius r_1, the peak's is c from its center. For c > r_1 the tangents touch at k = r_1 / c, and the
// hull has the area pi r_1^2 + r_1 c sqrt(1 - k^2) - r_1^2 acos k; else it is the circle. The paper's triangle stands on the
// diameter: it meets the circle again at the angle 2 atan(c / r_1) - pi / 2, so that the union has the area pi r_1^2 + r_1 c -
// r_1^2 (cos + angle).
TEST(PlanarShadowForms, areas_of_cones_are_the_closed_forms) {
  Random random(3);
  int circles = 0;
  for (int i = 0; i < 200; ++i) {
    const auto number = [&](double low, double high) { return static_cast<float>(random.uniform(low, high)); };
    const Cone cone{{number(-1, 1), number(0.1, 2), 0.25f}, {0, 1, 0}, number(0.2, 1), number(0.2, 2)};
    const double d = cone.base.y, r = cone.radius, top = d + cone.height;
    const glm::dvec4 light(random.uniform(-5, 5), top + random.uniform(0.2, 5), random.uniform(-5, 5), 1);
    const double x_i = std::hypot(light.x - cone.base.x, light.z - 0.25);
    const double r_1 = r * light.y / (light.y - d), c = x_i * (top / (light.y - top) - d / (light.y - d)), k = r_1 / c;
    const bool is_circle = c <= r_1;
    circles += is_circle;
    const double hull = is_circle ? pi * r_1 * r_1 : pi * r_1 * r_1 + r_1 * c * std::sqrt(1 - k * k) - r_1 * r_1 * std::acos(k);
    const PlanarShadow exact(cone, light, ground);
    EXPECT_EQ(exact.parts().size(), is_circle ? 1u : 2u);
    ASSERT_NEAR(planar_conic::area(exact.outlines(1024)[0]), hull, 7e-6 * hull);
    const PlanarShadow paper(cone, light, ground, ShadowForm::paper);
    ASSERT_EQ(paper.parts().size(), 2u);
    ASSERT_NEAR(paper.parts()[0].radius(), r_1, 1e-12 * r_1);
    const auto loops = paper.outlines(1024);
    ASSERT_NEAR(planar_conic::area(loops[1]), r_1 * c, 1e-12 * (1 + r_1 * c));
  }
  EXPECT_GT(circles, 30);
}

// Any planar receiver by a change of frame: the same shapes over the wall x = -4, whose normal is +x, with x, y, z turned
// into z, x, y and everything moved by whole numbers, which is exact in float32.
TEST(PlanarShadowForms, other_planes_are_a_change_of_frame) {
  Random random(4);
  const auto moved = [](const auto& p) { return std::decay_t<decltype(p)>(p.y - 4, p.z + 2, p.x + 1); };
  const auto turned = [](const glm::vec3& v) { return glm::vec3(v.y, v.z, v.x); };
  for (int i = 0; i < 2000; ++i) {
    const Question q = paper_question(random);
    Shape there = q.shape;
    if (const auto* s = std::get_if<Sphere>(&q.shape)) there = Sphere{moved(s->center), s->radius};
    if (const auto* s = std::get_if<Disc>(&q.shape)) there = Disc{moved(s->center), turned(s->normal), s->radius};
    if (const auto* s = std::get_if<Cone>(&q.shape)) there = Cone{moved(s->base), turned(s->axis), s->radius, s->height};
    if (const auto* s = std::get_if<Triangle>(&q.shape))
      there = Triangle{{moved(s->points[0]), moved(s->points[1]), moved(s->points[2])}};
    glm::dvec3 light = moved(glm::dvec3(q.light));
    if (q.light.w == 0) light = {q.light.y, q.light.z, q.light.x};
    for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper, ShadowForm::exact}) {
      const PlanarShadow here(q.shape, q.light, ground, form), wall(there, {light, q.light.w}, {1, 0, 0, 4}, form);
      ASSERT_EQ(here.parts().size(), wall.parts().size());
      for (int k = 0; k < 20; ++k) {
        const glm::dvec3 point = random.uniform(glm::dvec3(-6, 0, -6), glm::dvec3(6, 0, 6));
        ASSERT_EQ(here.contains(point), wall.contains(moved(point))) << print(q);
      }
    }
  }
}

// The base along Z, as printed, stays at x = 0; along X it moves with x_s; in between, what x_s has along the base stays. The
// ground under the base's middle is the origin here. a = 2, h_p = 3, d = 1, light at (4, 10, 3): y_i - d = 9, a_1 = 20 / 9,
// x_s = -4 / 9, z_s = -3 / 9, peak at (4, 3) * 4 / (4 - 10).
TEST(PlanarShadowForms, printed_triangle_leaves_its_base_behind) {
  const glm::dvec4 light(4, 10, 3, 1);
  const auto base = [&](const glm::vec3& half, ShadowForm form) {
    const PlanarShadow shadow(Triangle{{glm::vec3(0, 1, 0) - half, glm::vec3(0, 1, 0) + half, {0, 4, 0}}}, light, ground, form);
    EXPECT_EQ(shadow.parts().size(), 1u);
    const auto& p = shadow.parts()[0].points;
    EXPECT_NEAR(glm::distance(p[2], {-8.0 / 3, 0, -2}), 0, 1e-12);
    EXPECT_NEAR(glm::distance(p[0], p[1]), 2 * glm::length(glm::dvec3(half)) * 10 / 9, 1e-12);
    return 0.5 * (p[0] + p[1]);
  };
  EXPECT_NEAR(glm::distance(base({1, 0, 0}, ShadowForm::printed), {-4.0 / 9, 0, 0}), 0, 1e-12);
  EXPECT_NEAR(glm::distance(base({0, 0, 1}, ShadowForm::printed), {0, 0, -3.0 / 9}), 0, 1e-12);
  // Along (3, 0, 4) / 5: (4 * 3 + 3 * 4) / 5 / 9 = 24 / 45 of the way back along it.
  EXPECT_NEAR(glm::distance(base({3, 0, 4}, ShadowForm::printed), glm::dvec3(-3, 0, -4) * (24.0 / 225)), 0, 1e-12);
  for (const glm::vec3& half : {glm::vec3(1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(3, 0, 4)})
    EXPECT_NEAR(glm::distance(base(half, ShadowForm::paper), {-4.0 / 9, 0, -3.0 / 9}), 0, 1e-12);
}

// A light in the triangle's plane, but for rounding: the three points are in a row, and whatever their order rounds to, nothing
// off the row is in the shadow.
TEST(PlanarShadowForms, points_in_a_row_make_no_shadow) {
  Random random(6);
  int left = 0;
  for (int i = 0; i < 5000; ++i) {
    const glm::dvec3 along = glm::normalize(glm::dvec3(random.uniform(-1, 1), 0, random.uniform(-1, 1)));
    const glm::vec3 half(along), middle(random.uniform(glm::dvec3(-1, 0.5, -1), glm::dvec3(1, 1, 1)));
    const Triangle triangle{{middle - half, middle + half, middle + glm::vec3(0, 1, 0)}};
    const glm::dvec4 light(glm::dvec3(middle) + random.uniform(-4, 4) * along + glm::dvec3(0, random.uniform(2, 5), 0), 1);
    for (const ShadowForm form : {ShadowForm::printed, ShadowForm::paper}) {
      const PlanarShadow shadow(triangle, light, ground, form);
      left += !shadow.parts().empty();
      for (int k = 0; k < 20; ++k) {
        const glm::dvec3 point = random.uniform(glm::dvec3(-8, 0, -8), glm::dvec3(8, 0, 8));
        const double off = glm::length(glm::cross(along, point - glm::dvec3(light.x, 0, light.z)));
        ASSERT_FALSE(shadow.contains(point) && off > 1e-5);
      }
    }
  }
  EXPECT_GT(left, 1000);
}

// --- Objections ------------------------------------------------------------------------------------------------------------

std::string objection(const Shape& shape, ShadowForm form, const glm::dvec4& light = {1, 9, 2, 1}) {
  return PlanarShadow::objection(shape, light, ground, form);
}

TEST(PlanarShadowForms, objections_say_why) {
  constexpr auto printed = ShadowForm::printed, paper = ShadowForm::paper, exact = ShadowForm::exact;
  const Sphere sphere{{0, 2, 0}, 1};
  const Cone cone{{0, 1, 0}, {0, 1, 0}, 1, 3}, leaning{{0, 1, 0}, {0.01f, 1, 0}, 1, 3}, hanging{{0, 4, 0}, {0, -1, 0}, 1, 3};
  const Disc disc{{0, 1, 0}, {0, -3, 0}, 1}, tilted{{0, 1, 0}, {0, 1, 0.01f}, 1};
  const Triangle upright{{{-1, 1, 0}, {1, 1, 0}, {0, 3, 0}}}, lying{{{-1, 1, 0}, {1, 1, 0}, {0, 1, 2}}};
  const Triangle scalene{{{-1, 1, 0}, {1, 1, 0}, {0.5f, 3, 0}}}, upside_down{{{-1, 3, 0}, {1, 3, 0}, {0, 1, 0}}};
  const Box box{{0, 1, 0}, {1, 2, 1}};
  const Plane rectangle{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
  for (const Shape& shape : {Shape(sphere), Shape(cone), Shape(disc), Shape(upright)})
    for (const ShadowForm form : {printed, paper, exact}) EXPECT_EQ(objection(shape, form), "");
  for (const Shape& shape : {Shape(leaning), Shape(hanging), Shape(tilted), Shape(box), Shape(rectangle), Shape(scalene)})
    EXPECT_EQ(objection(shape, exact), "");
  for (const ShadowForm form : {printed, paper}) {
    EXPECT_EQ(objection(tilted, form), "the disc is not parallel to the plane");
    EXPECT_EQ(objection(leaning, form), "the cone does not stand upright");
    EXPECT_EQ(objection(hanging, form), "the cone does not stand upright");
    EXPECT_EQ(objection(box, form), "there is no formula for a box");
    EXPECT_EQ(objection(rectangle, form), "there is no formula for a plane");
    EXPECT_EQ(objection(Sphere{{0, 0.9f, 0}, 1}, form), "the sphere crosses the plane");
    EXPECT_EQ(objection(Cone{{0, -1, 0}, {0, 1, 0}, 1, 3}, form), "the cone crosses the plane");
    EXPECT_EQ(objection(sphere, form, {5, 3, 0, 1}), "the light is not above the sphere");
    EXPECT_EQ(objection(sphere, form, {5, 3.001, 0, 1}), "");
    EXPECT_EQ(objection(cone, form, {5, 4, 0, 1}), "the light is not above the cone");
    EXPECT_EQ(objection(disc, form, {5, 0.5, 0, 1}), "the light is not above the disc");
    EXPECT_EQ(objection(sphere, form, {1, 0, 0, 0}), "the light is not above the sphere");
    EXPECT_EQ(objection(sphere, form, {1, 0.01, 0, 0}), "");
    // Resting on the plane, but for a rounding of 0.1, is not crossing it; what is behind it casts nothing and may be anything.
    EXPECT_EQ(objection(Sphere{{0, 0.1f, 0}, 0.1f}, form), "");
    EXPECT_EQ(objection(Sphere{{0, 0.1f - 5e-7f, 0}, 0.1f}, form), "");
    EXPECT_EQ(objection(Box{{0, -1, 0}, {1, 0, 1}}, form), "");
    EXPECT_TRUE(PlanarShadow(Box{{0, -1, 0}, {1, 0, 1}}, {1, 9, 2, 1}, ground, form).parts().empty());
  }
  // A hundred-thousandth of what is longer, base or height, may be rounding.
  for (const Triangle& t :
       {Triangle{{{-2e-5f, 1, 0}, {2e-5f, 1, 0}, {1e-5f, 3, 0}}}, Triangle{{{-10, 1, 0}, {10, 1.0001f, 0}, {0, 1.01f, 0}}}})
    EXPECT_EQ(objection(t, printed), "");
  for (const Triangle& t : {lying, scalene, upside_down}) {
    EXPECT_EQ(objection(t, printed), "the triangle is not isosceles and upright");
    EXPECT_EQ(objection(t, paper), "");
  }
  for (const ShadowForm form : {printed, paper, exact}) {
    EXPECT_EQ(objection(sphere, form, {0, 2.5, 0, 1}), "the light is in or on the sphere");
    EXPECT_EQ(objection(sphere, form, {0, 6, 0, 2}), "the light is in or on the sphere");  // (0, 3, 0) in other words
    EXPECT_EQ(objection(cone, form, {0, 3.9, 0, 1}), "the light is in or on the cone");
    EXPECT_EQ(objection(disc, form, {0.9, 1, 0, 1}), "the light is in or on the disc");
    EXPECT_EQ(objection(upright, form, {0, 2, 0, 1}), "the light is in or on the triangle");
    EXPECT_EQ(objection(rectangle, form, {0.9, 1, 0.9, 1}), "the light is in or on the plane");
    EXPECT_EQ(objection(box, form, {1, 1.5, 0.5, 1}), "the light is in or on the box");
  }
  // Edge-on is neither in nor on.
  EXPECT_EQ(objection(disc, exact, {1.1, 1, 0, 1}), "");
  EXPECT_EQ(objection(upright, exact, {1, 3, 0, 1}), "");
  EXPECT_EQ(objection(rectangle, exact, {1.1, 1, 0, 1}), "");
}

// Objections to lights on both sides of the surface, down to 1e-5 of the shape's size from it.
TEST(PlanarShadowForms, exact_objects_to_lights_inside_and_to_no_others) {
  Random random(5);
  int inside = 0, outside = 0;
  for (int i = 0; i < 20000; ++i) {
    const Question q = random_question(random, i % 2);
    const Ball ball = ball_around(q.shape);
    const glm::dvec3 surface = close_to(q.shape, random);
    const glm::dvec3 at = random.below(2) ? surface : 2.0 * ball.middle - surface;
    const bool objects = !PlanarShadow::objection(q.shape, {at, 1}, q.plane, ShadowForm::exact).empty();
    const double margin = planar_brute::is_solid(q.shape) ? 1e-5 : 1e-5 * ball.radius;
    if (!planar_brute::holds(q.shape, margin, at)) {
      ++outside;
      ASSERT_FALSE(objects) << print(q);
    } else if (planar_brute::is_solid(q.shape) && planar_brute::holds(q.shape, -margin, at)) {
      ++inside;
      ASSERT_TRUE(objects) << print(q);
    }
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 5000);
}

}  // namespace planar_shadow_forms_test
