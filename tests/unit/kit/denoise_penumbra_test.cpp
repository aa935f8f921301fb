// Widths of penumbrae, and what filters of these widths make of one ray a pixel.
#include <gnomon/kit/denoise/filters.h>
#include <gnomon/kit/denoise/ray_places.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kit/denoise_pictures.h"

namespace gnomon::denoise_penumbra_test {

using denoise_pictures::Shares;
using denoise_pictures::Wall;

TEST(denoise_penumbra, width_of_a_penumbra_follows_from_its_caster) {
  EXPECT_NEAR(penumbra_width(0.15f, 4, 1), 0.1, 1e-6);  // .3 * 1 / 3
  EXPECT_NEAR(penumbra_width(0.15f, 4, 4), 0.3 * 1024, 1e-3);
  EXPECT_EQ(penumbra_width(0.15f, 4, 0), 0);
  EXPECT_NEAR(sigma_of_width(12), 1.8, 1e-6);
  EXPECT_NEAR(sigma_of_width(96), 7.2, 1e-5);  // eight times as wide
  EXPECT_EQ(sigma_of_width(0), 0);
}

TEST(denoise_penumbra, footprint_is_a_pixel_at_the_points_depth) {
  Wall wall(30, 20);
  wall.pz[wall.at(2, 3)] = -5;  // twice as deep
  const FilterGuides guides = wall.guides();
  EXPECT_NEAR(guides.footprint(15, 10), wall.pixel(), 1e-6);
  EXPECT_NEAR(guides.footprint(2, 3), 2 * wall.pixel(), 1e-6);
}

TEST(denoise_penumbra, half_of_the_pixels_stand_for_those_on_their_surface) {
  Wall wall(5, 3);
  wall.faces[wall.at(0, 0)] = 0;
  wall.mesh[wall.at(3, 0)] = 1;
  wall.pz[wall.at(3, 1)] = -50;
  wall.nx[wall.at(2, 1)] = 1;
  wall.nz[wall.at(2, 1)] = 0;
  const FilterGuides fine = wall.guides();
  FilterGuides half;
  half.halve(fine);
  ASSERT_EQ(half.width(), 3);
  ASSERT_EQ(half.height(), 2);
  EXPECT_TRUE(half.counts(2, 1));
  EXPECT_EQ(half.footprint(0, 0), fine.footprint(1, 0));  // the first that counts, of its own size
  EXPECT_FALSE(fine.joins(0, 0, half, {0, 0}));
  EXPECT_TRUE(fine.joins(1, 1, half, {0, 0}));
  EXPECT_TRUE(fine.joins(2, 0, half, {1, 0}));
  EXPECT_FALSE(fine.joins(3, 0, half, {1, 0}));  // another mesh
  EXPECT_FALSE(fine.joins(3, 1, half, {1, 0}));  // off the plane
  EXPECT_FALSE(fine.joins(2, 1, half, {1, 0}));  // turned away
}

struct Errors {
  double before, after;
};

/// Root mean square in a straight penumbra down the middle of 96 x 96 pixels, at one ray a pixel of a square light whose near
/// part is hidden: the share is a ramp.
Errors errors(RayPattern pattern, float width, bool to_the_right) {
  const Wall wall(96, 96);
  const RayPlaces places(pattern, 1);
  const auto share = [&](int x) {
    const float ramp = std::clamp((static_cast<float>(x) - 47.5f) / width + 0.5f, 0.0f, 1.0f);
    return to_the_right ? ramp : 1 - ramp;
  };
  Shares shares(wall.size());
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) shares.numerators[wall.at(x, y)] = places.place(x, y, 0, 0).x < share(x) ? 1.0f : 0.0f;
  const auto error = [&] {
    double squares = 0;
    int count = 0;
    for (int y = 0; y < 96; ++y)
      for (int x = 0; x < 96; ++x) {
        if (share(x) <= 0 || share(x) >= 1) continue;
        squares += std::pow(shares.numerators[wall.at(x, y)] - share(x), 2);
        ++count;
      }
    return std::sqrt(squares / count);
  };
  const double before = error();
  GuidedFilter filter;
  shares.run_by_sigma(filter, wall.guides(), std::vector<float>(wall.size(), sigma_of_width(width)));
  return {before, error()};
}

