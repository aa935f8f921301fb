// Where tangents touch spheres and cones, against closed forms and against the surfaces themselves.
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <numbers>

#include "small_world.h"

namespace contour_test {
using namespace gnomon;

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

struct TangencyVector {
  glm::dvec3 light, center;
  double radius, to_center, cos_alpha;
  glm::dvec3 p;
  double r;
  glm::dvec3 u, v;
  std::vector<glm::dvec3> q;
};

// cos a = sqrt(LC^2 - R^2) / LC; PL = (LC^2 - R^2) / LC; P = L + PL * LC / |LC|; r = R cos a. u skips the smallest component of
// LC, v = u x LC, Q_k = P + cos(2 pi k / N) v + sin(2 pi k / N) u.
TEST(TangencyCircle, is_the_one_of_the_vectors) {
  const TangencyVector vectors[] = {{{0, 10, 0},
                                     {3, 2, -4},
                                     2,
                                     9.00998198005,
                                     0.977269757935,
                                     {2.86516853933, 2.3595505618, -3.8202247191},
                                     1.95453951587,
                                     {0.0, 0.874096644439, -1.74819328888},
                                     {-1.85308118005, -0.555924354016, -0.277962177008},
                                     {{1.01208735927, 1.80362620778, -4.09818689611},
                                      {1.9386279493, 2.83857828424, -5.4731856065},
                                      {3.79170912935, 3.39450263825, -5.19522342949},
                                      {4.71824971938, 2.91547491581, -3.54226254209},
                                      {3.79170912935, 1.88052283936, -2.1672638317},
                                      {1.9386279493, 1.32459848534, -2.44522600871}}},
                                    {{0, 0, 5},
                                     {0, 0, 0},
                                     3,
                                     3.2,
                                     0.8,
                                     {0, 0, 1.8},
                                     2.4,
                                     {0, 2.4, 0},
                                     {-2.4, 0, 0},
                                     {{-2.4, 0, 1.8}, {0, 2.4, 1.8}, {2.4, 0, 1.8}, {0, -2.4, 1.8}}}};
  for (const TangencyVector& t : vectors) {
    const Sphere sphere{.center = t.center, .radius = static_cast<float>(t.radius)};
    const glm::dvec4 light(t.light, 1);
    const TangencyCircle circle = tangency_circle(sphere, light);
    EXPECT_NEAR(glm::distance(circle.center, t.light), t.to_center, 1e-9);
    EXPECT_NEAR(circle.cos_alpha, t.cos_alpha, 1e-9);
    EXPECT_NEAR(circle.radius, t.r, 1e-9);
    expect_near(circle.center, t.p);
    expect_near(circle.u * circle.radius, t.u);
    expect_near(circle.v * circle.radius, t.v);
    const int n = static_cast<int>(t.q.size());
    for (int k = 0; k < n; ++k) expect_near(circle.point(2 * std::numbers::pi * k / n), t.q[k]);
  }
}

// R = 0.01 at 1000 m: r differs from R by 5e-13. The difference of squares as printed returns 0 in float32.
TEST(TangencyCircle, small_far_sphere_keeps_its_radius) {
  const Sphere sphere{.center = {0, 0, 1000}, .radius = 0.01f};
  EXPECT_NEAR(tangency_circle(sphere, {0, 0, 0, 1}).radius, 0.0099999999995, 1e-8);

  const float lc = 1000, r = 0.01f, pl = (lc * lc - r * r) / lc;
  EXPECT_EQ(std::sqrt(lc * lc - r * r - pl * pl), 0);  // as printed
  EXPECT_NEAR(r * std::sqrt(lc * lc - r * r) / lc, 0.00999999977648, 1e-8);
}

// Every generator is seen from one side: its outward normal at b, with (h cos b, h sin b) along u, v and r along the axis,
// faces the light inside side - half .. side + half and nowhere else. Where the outline is the base's circle, all of them do or
// none.
TEST(ConeOutline, parts_generators_that_face_the_light) {
  Random random(5);
  int circles = 0, arcs = 0;
  for (int round = 0; round < 300; ++round) {
    const Cone cone{glm::vec3(random.uniform(glm::dvec3(-1), glm::dvec3(1))), glm::vec3(small_world::direction_of(random)),
                    static_cast<float>(random.uniform(0.2, 1)), static_cast<float>(random.uniform(0.1, 2))};
    const double w = round % 2;
    const glm::dvec4 light(small_world::direction_of(random) * (w ? 6.0 : 1.0), w);
    const ConeOutline outline(cone, light);
    EXPECT_EQ(outline.base_faces, glm::dot(outline.axis, to_light(light, outline.base)) < 0);
    int facing = 0;
    for (int k = 0; k < 64; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.5) / 64;
      const glm::dvec3 out = std::cos(angle) * outline.frame.u + std::sin(angle) * outline.frame.v;
      const double rise = glm::dot(outline.height * out + outline.radius * outline.axis, to_light(light, outline.rim(angle)));
      facing += rise > 0;
      if (outline.is_circle) continue;
      const double off = std::abs(std::remainder(angle - outline.side, 2 * std::numbers::pi));
      if (std::abs(off - outline.half) > 1e-6) {
        EXPECT_EQ(rise > 0, off < outline.half) << round << ", " << k;
      }
    }
    if (outline.is_circle) {
      EXPECT_TRUE(facing == 0 || facing == 64) << round;
    }
    ++(outline.is_circle ? circles : arcs);
  }
  EXPECT_GT(circles, 20);
  EXPECT_GT(arcs, 100);
}

