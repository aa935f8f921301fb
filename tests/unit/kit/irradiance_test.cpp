// What lights give without casters: closed forms of the literature, and sums over many small pieces.
#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/irradiance.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace irradiance_test {

using namespace gnomon;
constexpr double pi = std::numbers::pi;
const glm::dvec3 up{0, 1, 0};

void expect_close(double value, double right, double share = 1e-9) { EXPECT_NEAR(value, right, share * right); }

TEST(irradiance, of_a_point_falls_with_the_square_of_the_distance_and_the_cosine) {
  const Light light{.kind = PointLight{{1, 4, 1}}, .intensity = 5};
  const glm::dvec3 to{1, 4, 1};
  expect_close(irradiance(light, {0, 0, 0}, up), 5 * 4 / std::pow(glm::length(to), 3));
  EXPECT_EQ(irradiance(light, {0, 0, 0}, -up), 0);
  EXPECT_EQ(irradiance(light, {0, 4, 0}, up), 0) << "edge-on";
  EXPECT_EQ(irradiance(light, {1, 4, 1}, up), 0) << "at the light itself";
}

TEST(irradiance, of_a_directional_light_is_its_intensity_times_the_cosine) {
  const Light light{.kind = DirectionalLight{{3, -4, 0}}, .intensity = 10};
  expect_close(irradiance(light, {7, 100, -3}, up), 8);
  EXPECT_EQ(irradiance(light, {0, 0, 0}, -up), 0);
}

TEST(irradiance, of_a_spot_is_whole_in_its_inner_cone_and_fades_to_its_outer_one) {
  const Light light{.kind = SpotLight{.position = {0, 2, 0}, .direction = {0, -3, 0}, .inner_degrees = 20, .outer_degrees = 40},
                    .intensity = 8};
  const auto at = [&](double degrees) {
    const double aside = 2 * std::tan(glm::radians(degrees)), cosine = std::cos(glm::radians(degrees));
    return irradiance(light, {aside, 0, 0}, up) / (8 * std::pow(cosine, 3) / 4);
  };
  expect_close(at(0), 1);
  expect_close(at(19.9), 1);
  const double inner = std::cos(glm::radians(20.0)), outer = std::cos(glm::radians(40.0));
  expect_close(at(30), std::pow((std::cos(glm::radians(30.0)) - outer) / (inner - outer), 2), 1e-6);
  EXPECT_EQ(at(40.1), 0);
}

TEST(irradiance, of_a_narrow_spot_is_whole_on_its_axis_and_ends_where_both_cones_do) {
  for (const float outer : {0.02f, 1.0f, 2.0f}) {
    const Light fading{.kind = SpotLight{{0, 2, 0}, {0, -1, 0}, 0.5f * outer, outer}, .intensity = 8};
    const Light sharp{.kind = SpotLight{{0, 2, 0}, {0, -1, 0}, outer, outer}, .intensity = 8};
    for (const Light& light : {fading, sharp}) EXPECT_EQ(irradiance(light, {0, 0, 0}, up), 2) << outer;
    const double inside = 2 * std::tan(glm::radians(0.99 * outer)), outside = 2 * std::tan(glm::radians(1.01 * outer));
    expect_close(irradiance(sharp, {inside, 0, 0}, up), 2 * std::pow(std::cos(glm::radians(0.99 * outer)), 3));
    EXPECT_EQ(irradiance(sharp, {outside, 0, 0}, up), 0);
  }
}

// A figure so small that it is one place, whatever float32 can hold.
TEST(irradiance, of_tiny_and_of_far_lights_keeps_its_digits) {
  for (const float half : {1e-3f, 1e-5f, 1e-6f, 1e-9f, 1e-12f, 1e-15f}) {
    const double side = half;
    const Light rect{.kind = RectLight{.center = {0, 2, 0}, .half_u = {half, 0, 0}, .half_v = {0, 0, half}}};
    expect_close(irradiance(rect, {0, 0, 0}, up) / (side * side), 4.0 / 4, 2e-6);
    const Light disc{.kind = DiscLight{.center = {0, 2, 0}, .normal = {0, -1, 0}, .radius = half}};
    expect_close(irradiance(disc, {0, 0, 0}, up) / (side * side), pi / 4, 2e-6);
    const Light sphere{.kind = SphereLight{.center = {0, 2, 0}, .radius = half}};
    expect_close(irradiance(sphere, {0, 0, 0}, up) / (side * side), pi / 4, 2e-6);
  }
}

TEST(irradiance, beside_the_rim_of_a_disc_is_a_number_between_nothing_and_all) {
  for (const double off : {1e-3, 1e-6, 1e-9, 1e-12, 0.0})
    for (const double height : {1e-3, 1e-8, 1e-12})
      for (const int sign : {-1, 1}) {
        const Light disc{.kind = DiscLight{.center = {0, 0, 0}, .normal = {0, -1, 0}, .radius = 1}};
        const double value = irradiance(disc, {1 + sign * off, -height, 0}, up);
        EXPECT_TRUE(value >= 0 && value <= pi * (1 + 1e-6)) << off << ' ' << height << ": " << value;
      }
}

