// Shadows in closed form against rays through the very shapes: random and degenerate places of shape, light and plane.
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <optional>

#include "planar_questions.h"

namespace planar_shadow_test {
using namespace gnomon;
using planar_brute::Answer;
using planar_brute::answer;
using namespace planar_questions;

constexpr double pi = std::numbers::pi;

// --- contains() ------------------------------------------------------------------------------------------------------------

// Points within 1e-7 of the shape's size of where the rays' answer changes are left out: one in thirty where everything is in
// general position, one in ten where shapes, lights and planes meet on whole numbers.
void expect_rays_agree(unsigned seed, bool whole) {
  constexpr int question_count = 5000;
  Random random(seed);
  std::map<std::string_view, int> dark, tested;
  int unsure = 0, low_light = 0;
  for (int i = 0; i < question_count; ++i) {
    const Question q = random_question(random, whole);
    SCOPED_TRACE(print(q));
    const PlanarShadow shadow(q.shape, q.light, q.plane);
    const Ball ball = ball_around(q.shape);
    const bool is_low = q.light.w * glm::dot(q.plane, glm::dvec4(ball.middle, 1)) > glm::dot(q.plane, q.light);
    for (int k = 0; k < 40; ++k) {
      const glm::dvec3 point = random_point(random, q, ball);
      const Answer truth = answer(q.shape, q.light, point);
      unsure += truth == Answer::unsure;
      if (truth == Answer::unsure) continue;
      ++tested[kind_name(q.shape)];
      dark[kind_name(q.shape)] += truth == Answer::dark;
      low_light += truth == Answer::dark && is_low;
      ASSERT_EQ(shadow.contains(point), truth == Answer::dark) << fmt::format("{} {} {}", point.x, point.y, point.z);
    }
  }
  EXPECT_EQ(tested.size(), std::variant_size_v<Shape>);
  for (const auto& [kind, count] : tested) EXPECT_GT(dark[kind], count / 8) << kind;
  EXPECT_GT(low_light, question_count);
  EXPECT_LT(unsure, 40 * question_count / (whole ? 10 : 30));
}

TEST(PlanarShadow, contains_what_rays_find_dark) { expect_rays_agree(1, false); }
TEST(PlanarShadow, contains_what_rays_find_dark_where_things_are_level_or_edge_on) { expect_rays_agree(2, true); }

// The tests of the parts hold for every point outside the solid, on the plane or not, as long as no part is left out for being
// behind the plane: the plane is below everything here, and points are anywhere.
TEST(PlanarShadow, tests_hold_off_the_plane) {
  Random random(3);
  int dark = 0, tested = 0;
  for (int i = 0; i < 5000; ++i) {
    Question q = random_question(random, i % 2);
    q.plane = {0, 1, 0, 100};
    if (q.light.w == 0 && q.light.y <= 0) continue;
    SCOPED_TRACE(print(q));
    const PlanarShadow shadow(q.shape, q.light, q.plane);
    const Ball ball = ball_around(q.shape);
    for (int k = 0; k < 20; ++k) {
      const glm::dvec3 point = ball.middle + random.uniform(glm::dvec3(-4), glm::dvec3(4));
      const Answer truth = answer(q.shape, q.light, point);
      if (truth == Answer::unsure) continue;
      ++tested;
      dark += truth == Answer::dark;
      ASSERT_EQ(shadow.contains(point), truth == Answer::dark) << fmt::format("{} {} {}", point.x, point.y, point.z);
    }
  }
  EXPECT_GT(dark, tested / 20);
}

// The corners span (-2, -1, -1) and (-3, 1, 0), whose normal is (1, 3, -5), and the light is at (1, -2, -1) from the first of
// them: 1 - 6 + 5 = 0. Rounding of the unit normal or of the middle of the corners is no ground for a shadow of half the plane.
TEST(PlanarShadow, edge_on_casts_nothing) {
  const double third = std::sqrt(1.0 / 3);
  const PlanarShadow shadow(Triangle{{{0, 0, 2}, {-2, -1, 1}, {-3, 1, 2}}}, {1, -2, 1, 1}, {third, -third, -third, 4});
  EXPECT_TRUE(shadow.parts().empty());
  EXPECT_FALSE(shadow.contains({-4.502805408558662, 2.370768062920735, 0.05462975879611242}));
}

// A light in the plane of a flat shape, but for the rounding of its coordinates: what is left is thinner than float32 can tell.
TEST(PlanarShadow, edge_on_but_for_rounding_casts_a_sliver_at_most) {
  Random random(4);
  int left = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto point = [&] { return glm::vec3(random.uniform(glm::dvec3(-3), glm::dvec3(3))); };
    const Triangle t{{point(), point(), point()}};
    const glm::dvec3 a(t.points[0]), u = glm::dvec3(t.points[1]) - a, v = glm::dvec3(t.points[2]) - a;
    const glm::dvec4 light(a + random.uniform(-3, 4) * u + random.uniform(-3, 4) * v, 1);
    const glm::dvec4 plane(0, 1, 0, 12);
    if (light.y < -11 || glm::length(glm::cross(u, v)) < 1e-2) continue;
    if (!PlanarShadow::objection(t, light, plane, ShadowForm::exact).empty()) continue;
    const PlanarShadow shadow(t, light, plane);
    left += !shadow.parts().empty();
    for (int k = 0; k < 20; ++k) {
      glm::dvec3 p = random.uniform(glm::dvec3(-20, -12, -20), glm::dvec3(20, -12, 20));
      p.y = -12;
      ASSERT_FALSE(shadow.contains(p) && answer(t, light, p) == Answer::lit);
    }
  }
  EXPECT_GT(left, 1000);
}

