// The parts of radiosity alone: form factors against closed forms, division, refinement.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "device/context.h"
#include "small_world.h"
#include "techniques/radiosity/division.h"
#include "techniques/radiosity/form_factor.h"
#include "techniques/radiosity/gathering.h"
#include "techniques/radiosity/hemicube.h"
#include "techniques/radiosity/refinement.h"

namespace radiosity_parts_test {
using namespace gnomon::radiosity;
using gnomon::Random;
using gnomon::RayScene;
using gnomon::Scene;
using gnomon::Truth;
using std::numbers::pi;

// Closed forms of Howell's catalog of configuration factors.

/// From a point to a rectangle a x b across its normal at the distance c, a corner straight ahead (B-3).
double point_to_rectangle(double a, double b, double c) {
  const double x = a / c, y = b / c, p = std::sqrt(1 + x * x), q = std::sqrt(1 + y * y);
  return (x / p * std::atan(y / p) + y / q * std::atan(x / q)) / (2 * pi);
}

/// Between equal rectangles a x b that face each other at the distance c (C-11).
double parallel_rectangles(double a, double b, double c) {
  const double x = a / c, y = b / c, p = 1 + x * x, q = 1 + y * y;
  return 2 / (pi * x * y) *
         (std::log(std::sqrt(p * q / (p + q - 1))) + x * std::sqrt(q) * std::atan(x / std::sqrt(q)) +
          y * std::sqrt(p) * std::atan(y / std::sqrt(p)) - x * std::atan(x) - y * std::atan(y));
}

/// From a rectangle l x w to one l x h at a right angle, on their common side l (C-14).
double perpendicular_rectangles(double l, double w_side, double h_side) {
  const double w = w_side / l, h = h_side / l, ww = w * w, hh = h * h, s = hh + ww;
  const double logs = std::log((1 + ww) * (1 + hh) / (1 + s)) + ww * std::log(ww * (1 + s) / ((1 + ww) * s)) +
                      hh * std::log(hh * (1 + s) / ((1 + hh) * s));
  return (w * std::atan(1 / w) + h * std::atan(1 / h) - std::sqrt(s) * std::atan(1 / std::sqrt(s)) + logs / 4) / (pi * w);
}

std::array<glm::dvec3, 4> rectangle(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
  return {corner, corner + u, corner + u + v, corner + v};
}
const glm::dvec3 x_axis(1, 0, 0), y_axis(0, 1, 0), z_axis(0, 0, 1);

TEST(radiosity_form_factor, of_a_point_to_a_rectangle_is_the_closed_form) {
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const double a = random.uniform(0.05, 5), b = random.uniform(0.05, 5), c = random.uniform(0.05, 5);
    const auto polygon = rectangle(c * z_axis, a * x_axis, b * y_axis);
    EXPECT_NEAR(factor_at(glm::dvec3(0), z_axis, polygon), point_to_rectangle(a, b, c), 1e-12);
  }
}

TEST(radiosity_form_factor, leaves_out_what_is_below_the_horizon) {
  // Half of a square that stands across the horizon: as much as the upper half alone.
  const auto whole = rectangle({-1, -1, 1}, 2.0 * x_axis, 2.0 * y_axis), half = rectangle({-1, 0, 1}, 2.0 * x_axis, y_axis);
  EXPECT_NEAR(factor_at(glm::dvec3(0), y_axis, whole), factor_at(glm::dvec3(0), y_axis, half), 1e-15);
  EXPECT_EQ(factor_at(glm::dvec3(0), -z_axis, whole), 0);
}

TEST(radiosity_form_factor, between_rectangles_is_the_closed_form) {
  const auto check = [](const Patch& receiver, const auto& polygon, double expected) {
    EXPECT_NEAR(mean_factor(receiver, polygon, 16), expected, 1e-5);
  };
  for (const auto& [a, b, c] : {std::array{1.0, 1.0, 1.0}, {2.0, 1.0, 0.7}, {0.5, 3.0, 2.0}}) {
    const auto polygon = rectangle(c * z_axis, a * x_axis, b * y_axis);
    check({glm::dvec3(0), a * x_axis, b * y_axis, false, z_axis}, polygon, parallel_rectangles(a, b, c));
  }
  for (const auto& [l, w, h] : {std::array{1.0, 1.0, 1.0}, {2.0, 1.0, 3.0}, {1.0, 2.0, 0.5}}) {
    const auto polygon = rectangle(glm::dvec3(0), l * x_axis, h * z_axis);
    check({glm::dvec3(0), l * x_axis, w * y_axis, false, z_axis}, polygon, perpendicular_rectangles(l, w, h));
  }
}

