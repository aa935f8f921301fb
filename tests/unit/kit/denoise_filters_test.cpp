// What levels of filters leave of an impulse, which pixels they mix, and that they are linear.
#include <gnomon/error.h>
#include <gnomon/kit/denoise/filters.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kit/denoise_pictures.h"

namespace gnomon::denoise_filters_test {

using denoise_pictures::Shares;
using denoise_pictures::Wall;

std::vector<float> noise(std::size_t size, std::uint64_t seed) {
  Random random(seed);
  std::vector<float> result(size);
  for (float& value : result) value = static_cast<float>(random.uniform(0, 1));
  return result;
}

/// What is left of the deviation of white noise, and the deviation of a row of the impulse's picture.
struct Response {
  double noise, sigma;
};
Response response(const Wall& wall, const std::vector<float>& picture) {
  double squares = 0, sum = 0, moment = 0;
  for (int y = 0; y < wall.height; ++y)
    for (int x = 0; x < wall.width; ++x) {
      const double value = picture[wall.at(x, y)], off = x - wall.width / 2;
      squares += value * value;
      sum += value;
      moment += value * off * off;
    }
  EXPECT_NEAR(sum, 1, 1e-4);
  return {std::sqrt(squares), std::sqrt(moment)};
}

TEST(denoise_filters, levels_leave_the_noise_of_their_taps) {
  const Wall wall(191, 191);  // 62 pixels to where the impulse reaches, and 32 more to the last taps
  const FilterGuides guides = wall.guides();
  GuidedFilter filter;
  constexpr double left[] = {.2734, .1235, .0604, .0300, .0150}, sigma[] = {1, 2.24, 4.58, 9.22, 18.47};
  for (int levels = 1; levels <= 5; ++levels) {
    Shares shares(wall.size());
    shares.numerators[wall.at(95, 95)] = 1;
    shares.run(filter, guides, atrous_rule, 0, levels);
    const Response found = response(wall, shares.numerators);
    EXPECT_NEAR(found.noise, left[levels - 1], 6e-5) << levels;
    EXPECT_NEAR(found.sigma, sigma[levels - 1], 6e-3) << levels;
  }
}

TEST(denoise_filters, impulse_spreads_by_the_sigma_of_its_pixels) {
  const Wall wall(191, 191);
  const FilterGuides guides = wall.guides();
  GuidedFilter filter;
  for (const float sigma : {0.5f, 1.0f, 1.8f, 4.0f, 10.0f}) {
    Shares shares(wall.size());
    shares.numerators[wall.at(95, 95)] = 1;
    shares.run_by_sigma(filter, guides, std::vector<float>(wall.size(), sigma));
    EXPECT_NEAR(response(wall, shares.numerators).sigma, sigma, 2e-3 * sigma);
  }
}

TEST(denoise_filters, passes_of_tiles_have_nine_taps) {
  const Wall wall(32, 32);
  Shares shares(wall.size());
  shares.numerators[wall.at(10, 20)] = 1;
  GuidedFilter filter;
  FilterRule rule = tile_rule;
  rule.value_deviations = 0;
  shares.run(filter, wall.guides(), rule, 1, 2);
  // (2/3, 1, 2/3) has the sum 7/3; the step is 2.
  EXPECT_NEAR(shares.numerators[wall.at(10, 20)], 9.0 / 49, 1e-6);
  EXPECT_NEAR(shares.numerators[wall.at(12, 20)], 6.0 / 49, 1e-6);
  EXPECT_NEAR(shares.numerators[wall.at(8, 18)], 4.0 / 49, 1e-6);
  EXPECT_EQ(shares.numerators[wall.at(11, 20)], 0);
}

/// Three meshes with waves in position and normal, and holes that do not count.
Wall rough_wall(int width, int height) {
  Wall wall(width, height);
  Random random(3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = wall.at(x, y);
      wall.mesh[i] = x < 30 ? 0 : y < 25 ? 1 : 2;
      wall.pz[i] = static_cast<float>(0.3 * std::sin(0.2 * x) * wall.pixel());
      wall.nx[i] = static_cast<float>(random.uniform(-0.05, 0.05));
      wall.nz[i] = std::sqrt(1 - wall.nx[i] * wall.nx[i]);
      wall.faces[i] = random.uniform(0, 1) < 0.9 ? 1 : 0;
      if (random.uniform(0, 1) < 0.05) wall.mesh[i] = no_mesh;
    }
  return wall;
}

TEST(denoise_filters, constants_stay) {
  const Wall wall = rough_wall(77, 51);
  for (const FilterRule& rule : {atrous_rule, svgf_rule, tile_rule}) {
    Shares shares(wall.size(), 0.3f);
    GuidedFilter filter;
    shares.run(filter, wall.guides(), rule, 0, rule.reach == 2 ? 5 : 3);
    for (const float value : shares.numerators) ASSERT_NEAR(value, 0.3f, 1e-6);
    for (const float value : shares.denominators) ASSERT_NEAR(value, 1, 2e-6);
  }
}

TEST(denoise_filters, followers_pass_through_the_weights_of_the_first) {
  const Wall wall = rough_wall(77, 51);
  const FilterGuides guides = wall.guides();
  GuidedFilter filter;
  const std::vector<float> first = noise(wall.size(), 1), x = noise(wall.size(), 2), y = noise(wall.size(), 3);
  std::vector<float> mixed(wall.size());
  for (std::size_t i = 0; i < mixed.size(); ++i) mixed[i] = 0.7f * x[i] - 0.2f * y[i];

  // More planes than are summed up at once.
  std::vector<std::vector<float>> planes{first, x, first, y, mixed, first};
  std::vector<std::span<float>> spans(planes.begin(), planes.end());
  std::vector<float> denominators = noise(wall.size(), 4), variance(wall.size(), 0.1f);
  const std::vector<float> asked = denominators;
  filter.run(guides, svgf_rule, 0, 5, {.denominators = denominators, .numerators = spans, .variance = variance});
  EXPECT_EQ(planes[0], planes[2]);
  EXPECT_EQ(planes[0], planes[5]);
  for (std::size_t i = 0; i < mixed.size(); ++i)
    ASSERT_NEAR(planes[4][i], 0.7f * planes[1][i] - 0.2f * planes[3][i], 2e-6) << i;

  // And again in a run of their own.
  std::vector<std::vector<float>> later{first, y};
  std::vector<std::span<float>> later_spans(later.begin(), later.end());
  std::vector<float> same = asked, same_variance(wall.size(), 0.1f);
  filter.run(guides, svgf_rule, 0, 5, {.denominators = same, .numerators = later_spans, .variance = same_variance});
  EXPECT_EQ(later[0], planes[0]);
  EXPECT_EQ(later[1], planes[3]);
  EXPECT_EQ(same, denominators);
  EXPECT_EQ(same_variance, variance);
}

TEST(denoise_filters, other_meshes_creases_and_steps_do_not_mix) {
  enum { meshes, crease, step };
  for (const int kind : {meshes, crease, step}) {
    Wall wall(64, 64);
    Shares shares(wall.size());
    for (int y = 0; y < 64; ++y)
      for (int x = 32; x < 64; ++x) {
        const std::size_t i = wall.at(x, y);
        shares.numerators[i] = 1;
        if (kind == meshes) wall.mesh[i] = 1;
        if (kind == crease) wall.nx[i] = 1;
        if (kind == crease) wall.nz[i] = 0;
        if (kind == step) wall.pz[i] = -1000 * wall.pixel();  // 72 of its own footprints: weights of 2e-5
      }
    GuidedFilter filter;
    shares.run(filter, wall.guides(), atrous_rule, 0, 5);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) ASSERT_NEAR(shares.numerators[wall.at(x, y)], x < 32 ? 0 : 1, kind == step ? 1e-4 : 1e-6);
  }
}