// --- outlines() ------------------------------------------------------------------------------------------------------------

/// Coordinates along a plane, right-handed with its normal, from an origin near the points tested.
struct Along {
  glm::dvec3 origin, s, t;

  Along(const glm::dvec4& plane, const glm::dvec3& origin) : origin(origin) {
    const glm::dvec3 up(plane), helper = std::abs(up.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    s = glm::normalize(glm::cross(helper, up)), t = glm::cross(up, s);
  }
  glm::dvec3 operator()(const glm::dvec4& p) const {
    const glm::dvec3 x = glm::dvec3(p) - p.w * origin;
    return glm::normalize(glm::dvec3(glm::dot(s, x), glm::dot(t, x), p.w));
  }
};

double turn(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) { return glm::dot(glm::cross(a, b), c); }

/// A homogeneous point is in a convex loop when it is to the left of every edge; an edge between two points at infinity has
/// everything on its left.
bool in_loop(const std::vector<glm::dvec3>& loop, const glm::dvec3& x) {
  for (std::size_t k = 0; k < loop.size(); ++k)
    if (turn(loop[k], loop[(k + 1) % loop.size()], x) < 0) return false;
  return true;
}

// The loop's circles are inscribed: what it holds is dark, and what is dark and not in it lies between the circle and its
// inscribed polygon, so that the disc shrunk by cos(pi / segments) does not shade it.
void expect_outlines_agree(unsigned seed, bool whole) {
  constexpr int question_count = 3000;
  Random random(seed);
  int in = 0, infinite = 0, between = 0;
  for (int i = 0; i < question_count; ++i) {
    const Question q = random_question(random, whole);
    SCOPED_TRACE(print(q));
    const PlanarShadow shadow(q.shape, q.light, q.plane);
    const int segments = 3 + static_cast<int>(random.below(62));
    const auto loops = shadow.outlines(segments);
    ASSERT_LE(loops.size(), 1u);
    const Ball ball = ball_around(q.shape);
    const Along along(q.plane, ball.middle - glm::dot(q.plane, glm::dvec4(ball.middle, 1)) * glm::dvec3(q.plane));
    std::vector<glm::dvec3> loop;
    for (const auto& points : loops)
      for (const glm::dvec4& p : points) {
        ASSERT_GE(p.w, 0);
        infinite += p.w == 0;
        ASSERT_LE(std::abs(glm::dot(q.plane, p)), 1e-12 * (glm::length(glm::dvec3(p)) + p.w) * 20);
        loop.push_back(along(p));
      }
    for (std::size_t k = 0; k < loop.size(); ++k)
      ASSERT_GE(turn(loop[k], loop[(k + 1) % loop.size()], loop[(k + 2) % loop.size()]), -1e-13) << k << " of " << loop.size();
    for (int k = 0; k < 40; ++k) {
      const glm::dvec3 point = random_point(random, q, ball);
      const Answer truth = answer(q.shape, q.light, point);
      if (truth == Answer::unsure) continue;
      const bool is_in = !loop.empty() && in_loop(loop, along(glm::dvec4(point, 1)));
      in += is_in;
      if (is_in == (truth == Answer::dark)) continue;
      ASSERT_FALSE(is_in) << fmt::format("lit, but in the loop: {} {} {}", point.x, point.y, point.z);
      for (ShadowTest test : shadow.tests()) {
        if (test.is_disc) test.rows[2] *= std::cos(pi / segments) * (1 - 1e-9);
        ASSERT_FALSE(test.contains(point)) << fmt::format("dark, but not in the loop: {} {} {}", point.x, point.y, point.z);
      }
      ++between;
    }
  }
  EXPECT_GT(in, 5 * question_count);
  EXPECT_GT(infinite, question_count / 4);
  EXPECT_GT(between, question_count / 20);
}

TEST(PlanarShadow, outlines_bound_what_is_dark) { expect_outlines_agree(5, false); }
TEST(PlanarShadow, outlines_bound_what_is_dark_where_things_are_level_or_edge_on) { expect_outlines_agree(6, true); }

// Light 0.01 above the middle of a disc's radius: by (1) and (2) of the paper the image of the disc of radius 2 at height 1 is
// the circle of radius 2 * 1.01 / 0.01 = 202 around -1 / 0.01 = -100. Half of the rim lies behind the mean of the directions to
// it.
TEST(PlanarShadow, outline_of_a_disc_right_below_the_light_is_its_circle) {
  const PlanarShadow shadow(Disc{{0, 1, 0}, {0, 1, 0}, 2}, {1, 1.01, 0, 1}, {0, 1, 0, 0});
  const auto loops = shadow.outlines(48);
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops[0].size(), 48u);
  for (const glm::dvec4& p : loops[0]) EXPECT_NEAR(glm::distance(glm::dvec3(p) / p.w, {-100, 0, 0}), 202, 1e-9);
}

