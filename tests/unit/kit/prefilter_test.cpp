#include <gnomon/kit/maps/prefilter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace prefilter_test {
using namespace gnomon;

using Weights = std::map<std::pair<int, int>, double>;

/// Of texels that are there twice, together.
Weights weights_of(const Prefilter& filter, const glm::dvec2& place, const glm::dmat2& pixel, int resolution = 64) {
  Weights weights;
  for (const auto& [texel, weight] : filter.texels(place, pixel, resolution)) weights[{texel.x, texel.y}] += weight;
  return weights;
}

double sum_of(const Weights& weights) {
  double sum = 0;
  for (const auto& [texel, weight] : weights) sum += weight;
  return sum;
}

const glm::dmat2 small_pixel(0.1, 0, 0, 0.1);

// Between four means of 5 x 5 texels, at shares s and t between them, the outer columns count 1 - s and s of the inner ones:
// that is a box of five texels' width around the place.
TEST(Prefilter, a_narrow_table_is_a_blur_by_a_box) {
  for (const glm::dvec2 place : {glm::dvec2(20.3, 31.9), glm::dvec2(17.5, 20), glm::dvec2(40.01, 11.49)}) {
    const Weights blur = weights_of({.kind = Prefilter::Kind::blur, .radius = 2}, place, small_pixel);
    const Weights table = weights_of({.kind = Prefilter::Kind::table, .radius = 2, .widest_footprint = 16}, place, small_pixel);
    EXPECT_EQ(blur.size(), table.size());
    for (const auto& [texel, weight] : blur) EXPECT_NEAR(weight, table.at(texel), 1e-7);
  }
}

// A pixel 8 texels long and 3 wide, along the axes, around (20.5, 30): columns 16.5 .. 24.5 of rows 28.5 .. 31.5.
TEST(Prefilter, the_box_of_a_table_is_the_one_around_the_footprint) {
  const Weights weights =
      weights_of({.kind = Prefilter::Kind::table, .radius = 0, .widest_footprint = 16}, {20.5, 30}, {{8, 0}, {0, -3}});
  EXPECT_EQ(weights.size(), 9u * 4u);
  EXPECT_NEAR(weights.at({20, 30}), 1 / 24.0, 1e-12);
  EXPECT_NEAR(weights.at({16, 30}), 0.5 / 24, 1e-12);
  EXPECT_NEAR(weights.at({16, 28}), 0.25 / 24, 1e-12);
  EXPECT_NEAR(weights.at({24, 31}), 0.25 / 24, 1e-12);
  EXPECT_NEAR(sum_of(weights), 1, 1e-12);
  // Of one that lies across, the box around both diagonals; no wider than allowed.
  EXPECT_EQ(weights_of({.kind = Prefilter::Kind::table, .widest_footprint = 16}, {20, 20}, {{3, 3}, {-3, 3}}).size(), 36u);
  EXPECT_EQ(weights_of({.kind = Prefilter::Kind::table, .widest_footprint = 4}, {20, 20}, {{300, 3}, {-3, 300}}).size(), 16u);
}

// A footprint of 4 texels reads level 2. In the middle of one of its texels, 8 .. 12, that one alone; a quarter of a texel of
// the level on, three quarters of it and a quarter of the next.
TEST(Prefilter, mips_weigh_two_by_two_of_each_of_two_levels) {
  const Prefilter mips{.kind = Prefilter::Kind::mips, .radius = 0, .widest_footprint = 16};
  const Weights middle = weights_of(mips, {10, 10}, {{4, 0}, {0, 1}});
  EXPECT_EQ(middle.size(), 16u);
  for (const auto& [texel, weight] : middle) EXPECT_NEAR(weight, 1 / 16.0, 1e-12);
  const Weights aside = weights_of(mips, {11, 10}, {{4, 0}, {0, 1}});
  EXPECT_EQ(aside.size(), 32u);
  EXPECT_NEAR(aside.at({8, 9}), 0.75 / 16, 1e-12);
  EXPECT_NEAR(aside.at({12, 9}), 0.25 / 16, 1e-12);
  // Half way to level 3, at sqrt 32: half of each. Around (12, 12), the middle of 8 .. 16, level 2 has a quarter of four
  // texels.
  const Weights between = weights_of(mips, {12, 12}, {{0, std::sqrt(32.0)}, {1, 0}});
  EXPECT_EQ(between.size(), 64u);
  for (const auto& [texel, weight] : between) EXPECT_NEAR(weight, 1 / 64.0, 1e-12);
}