TEST(denoise_filters, pixels_that_do_not_count_stay_and_weigh_nothing) {
  Wall wall(40, 40);
  Shares shares(wall.size(), 0.5f);
  const std::size_t hole = wall.at(20, 20), edge = wall.at(0, 39);
  wall.faces[hole] = 0;
  wall.mesh[edge] = no_mesh;
  shares.numerators[hole] = std::numeric_limits<float>::quiet_NaN();
  shares.numerators[edge] = 7;
  GuidedFilter filter;
  shares.run(filter, wall.guides(), svgf_rule, 0, 5);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    if (i == hole || i == edge) continue;
    ASSERT_NEAR(shares.numerators[i], 0.5f, 1e-6) << i;
  }
  EXPECT_TRUE(std::isnan(shares.numerators[hole]));
  EXPECT_EQ(shares.numerators[edge], 7);
}

TEST(denoise_filters, pixels_without_strength_or_sigma_stay) {
  const Wall wall(70, 40);
  const std::vector<float> before = noise(wall.size(), 8);
  std::vector<float> strength(wall.size(), 1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 35; ++x) strength[wall.at(x, y)] = 0;
  for (const bool by_sigma : {false, true}) {
    Shares shares(wall.size());
    shares.numerators = before;
    GuidedFilter filter;
    if (by_sigma)
      shares.run_by_sigma(filter, wall.guides(), strength);
    else
      shares.run(filter, wall.guides(), tile_rule, 0, 3, strength);
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 70; ++x) {
        const std::size_t i = wall.at(x, y);
        ASSERT_EQ(shares.numerators[i] == before[i], x < 35) << x << ' ' << y;
      }
  }
}