// Light at (4, 2, 0), sphere of radius 1 around (0, 1, 0): level with the top, h = r, so the shadow is a parabola, that on y =
// 0 opens to -x. Its vertex lies where the tangent under the sphere meets the plane: with the axis sloping by asin(1 / sqrt 17)
// and the tangent as much again, tan = 2 / 4 / (1 - 1 / 16) = 8 / 15, so x = 4 - 2 * 15 / 8 = 0.25. One point of the loop is at
// infinity, in the direction of the level tangent. A light below that leaves a hyperbola: two points at infinity, the
// directions of its asymptotes; one above it an ellipse, and none.
TEST(PlanarShadow, level_light_makes_a_parabola_and_a_low_one_a_hyperbola) {
  const Sphere sphere{{0, 1, 0}, 1};
  const auto infinite_count = [&](double y) {
    int count = 0;
    for (const auto& loop : PlanarShadow(sphere, {4, y, 0, 1}, {0, 1, 0, 0}).outlines(64))
      for (const glm::dvec4& p : loop) {
        if (p.w != 0) continue;
        ++count;
        EXPECT_LT(p.x, 0);
      }
    return count;
  };
  EXPECT_EQ(infinite_count(2.5), 0);
  EXPECT_EQ(infinite_count(1.5), 2);
  EXPECT_EQ(infinite_count(0.5), 2);
  const PlanarShadow parabola(sphere, {4, 2, 0, 1}, {0, 1, 0, 0});
  EXPECT_TRUE(parabola.contains({0.25 - 1e-9, 0, 0}));
  EXPECT_FALSE(parabola.contains({0.25 + 1e-9, 0, 0}));
  EXPECT_TRUE(parabola.contains({-1e6, 0, 0}));
  EXPECT_FALSE(parabola.contains({-1e6, 0, 1e4}));
  // No anti-shadow: the other branch of the hyperbola is on the light's far side.
  const PlanarShadow hyperbola(sphere, {4, 0.5, 0, 1}, {0, 1, 0, 0});
  EXPECT_TRUE(hyperbola.contains({-1000, 0, 0}));
  EXPECT_FALSE(hyperbola.contains({1000, 0, 0}));
}

// In the plane, behind it, or the light in the plane.
TEST(PlanarShadow, nothing_over_the_plane_casts_nothing) {
  const glm::dvec4 ground(0, 1, 0, 0), above(1, 4, 2, 1);
  for (const Shape& shape :
       {Shape(Disc{{0, 0, 0}, {0, 1, 0}, 1}), Shape(Sphere{{0, -2, 0}, 1}), Shape(Box{{-1, -2, -1}, {1, 0, 1}})}) {
    const PlanarShadow shadow(shape, above, ground);
    EXPECT_TRUE(shadow.parts().empty());
    EXPECT_TRUE(shadow.tests().empty());
    EXPECT_TRUE(shadow.outlines(8).empty());
    EXPECT_FALSE(shadow.contains({0.1, 0, 0.1}));
  }
  EXPECT_TRUE(PlanarShadow(Sphere{{0, 1, 0}, 0.5f}, {3, 0, 0, 1}, ground).outlines(8).empty());
}