TEST(radiosity_form_factor, times_area_is_the_same_both_ways) {
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const glm::dvec3 u1 = random.uniform(glm::dvec3(-1), glm::dvec3(1)), v1 = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    const glm::dvec3 u2 = random.uniform(glm::dvec3(-1), glm::dvec3(1)), v2 = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    const glm::dvec3 n1 = glm::normalize(glm::cross(u1, v1)), n2 = glm::normalize(glm::cross(u2, v2));
    // Far enough apart that each is above the other's horizon: within it the kernel has no corners.
    const glm::dvec3 c1(0), c2 = 3.0 * n1 + random.uniform(glm::dvec3(-1), glm::dvec3(1));
    if (std::abs(glm::dot(n2, glm::normalize(c2))) < 0.8) continue;
    const glm::dvec3 front = glm::dot(n2, c1 - c2) > 0 ? n2 : -n2;
    const Patch first{c1, u1, v1, k % 2 == 0, n1}, second{c2, u2, v2, false, front};
    const double area1 = glm::length(glm::cross(u1, v1)) * (first.is_triangle ? 0.5 : 1),
                 area2 = glm::length(glm::cross(u2, v2));
    std::array corners = rectangle(c1, u1, v1);
    const std::vector<glm::dvec3> polygon1 = first.is_triangle ? std::vector<glm::dvec3>{c1, c1 + u1, c1 + v1}
                                                               : std::vector<glm::dvec3>(corners.begin(), corners.end());
    const double to_second = area1 * mean_factor(first, rectangle(c2, u2, v2), 8);
    const double to_first = area2 * mean_factor(second, polygon1, 8);
    EXPECT_NEAR(to_second / to_first, 1, 1e-3);
  }
}

/// Rays from points of a rectangle to another, each point once, and the standard error of their mean. Both are so far apart
/// that the closed form is not used.
TEST(radiosity_form_factor, by_rays_is_the_closed_form_within_its_error) {
  Scene nothing;
  nothing.meshes.push_back(small_world::ground(1, -100));  // in nobody's way
  const RayScene scene(nothing, Truth::mesh, RayScene::Which::casters);
  const struct {
    std::array<glm::dvec3, 4> sender;
    glm::dvec3 front;
    double expected;
  } cases[] = {{rectangle(4.0 * z_axis, 2.0 * x_axis, y_axis), -z_axis, parallel_rectangles(2, 1, 4)},
               {rectangle(4.0 * z_axis, 2.0 * x_axis, 2.0 * z_axis), y_axis,
                perpendicular_rectangles(2, 1, 6) - perpendicular_rectangles(2, 1, 4)}};
  for (const auto& one : cases) {
    Random random(3);
    std::vector<Receiving> points;
    for (std::uint64_t k = 0; k < 20000; ++k) {
      const double s = random.uniform(0, 2), t = random.uniform(0, 1);
      points.push_back({{s, t, 0}, z_axis, gnomon::no_mesh, 0, k});
    }
    std::vector<Factor> found(points.size());
    Gathering(scene, Way::rays, 4).factors(make_sender(one.sender, one.front), true, points, 1, found);
    double sum = 0, squares = 0;
    for (const Factor& factor : found) {
      EXPECT_EQ(factor.whole, factor.seen);
      sum += factor.seen;
      squares += double(factor.seen) * factor.seen;
    }
    const double n = static_cast<double>(found.size()), mean = sum / n;
    const double error = std::sqrt((squares / n - mean * mean) / n);
    EXPECT_NEAR(mean, one.expected, 4 * error);
    EXPECT_LT(error, 0.02 * mean);
  }
}

TEST(radiosity_hemicube, delta_factors_sum_to_one) {
  for (const int resolution : {32, 256, 512}) {
    double sum = 0;
    for (const float delta : delta_factors(resolution)) sum += delta;
    EXPECT_NEAR(sum, 1, resolution < 64 ? 1e-3 : 2e-5);
  }
}

TEST(radiosity_hemicube, sees_rectangles_within_a_hundredth) {
  gnomon::process_context();
  Hemicube hemicube;
  hemicube.setup();
  Random random(4);
  for (int k = 0; k < 20; ++k) {
    const double a = random.uniform(0.5, 3), b = random.uniform(0.5, 3), c = random.uniform(0.3, 1.5);
    Scene scene;
    scene.meshes.push_back(small_world::make_mesh({{0, 0, c}, {a, 0, c}, {a, b, c}, {0, b, c}}, {{0, 1, 2}, {0, 2, 3}}));
    const Faces faces(scene);
    ASSERT_EQ(faces.size(), 1u);
    const Division division(faces, 100);
    const std::uint32_t first = 0;
    hemicube.show(division, {&first, 1});
    double share = 0;
    const double nothing = hemicube.look(glm::dvec3(0), z_axis, 512, {&share, 1});
    EXPECT_NEAR(share / point_to_rectangle(a, b, c), 1, 0.01);
    EXPECT_NEAR(share + nothing, 1, 2e-5);
    // The same turned upside down, so that the sides see it instead of the top.
    share = 0;
    hemicube.look(glm::dvec3(0), x_axis, 512, {&share, 1});
    EXPECT_NEAR(share / factor_at(glm::dvec3(0), x_axis, rectangle(c * z_axis, a * x_axis, b * y_axis)), 1, 0.01);
  }
}