// Howell's catalog, B-3: a surface parallel to a rectangle, below one of its corners.
TEST(irradiance, of_a_rectangle_over_its_corner) {
  for (const auto& [a, b, height] : {std::tuple(1.0f, 2.0f, 3.0f), std::tuple(4.0f, 0.5f, 0.25f)}) {
    const Light light{.kind = RectLight{.center = {a / 2, height, b / 2}, .half_u = {a / 2, 0, 0}, .half_v = {0, 0, b / 2}},
                      .intensity = 7};
    const double x = double(a) / height, y = double(b) / height, rx = std::sqrt(1 + x * x), ry = std::sqrt(1 + y * y);
    const double factor = (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * pi);
    expect_close(irradiance(light, {0, 0, 0}, up), 7 * pi * factor);
  }
}

TEST(irradiance, of_a_disc_on_its_axis_and_of_a_sphere) {
  for (const float height : {0.01f, 0.5f, 3.0f, 200.0f}) {
    const Light disc{.kind = DiscLight{.center = {0, height, 0}, .normal = {0, -1, 0}, .radius = 0.5f}, .intensity = 3};
    expect_close(irradiance(disc, {0, 0, 0}, up), 3 * pi * 0.25 / (0.25 + double(height) * height));
  }
  const Light sphere{.kind = SphereLight{.center = {3, 4, 0}, .radius = 1.5f}, .intensity = 2};
  expect_close(irradiance(sphere, {0, 0, 0}, up), 2 * pi * 2.25 / 25 * 0.8);
  EXPECT_EQ(irradiance(sphere, {3, 4, 0.5}, up), 0) << "inside";
}

/// By the midpoints of many small pieces, in squares around the center of a disc or over a rectangle.
double by_pieces(const LightFigure& face) {
  constexpr int count = 1200;
  double sum = 0;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j) {
      glm::dvec2 place(-1 + (2 * i + 1.0) / count, -1 + (2 * j + 1.0) / count);
      double area = 4.0 / count / count;
      if (face.is_disc()) {  // rings and sectors
        const double radius = (i + 0.5) / count, angle = 2 * pi * (j + 0.5) / count;
        place = radius * glm::dvec2(std::cos(angle), std::sin(angle));
        area = radius * 2 * pi / count / count;
      }
      if (face.holds(place)) sum += area * face.weight(face.at(place));
    }
  return sum;
}

// Cut by the horizon, aslant, near and far: against sums of 1.44 million pieces.
TEST(irradiance, of_lights_anywhere_is_the_sum_of_their_pieces) {
  std::mt19937 random(7);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const auto anywhere = [&](double size) {
    return glm::vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  int cut = 0;
  for (int k = 0; k < 24; ++k) {
    Light light;
    const glm::vec3 center = anywhere(2);
    if (k % 3 == 0)
      light.kind = DiscLight{.center = center, .normal = anywhere(1), .radius = float(uniform(0.2, 1.5))};
    else if (k % 3 == 1)
      light.kind = SphereLight{.center = center, .radius = float(uniform(0.1, 0.8) * glm::length(center))};
    else
      light.kind = RectLight{.center = center, .half_u = anywhere(1), .half_v = {0, 0, 0}};
    if (auto* rect = std::get_if<RectLight>(&light.kind)) rect->half_v = glm::cross(rect->half_u, anywhere(1));
    const LightFigure face(light, {0, 0, 0}, up);
    if (!face.is_seen()) continue;
    cut += face.horizon().x < std::abs(face.horizon().y) + std::abs(face.horizon().z);
    const double pieces = by_pieces(face);
    EXPECT_NEAR(face.irradiance(), pieces, 2e-3 * pieces + 1e-6) << k;
  }
  EXPECT_GE(cut, 5);
}

TEST(irradiance, of_a_light_set_to_shine_is_what_was_asked_for) {
  const glm::vec3 point{0.5f, 0, -1};
  for (const LightKind& kind : {LightKind(PointLight{{3, 8, 1}}), LightKind(DirectionalLight{{1, -1, 0}}),
                                LightKind(DiscLight{.center = {1, 5, 2}, .normal = {-1, -1, 0}, .radius = 0.4f}),
                                LightKind(SphereLight{.center = {-22.5f, 25, -50}, .radius = 0.28f})}) {
    const Light light = shining_at(point, {{.kind = kind}}, 0.25)[0];
    const glm::dvec3 toward = glm::normalize(to_light(homogeneous_of_center(light), point));
    expect_close(irradiance(light, point, toward), 0.25, 1e-6);
  }
  // One that does not reach the point keeps 1.
  const Light away{.kind = DiscLight{.center = {0, 5, 0}, .normal = {0, 1, 0}, .radius = 1, .emits = Emits::in_front}};
  EXPECT_EQ(shining_at(point, {away})[0].intensity, 1);
  EXPECT_EQ(shining_at(point, {{.kind = PointLight{point}}})[0].intensity, 1);
}

}  // namespace irradiance_test