// Base at the origin, radius 3, height 4: the lateral surface leans so that its normal is (4, 3) / 5 across and along. On the
// axis at height 1 it is (4 * 0 + 3 * 1 - 12) / 5 = -1.8 away.
TEST(ConePlace, is_height_and_signed_distance) {
  const Cone cone{{0, 0, 0}, {0, 2, 0}, 3, 4};
  const auto expect_place = [&](const glm::dvec3& point, double along, double off) {
    const ConePlace place(cone, point);
    EXPECT_NEAR(place.along, along, 1e-12);
    EXPECT_NEAR(place.off, off, 1e-12);
    EXPECT_EQ(contains(cone, point), along > 0 && off < -1e-12);
  };
  expect_place({0, 1, 0}, 1, -1.8);
  expect_place({3, 0, 0}, 0, 0);
  expect_place({0, 4, 0}, 4, 0);
  expect_place({1.5, 2, 0}, 2, 0);
  expect_place({0, 0, -6}, 0, 2.4);
}

// Tilted by 30 degrees, a disc of radius 2 reaches 2 sin 30 = 1 to both sides of its center.
TEST(Heights, are_those_of_the_lowest_and_highest_points) {
  const glm::dvec4 above_one(0, 1, 0, -1);
  const auto expect_heights = [&](const Shape& shape, double low, double high) {
    const auto [lowest, highest] = heights_over(shape, above_one);
    EXPECT_NEAR(lowest, low, 1e-6);
    EXPECT_NEAR(highest, high, 1e-6);
  };
  expect_heights(Sphere{{5, 3, 0}, 0.5f}, 1.5, 2.5);
  expect_heights(Disc{{0, 3, 0}, {0.5f, std::sqrt(0.75f), 0}, 2}, 1, 3);
  expect_heights(Cone{{0, 1, 0}, {0, 1, 0}, 1, 3}, 0, 3);
  expect_heights(Cone{{0, 1, 0}, {0, -1, 0}, 1, 3}, -3, 0);
  expect_heights(Box{{0, 0, 0}, {1, 2, 3}}, -1, 1);
  expect_heights(Triangle{{{0, 0, 0}, {1, 7, 0}, {0, 1, 1}}}, -1, 6);
  expect_heights(Plane{{0, 2, 0}, {1, 1, 0}, {0, 0.5f, 1}}, -0.5, 2.5);
}

}  // namespace contour_test