// Far from the origin the corners of a rectangle are rounded by a share of it that shows.
TEST(PlanarShadow, a_rectangle_has_the_corners_of_its_triangles) {
  const Plane rectangle{{1000.1f, 3, 2000.7f}, {0.013f, 0, 0.007f}, {0, 0.011f, 0.003f}};
  const Mesh mesh = tessellate(rectangle, 64, "plane");
  const PlanarShadow shadow(rectangle, {1003, 9, 2003, 1}, {0, 1, 0, 0});
  ASSERT_EQ(shadow.parts().size(), 1u);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(shadow.parts()[0].points[k], glm::dvec3(mesh.positions[k]));
}

// --- float32 ---------------------------------------------------------------------------------------------------------------

/// ShadowTest::contains in float32, as a shader would.
bool contains_float(const ShadowTest& test, const glm::vec3& point) {
  const glm::vec4 x(point - glm::vec3(test.anchor), 1);
  const auto f = [&](const glm::dvec4& row) { return glm::dot(glm::vec4(row), x); };
  if (!(f(test.beyond) > 0)) return false;
  const float a = f(test.rows[0]), b = f(test.rows[1]), c = f(test.rows[2]);
  if (test.is_disc) return a * a + b * b <= c * c && c > 0;
  return a >= 0 && b >= 0 && c >= 0 && f(test.rows[3]) >= 0;
}

/// A dark and a lit point of the plane with the part's outline between them, as near to each other as double tells; or none.
std::optional<glm::dvec3> point_on_outline(Random& random, const Question& q, const Ball& ball, const ShadowTest& test) {
  std::optional<glm::dvec3> dark, lit;
  for (int k = 0; k < 20; ++k) {
    const glm::dvec3 p = random_point(random, q, ball);
    (test.contains(p) ? dark : lit) = p;
  }
  if (!dark || !lit) return std::nullopt;
  for (int k = 0; k < 40; ++k) {
    const glm::dvec3 middle = 0.5 * (*dark + *lit);
    (test.contains(middle) ? dark : lit) = middle;
  }
  return dark;
}

// One unit is 2^-24 of the point's distance from the part's middle and of the part's size, together. With the light no closer
// to the shape than a tenth of its radius, float32 answers otherwise than double only within 16 units of where double changes
// its answer (looked for in 26 directions), and nearly always within 2. (Closer lights make parts nearly edge-on and points of
// a part nearly infinite: at 1e-5 of the size some answers differ at thousands of units.) Points are tested at 1 to 16384
// units.
TEST(PlanarShadow, float32_differs_by_roundings_only) {
  Random random(7);
  int asked = 0, differ = 0, beyond_two = 0;
  for (int i = 0; i < 10000; ++i) {
    const Question q = random_question(random, i % 2);
    const Ball ball = ball_around(q.shape);
    if (q.light.w != 0 && gap(q.shape, glm::dvec3(q.light)) < 0.1 * ball.radius) continue;
    SCOPED_TRACE(print(q));
    const PlanarShadow shadow(q.shape, q.light, q.plane);
    for (std::size_t part = 0; part < shadow.tests().size(); ++part) {
      const ShadowTest& test = shadow.tests()[part];
      ASSERT_EQ(test.anchor, glm::dvec3(glm::vec3(test.anchor)));
      ASSERT_LT(glm::distance(test.anchor, ball.middle), 1.5 * ball.radius);
      const std::optional<glm::dvec3> edge = point_on_outline(random, q, ball, test);
      if (!edge) continue;
      double size = 0;
      for (const glm::dvec3& p : shadow.parts()[part].points) size = std::max(size, glm::distance(p, test.anchor));
      const double unit = 0x1p-24 * (glm::distance(*edge, test.anchor) + size);
      for (int k = 0; k < 30; ++k) {
        const glm::vec3 p(*edge + unit * std::exp2(random.uniform(0, 14)) * random.uniform(glm::dvec3(-1), glm::dvec3(1)));
        const bool truth = test.contains(p);
        ++asked;
        if (contains_float(test, p) == truth) continue;
        ++differ;
        double units = 0.25;
        for (bool is_near = false; !is_near;) {
          units *= 2;
          for (int d = 0; d < 27 && !is_near; ++d)
            is_near = test.contains(glm::dvec3(p) + unit * units * glm::dvec3(d % 3 - 1, d / 3 % 3 - 1, d / 9 - 1)) != truth;
        }
        beyond_two += units > 2;
        ASSERT_LE(units, 16) << fmt::format("{} {} {}", p.x, p.y, p.z);
      }
    }
  }
  EXPECT_GT(asked, 100000);
  EXPECT_GT(differ, 500);
  EXPECT_LT(beyond_two, differ / 50);
}

}  // namespace planar_shadow_test