TEST(radiosity_faces, pair_triangles_of_parallelograms) {
  Scene scene;
  scene.meshes.push_back(small_world::box({-1, 0, -1}, {1, 2, 1}));
  scene.meshes.push_back(small_world::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5f}}, {{0, 1, 2}, {2, 1, 3}}));
  const Faces faces(scene);
  ASSERT_EQ(faces.size(), 8u);
  for (std::size_t f = 0; f < 6; ++f) EXPECT_FALSE(faces[f].is_triangle);
  for (std::uint32_t m = 0; m < 2; ++m)
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const gnomon::Triangle triangle = scene.meshes[m].corners(t);
      const glm::dvec3 center =
          (glm::dvec3(triangle.points[0]) + glm::dvec3(triangle.points[1]) + glm::dvec3(triangle.points[2])) / 3.0;
      const Face& face = faces[faces.face_of(m, t)];
      const glm::dvec2 place = face.place_of(center);
      EXPECT_EQ(face.triangle_at(place), t);
      EXPECT_LT(glm::length(face.at(place) - center), 1e-12);
      EXPECT_GT(glm::dot(face.normal, triangle.normal()), 0);
    }
}

/// Random places of a triangle and of a parallelogram, after random divisions.
TEST(radiosity_division, finds_the_element_and_interpolates_what_is_linear) {
  Scene scene;
  scene.meshes.push_back(small_world::make_mesh({{0, 0, 0}, {3, 0, 0}, {0, 2, 1}}, {{0, 1, 2}}));
  scene.meshes.push_back(small_world::make_mesh({{0, 0, 5}, {3, 0, 5}, {4, 2, 5}, {1, 2, 5}}, {{0, 1, 2}, {0, 2, 3}}));
  const Faces faces(scene);
  Division division(faces, 0.7);
  Random random(5);
  for (int k = 0; k < 300; ++k) {
    const std::uint32_t e = random.below(static_cast<std::uint32_t>(division.elements().size()));
    if (!division.elements()[e].is_divided() && division.elements()[e].level < Division::most_levels) division.divide(e);
  }
  double areas = 0;
  for (const Element& element : division.elements())
    if (!element.is_divided()) areas += division.area(element);
  EXPECT_NEAR(areas, faces[0].area() + faces[1].area(), 1e-12);
  const auto linear = [](const glm::dvec3& p) { return 1 + 2 * p.x - 3 * p.y + 0.5 * p.z; };
  for (int k = 0; k < 5000; ++k) {
    const std::uint32_t f = random.below(2);
    glm::dvec2 place(random.uniform(0, 1), random.uniform(0, 1));
    if (faces[f].is_triangle && place.x + place.y > 1) place = 1.0 - place;
    const Element& element = division.elements()[division.element_at(f, place)];
    ASSERT_EQ(element.face, f);
    ASSERT_FALSE(element.is_divided());
    const glm::dvec2 in = (place - element.low) / element.step;
    EXPECT_TRUE(in.x >= -1e-9 && in.y >= -1e-9 && (faces[f].is_triangle ? in.x + in.y : std::max(in.x, in.y)) <= 1 + 1e-9);
    double sum = 0, all = 0;
    const std::array weights = division.weights(element, place);
    for (std::size_t c = 0; c < division.corner_count(element); ++c) {
      sum += weights[c] * linear(faces[f].at(element.low + element.step * glm::dvec2(c & 1, c >> 1)));
      all += weights[c];
    }
    EXPECT_NEAR(all, 1, 1e-12);
    EXPECT_NEAR(sum, linear(faces[f].at(place)), 1e-9);
  }
}

TEST(radiosity_division, neighbors_share_corners) {
  Scene scene;
  scene.meshes.push_back(small_world::ground(1));
  const Faces faces(scene);
  Division division(faces, 0.5);  // 4 x 4 patches
  EXPECT_EQ(division.nodes().size(), 16u + 25u);
  division.divide(0);
  EXPECT_EQ(division.nodes().size(), 41u + 4u + 5u);  // four centers; the middle and four middles of sides
  division.divide(1);
  EXPECT_EQ(division.nodes().size(), 50u + 4u + 4u);  // one middle of a side is there
}