// Along one axis a box of five texels has a mean square distance of 5^2 / 12, the texels' own width included, and the weights
// between two texels add 1/6 in the mean over places: 2.25. Level k has 4^k / 12 + 4^k / 6 = 4^k / 4; radius 2 reads level
// log2(5 / sqrt 3) = 1.53, between 1 and 4, by 0.47 and 0.53: 2.59.
TEST(Prefilter, mips_spread_as_much_as_the_blur_up_to_what_two_levels_add) {
  const auto square = [](const Prefilter& filter) {
    double sum = 0;
    constexpr int places = 64;
    for (int k = 0; k < places; ++k) {
      const glm::dvec2 place(28 + 8 * (k + 0.5) / places, 32);
      for (const auto& [texel, weight] : weights_of(filter, place, small_pixel))
        sum += weight * (std::pow(texel.first + 0.5 - place.x, 2) + 1 / 12.0) / places;
    }
    return sum;
  };
  EXPECT_NEAR(square({.kind = Prefilter::Kind::table, .radius = 2}), 2.25, 0.01);
  EXPECT_NEAR(square({.kind = Prefilter::Kind::mips, .radius = 2}), 0.47 * 1 + 0.53 * 4, 0.05);
  EXPECT_EQ((Prefilter{.kind = Prefilter::Kind::mips, .radius = 0}.narrowest()), 1);
}

TEST(Prefilter, weights_add_up_to_one_and_reach_no_farther_than_the_margin) {
  for (const Prefilter::Kind kind : {Prefilter::Kind::blur, Prefilter::Kind::mips, Prefilter::Kind::table})
    for (const int radius : {0, 2, 5})
      for (const int footprint : {1, 6, 16})
        for (const glm::dmat2& pixel : {small_pixel, glm::dmat2(3, 2, -1, 5), glm::dmat2(1e9, 0, 3, 1e-9), glm::dmat2(NAN)}) {
          const Prefilter filter{.kind = kind, .radius = radius, .widest_footprint = footprint};
          // Every place of the part that a fit uses.
          for (int k = 0; k < 50; ++k) {
            const glm::dvec2 place =
                double(filter.margin()) + (128 - 2.0 * filter.margin()) * glm::dvec2(k / 49.0, 1 - k / 49.0);
            const Weights weights = weights_of(filter, place, pixel, 128);
            EXPECT_NEAR(sum_of(weights), 1, 1e-6);
            for (const auto& [texel, weight] : weights) {
              EXPECT_GE(std::min(texel.first, texel.second), 0);
              EXPECT_LT(std::max(texel.first, texel.second), 128);
            }
          }
        }
}

TEST(Prefilter, levels_that_do_not_lie_on_each_other_and_tables_of_cubes_are_refused) {
  const Light sun{.name = "sun", .kind = DirectionalLight{}}, point{.name = "point", .kind = PointLight{}};
  const Light narrow{.name = "spot", .kind = SpotLight{.outer_degrees = 40}},
      wide{.name = "spot", .kind = SpotLight{.outer_degrees = 80}};
  const Prefilter mips{.kind = Prefilter::Kind::mips, .widest_footprint = 16}, table{.kind = Prefilter::Kind::table};
  for (const Light& light : {sun, point, narrow, wide}) {
    EXPECT_TRUE(mips.supports(light, 1008));
    EXPECT_NE(mips.supports(light, 1000).why().find("a resolution that 16 divides: 1000 is none"), std::string::npos);
    EXPECT_TRUE(Prefilter{}.supports(light, 1001));
  }
  for (const Light& light : {sun, narrow}) EXPECT_TRUE(table.supports(light, 1001));
  for (const Light& light : {point, wide}) EXPECT_FALSE(table.supports(light, 1024));
}

