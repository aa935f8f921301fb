// Patterns of few rays a pixel: their first places, their spectrum, and that each is uniform.
#include <gnomon/error.h>
#include <gnomon/kit/denoise/ray_places.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

namespace gnomon::denoise_places_test {

constexpr RayPattern patterns[] = {RayPattern::blue, RayPattern::r2, RayPattern::sobol, RayPattern::white};

void expect_first_places(const glm::dvec2& place, int index) {
  constexpr double expected[][2] = {{.254878, .069840}, {.009755, .639681}, {.764633, .209521}, {.519511, .779361}};
  EXPECT_NEAR(place.x, expected[index][0], 1e-6) << index;
  EXPECT_NEAR(place.y, expected[index][1], 1e-6) << index;
}

TEST(denoise_places, r2_starts_as_published) {
  for (int i = 0; i < 4; ++i) expect_first_places(r2_place(static_cast<std::uint64_t>(i) + 1), i);
}

TEST(denoise_places, first_pixel_of_r2_goes_along_r2_over_rays_and_frames) {
  const RayPlaces places(RayPattern::r2, 2);
  for (int i = 0; i < 4; ++i) expect_first_places(glm::dvec2(places.place(0, 0, static_cast<std::uint32_t>(i / 2), i % 2)), i);
}

TEST(denoise_places, blue_ranks_are_each_there_once) {
  std::vector<std::uint16_t> ranks = blue_noise_ranks(32, 5);
  EXPECT_EQ(ranks, blue_noise_ranks(32, 5));
  EXPECT_NE(ranks, blue_noise_ranks(32, 6));
  std::sort(ranks.begin(), ranks.end());
  for (std::size_t i = 0; i < ranks.size(); ++i) ASSERT_EQ(ranks[i], i);
}

/// Mean power at frequencies up to `most` periods a side, in units of the mean over all frequencies: that of white noise.
double low_power(const std::vector<double>& values, int side, int most) {
  double mean = 0, variance = 0, power = 0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) variance += (value - mean) * (value - mean);
  int count = 0;
  for (int u = 0; u <= most; ++u)
    for (int v = -most; v <= most; ++v) {
      if ((u == 0 && v <= 0) || u * u + v * v > most * most) continue;  // half of the plane, without the mean
      std::complex<double> sum = 0;
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
          sum += (values[static_cast<std::size_t>(y) * side + x] - mean) *
                 std::polar(1.0, 2 * std::numbers::pi * ((u * x + v * y) % side) / side);
      power += std::norm(sum) / variance;
      ++count;
    }
  return power / count;
}

TEST(denoise_places, blue_noise_has_next_to_no_low_frequencies) {
  const RayPlaces blue(RayPattern::blue, 1), white(RayPattern::white, 1);
  for (int way = 0; way < 2; ++way) {
    std::vector<double> of_blue, of_white;
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        of_blue.push_back(std::fmod(blue.place(x, y, 0, 0)[way] + 0.5, 1.0));  // index 0 shifts by one half
        of_white.push_back(white.place(x, y, 0, 0)[way]);
      }
    EXPECT_LT(low_power(of_blue, 64, 8), 0.01);
    EXPECT_GT(low_power(of_white, 64, 8), 0.5);  // about 100 numbers of mean 1
  }
}

TEST(denoise_places, both_ways_of_blue_noise_have_nothing_to_do_with_each_other) {
  const RayPlaces blue(RayPattern::blue, 1);
  double sum = 0;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::vec2 place = blue.place(x, y, 0, 0);
      sum += 12 * (place.x - 0.5) * (place.y - 0.5) / 4096;
    }
  EXPECT_LT(std::abs(sum), 0.08);  // five standard errors of 4096 independent pairs
}

TEST(denoise_places, places_of_every_pattern_are_uniform_over_pixels) {
  for (const RayPattern pattern : patterns)
    for (const std::uint32_t frame : {0u, 7u}) {
      const RayPlaces places(pattern, 3, 9);
      std::array<std::array<int, 8>, 2> bins{};
      for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x) {
          const glm::vec2 place = places.place(x, y, frame, 2);
          for (int way = 0; way < 2; ++way) {
            ASSERT_GE(place[way], 0);
            ASSERT_LT(place[way], 1);
            ++bins[way][static_cast<int>(place[way] * 8)];
          }
        }
      // 512 each, of white noise with a deviation of 21.
      for (const auto& of_way : bins)
        for (const int count : of_way) EXPECT_NEAR(count, 512, 110) << ray_pattern_names[static_cast<int>(pattern)];
    }
}

TEST(denoise_places, sixteen_rays_of_sobol_are_in_sixteen_cells) {
  const RayPlaces places(RayPattern::sobol, 4);
  std::set<int> cells;
  for (std::uint32_t frame = 0; frame < 4; ++frame)
    for (int ray = 0; ray < 4; ++ray) {
      const glm::vec2 place = places.place(17, 3, frame, ray);
      cells.insert(4 * static_cast<int>(place.y * 4) + static_cast<int>(place.x * 4));
    }
  EXPECT_EQ(cells.size(), 16u);
}

TEST(denoise_places, same_seed_gives_same_places_and_frames_differ) {
  for (const RayPattern pattern : patterns) {
    const RayPlaces one(pattern, 2, 3), same(pattern, 2, 3), other(pattern, 2, 4);
    EXPECT_EQ(one.place(5, 70, 2, 1), same.place(5, 70, 2, 1));
    EXPECT_NE(one.place(5, 70, 2, 1), one.place(5, 70, 3, 1));
    if (pattern != RayPattern::r2) {  // it has no random numbers
      EXPECT_NE(one.place(5, 70, 2, 1), other.place(5, 70, 2, 1));
    }
  }
}

TEST(denoise_places, no_rays_are_refused) {
  EXPECT_THROW(RayPlaces(RayPattern::white, 0), Error);
  EXPECT_THROW(blue_noise_ranks(8, 1), Error);
}

}  // namespace gnomon::denoise_places_test