TEST(denoise_filters, values_without_variance_keep_their_edges) {
  const Wall wall(64, 64);
  for (const float variance : {0.0f, 0.25f}) {
    Shares shares(wall.size());
    std::fill(shares.variance.begin(), shares.variance.end(), variance);
    for (int y = 0; y < 64; ++y)
      for (int x = 32; x < 64; ++x) shares.numerators[wall.at(x, y)] = 1;
    GuidedFilter filter;
    shares.run(filter, wall.guides(), svgf_rule, 0, 1);
    if (variance == 0) {
      EXPECT_NEAR(shares.numerators[wall.at(32, 30)], 1, 1e-6);
    } else {
      EXPECT_LT(shares.numerators[wall.at(32, 30)], 0.8);  // (1/4 + 1/16) exp(-1/2) = .19 of its weight is dark
    }
  }
}

TEST(denoise_filters, variance_falls_with_the_squares_of_the_weights) {
  const Wall wall(64, 64);
  Shares shares(wall.size(), 0.5f);
  GuidedFilter filter;
  shares.run(filter, wall.guides(), svgf_rule, 0, 1);
  EXPECT_NEAR(shares.variance[wall.at(30, 30)], 0.25 * std::pow(70.0 / 256, 2), 1e-6);
}

TEST(denoise_filters, mask_is_the_same_by_any_number_of_threads) {
  const Wall wall = rough_wall(131, 67);
  const std::vector<float> before = noise(wall.size(), 11);
  std::vector<Shares> found;
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    const FilterGuides guides = wall.guides();
    Shares& shares = found.emplace_back(wall.size());
    shares.numerators = before;
    GuidedFilter filter;
    spread_variance(guides, shares.numerators, shares.denominators, shares.variance);
    shares.run(filter, guides, svgf_rule, 0, 5);
    shares.run_by_sigma(filter, guides, std::vector<float>(wall.size(), 3.3f));
  }
  EXPECT_EQ(found[0].numerators, found[1].numerators);
  EXPECT_EQ(found[0].variance, found[1].variance);
}

TEST(denoise_filters, sizes_and_levels_that_do_not_fit_are_refused) {
  const Wall wall(16, 16);
  const FilterGuides guides = wall.guides();
  GuidedFilter filter;
  Shares shares(wall.size()), small(wall.size() - 1);
  EXPECT_THROW(shares.run(filter, guides, atrous_rule, 0, 6), Error);
  EXPECT_THROW(shares.run(filter, guides, atrous_rule, -1, 2), Error);
  EXPECT_THROW(small.run(filter, guides, atrous_rule, 0, 1), Error);
  EXPECT_THROW(shares.run(filter, guides, atrous_rule, 0, 1, small.numerators), Error);
  EXPECT_THROW(shares.run_by_sigma(filter, guides, small.numerators), Error);
  EXPECT_THROW(spread_variance(guides, small.numerators, shares.denominators, shares.variance), Error);
  EXPECT_THROW(FilterGuides().make(wall.gbuffer(), std::span(wall.faces).first(3)), Error);
}

TEST(denoise_filters, memory_does_not_grow_at_the_same_size) {
  const Wall wall(40, 30);
  FilterGuides guides = wall.guides();
  GuidedFilter filter;
  Shares shares(wall.size(), 0.5f);
  shares.run(filter, guides, svgf_rule, 0, 5);
  const std::size_t bytes = filter.bytes(), guide_bytes = guides.bytes();
  EXPECT_EQ(guide_bytes, (40u + 64) * 30 * 36);
  EXPECT_EQ(bytes, (8u * (40 + 64) + 40) * 30 * 4);  // twice two planes and a variance, two for values; strengths
  guides.make(wall.gbuffer(), wall.faces);
  shares.run(filter, guides, svgf_rule, 0, 5);
  EXPECT_EQ(filter.bytes(), bytes);
  EXPECT_EQ(guides.bytes(), guide_bytes);
}

}  // namespace gnomon::denoise_filters_test