// Sums over the widest box, begun and ended within a texel, of all values 1.
TEST(Prefilter, sums_over_the_widest_box_fit_32_bits) {
  for (const int footprint : {1, 5, 16, 64}) {
    const Prefilter table{.kind = Prefilter::Kind::table, .radius = 2, .widest_footprint = footprint};
    const double side = table.widest() + 2, largest = side * side * (table.whole() + 0.5);
    EXPECT_LT(largest * (1 + 0x1p-23), 0x1p32);
    EXPECT_GT(largest, 0x1p31);
  }
}

// Against the ray of the next half pixel on both sides, met with the plane: central differences are off by squares of a pixel.
TEST(Prefilter, a_pixel_on_the_image_is_the_derivative_over_its_plane) {
  const View view{.eye = {0, 3, 7}, .target = {0, 0.5f, 0}};
  const Camera camera(view, 64000, 48000);
  const glm::dvec3 normal = glm::normalize(glm::dvec3(0.2, 1, 0.1)), on(0, 0.25, 0);
  const auto meets = [&](double x, double y) {
    const glm::dvec3 ray = camera.ray(x, y);
    return camera.eye + ray * (glm::dot(normal, on - camera.eye) / glm::dot(normal, ray));
  };
  const Light lights[] = {{.name = "sun", .kind = DirectionalLight{{0.3f, -1, 0.2f}}},
                          {.name = "point", .kind = PointLight{{1, 4, 0.5f}}},
                          {.name = "spot", .kind = SpotLight{{1, 4, 0.5f}, {-0.2f, -1, 0}, 30, 50}}};
  const MeshBoxes boxes{.meshes = {{.bounds = {.min = glm::vec3(-3), .max = glm::vec3(3)}, .casts = true, .receives = true}},
                        .extent = 3};
  for (const Light& light : lights)
    for (const glm::dvec2 at : {glm::dvec2(30000, 30000), glm::dvec2(20000, 40000), glm::dvec2(50000, 20000)}) {
      const LightSpace space = light_space_of(light, boxes);
      const glm::dvec3 point = meets(at.x, at.y);
      const LightImage image{.scale = glm::dvec2(512, 700), .offset = glm::dvec2(20, 30)};
      LightImage placed = image;
      static_cast<LightSpaceFace&>(placed) = space[space.face_of(point)];
      const auto place = [&](double x, double y) { return placed.place_of(meets(x, y)) * placed.scale; };
      const glm::dmat2 pixel = pixel_on_image(placed, camera, point, normal);
      const glm::dvec2 right = place(at.x + 0.5, at.y) - place(at.x - 0.5, at.y),
                       down = place(at.x, at.y + 0.5) - place(at.x, at.y - 0.5);
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR(pixel[0][axis], right[axis], 1e-5 * glm::length(right));
        EXPECT_NEAR(pixel[1][axis], down[axis], 1e-5 * glm::length(down));
      }
    }
}

TEST(Prefilter, ways_across_a_footprint_are_its_longest_and_its_shortest) {
  const glm::dvec2 turned = squared_ways(glm::dmat2(0.6, 0.8, -0.8, 0.6) * glm::dmat2(3, 0, 0, 2));
  EXPECT_NEAR(turned.x, 9, 1e-12);
  EXPECT_NEAR(turned.y, 4, 1e-12);
}

}  // namespace prefilter_test