TEST(denoise_penumbra, one_ray_is_off_by_at_most_3_percent_in_wide_penumbrae) {
  for (const RayPattern pattern : {RayPattern::blue, RayPattern::r2})
    for (const float width : {24.0f, 48.0f, 64.0f})
      for (const bool to_the_right : {true, false})
        EXPECT_LE(errors(pattern, width, to_the_right).after, 0.03)
            << ray_pattern_names[static_cast<int>(pattern)] << ' ' << width << ' ' << to_the_right;
}

TEST(denoise_penumbra, even_patterns_beat_white_noise) {
  const double white = errors(RayPattern::white, 24, true).after;
  EXPECT_LT(errors(RayPattern::blue, 24, true).after, 0.75 * white);
  EXPECT_LT(errors(RayPattern::r2, 24, true).after, 0.75 * white);
}

TEST(denoise_penumbra, contacts_are_no_worse_than_unfiltered) {
  for (const RayPattern pattern : {RayPattern::blue, RayPattern::r2, RayPattern::white})
    for (const float width : {1.2f, 2.0f, 3.0f, 4.0f}) {
      const Errors found = errors(pattern, width, true);
      EXPECT_LE(found.after, found.before) << ray_pattern_names[static_cast<int>(pattern)] << ' ' << width;
    }
}

// Square lamp of half side 1 one meter above, point 2 m to the side: at place (s, t) the irradiance is as 1 / r^4, with r^2 = 1
// + (2 + s)^2 + t^2. The nearer half, s < 0, is hidden; the rest gives .17388 of all.
TEST(denoise_penumbra, ratio_of_sums_is_the_share_of_irradiance) {
  const Wall wall(191, 191);
  const RayPlaces places(RayPattern::white, 1);
  Shares shares(wall.size());
  for (int y = 0; y < 191; ++y)
    for (int x = 0; x < 191; ++x) {
      const glm::vec2 place = 2.0f * places.place(x, y, 0, 0) - 1.0f;
      const float square = 1 + (2 + place.x) * (2 + place.x) + place.y * place.y;
      shares.denominators[wall.at(x, y)] = 1 / (square * square);
      shares.numerators[wall.at(x, y)] = place.x > 0 ? 1 / (square * square) : 0;
    }
  GuidedFilter filter;
  shares.run(filter, wall.guides(), atrous_rule, 0, 5);
  const std::size_t middle = wall.at(95, 95);
  EXPECT_NEAR(shares.numerators[middle] / shares.denominators[middle], 0.17388,
              0.02);  // four deviations: .015 of one ray's .31
}

TEST(denoise_penumbra, variance_comes_from_7x7_pixels_where_history_is_short) {
  const Wall wall(40, 20);
  Shares shares(wall.size(), 1);
  std::vector<float> history(wall.size(), 3);
  for (int y = 0; y < 20; ++y)
    for (int x = 20; x < 40; ++x) shares.numerators[wall.at(x, y)] = static_cast<float>((x + y) % 2);
  history[wall.at(31, 9)] = 4;
  std::fill(shares.variance.begin(), shares.variance.end(), 9.0f);
  spread_variance(wall.guides(), shares.numerators, shares.denominators, shares.variance, history);
  EXPECT_EQ(shares.variance[wall.at(5, 5)], 0);
  EXPECT_NEAR(shares.variance[wall.at(30, 10)], 24.0 * 25 / (49 * 49), 1e-6);  // 24 or 25 of 49 are lit
  EXPECT_NEAR(shares.variance[wall.at(39, 19)], 0.25, 1e-6);                   // 8 of 16 in the corner
  EXPECT_EQ(shares.variance[wall.at(31, 9)], 9);
}

}  // namespace gnomon::denoise_penumbra_test