/// Every side sends the same share to every side.
class Mixing final : public Exchange {
 public:
  explicit Mixing(double escaped) : escaped_(escaped) {}
  double look(std::uint32_t, std::span<double> shares) override {
    for (double& share : shares) share = (1 - escaped_) / static_cast<double>(shares.size());
    return escaped_;
  }
  void send(const glm::dvec3& exitance) override { sent += exitance; }
  glm::dvec3 sent{0};

 private:
  double escaped_;
};

TEST(radiosity_refinement, of_uniform_light_is_the_geometric_series) {
  constexpr std::size_t count = 60;
  const glm::dvec3 reflectance(0.8, 0.5, 0.1);
  for (const double escaped : {0.0, 0.25}) {
    Refinement refinement(std::vector<PatchSide>(count, {2.5, reflectance}));
    refinement.emit(glm::dvec3(3), std::vector<double>(count, (1 - escaped) / count), escaped);
    Mixing mixing(escaped);
    refinement.refine(mixing, 1e-13, 100000, true, [](double) {});
    const Ledger& ledger = refinement.ledger();
    // Of what arrives rho goes on, and 1 - escaped of that arrives again: absorbed / (1 - rho) is all that ever arrived.
    const glm::dvec3 arrived = 3.0 * (1 - escaped) / (1.0 - reflectance * (1 - escaped));
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(ledger.absorbed[c] / (1 - reflectance[c]), arrived[c], 1e-9);
      EXPECT_NEAR(ledger.absorbed[c] + ledger.unshot[c] + ledger.escaped[c] + ledger.defect[c], 3, 1e-9);
      EXPECT_NEAR(ledger.defect[c], 0, 1e-9);
      // All that arrived and is not absorbed was sent, by sides of 2.5 m^2.
      EXPECT_NEAR(mixing.sent[c] * 2.5, arrived[c] * reflectance[c], 1e-9);
    }
  }
}

// Form factors that sum to 3: three surfaces in the same place, each of which gets what one would. The shot is shared among
// them, and what they are sent is what the ledger has of it.
TEST(radiosity_refinement, shares_a_shot_among_surfaces_in_the_same_place) {
  class Thrice final : public Exchange {
   public:
    double look(std::uint32_t, std::span<double> shares) override {
      for (double& share : shares) share = 3.0 / static_cast<double>(shares.size());
      return 0;
    }
    void send(const glm::dvec3& exitance) override { sent += exitance; }
    glm::dvec3 sent{0};
  } exchange;
  Refinement refinement(std::vector<PatchSide>(6, {1, glm::dvec3(0.5)}));
  refinement.emit(glm::dvec3(6), std::vector<double>(6, 1 / 6.0), 0);
  refinement.refine(exchange, 1e-12, 10000, true, [](double) {});
  EXPECT_NEAR(refinement.ledger().absorbed.x, 6, 1e-9);
  EXPECT_NEAR(refinement.ledger().defect.x, 0, 1e-9);
  EXPECT_NEAR(3 * exchange.sent.x, 3 / (1 - 0.5), 1e-9);  // half of 6, and of that half, and so on, to each of the three
}

// What is kept does not wait: when light goes on once, the end is there with the last shot that is worth it. Of 8 that arrive
// 4 wait in equal parts; after the third shot 1 of 8 is left, an eighth.
TEST(radiosity_refinement, ends_by_what_waits_not_by_what_is_kept) {
  Refinement refinement(std::vector<PatchSide>(4, {1, glm::dvec3(0.5)}));
  refinement.emit(glm::dvec3(8), std::vector<double>{0.25, 0.25, 0.25, 0.25}, 0);
  Mixing mixing(0);
  EXPECT_EQ(refinement.refine(mixing, 0.126, 1000, false, [](double) {}), 3u);
}

TEST(radiosity_refinement, keeps_what_is_got_when_light_goes_on_once) {
  Refinement refinement(std::vector<PatchSide>(4, {1, glm::dvec3(0.5)}));
  refinement.emit(glm::dvec3(8), std::vector<double>{0.25, 0.25, 0.25, 0.25}, 0);
  Mixing mixing(0);
  EXPECT_EQ(refinement.refine(mixing, 0, 1000, false, [](double) {}), 4u);
  // 8 arrive, 4 go on and arrive, 2 of these are kept.
  EXPECT_NEAR(refinement.ledger().unshot.x, 2, 1e-12);
  EXPECT_NEAR(refinement.ledger().absorbed.x, 6, 1e-12);
  EXPECT_NEAR(refinement.ambient().x, 2 / 4.0 / 0.5, 1e-12);
}

}  // namespace radiosity_parts_test
