// Which samples a triangle covers: as many as it must, any as likely as any other, each triangle by itself.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "techniques/stochastic_map/cover.h"

namespace stochastic_cover_test {
using namespace gnomon;
using namespace gnomon::stochastic_map;

constexpr std::uint32_t side = 128, texel_count = side * side;

/// A bit for each sample that is covered.
std::uint64_t covered(std::uint32_t hash, float transmission, std::uint32_t count) {
  std::uint64_t bits = 0;
  for (std::uint32_t s = 0; s < count; ++s) bits |= std::uint64_t{covers(hash, transmission, s, count)} << s;
  return bits;
}

struct Spread {
  double mean = 0, deviation = 0;
};
/// Over the texels of an image, of the share of samples that no triangle of a stack covers. `hash(triangle, column, row)`.
template <class Hash>
Spread free_share(const std::vector<float>& stack, std::uint32_t samples, const Hash& hash) {
  double sum = 0, squares = 0;
  for (std::uint32_t texel = 0; texel < texel_count; ++texel) {
    std::uint64_t bits = 0;
    for (std::uint32_t k = 0; k < stack.size(); ++k) bits |= covered(hash(k, texel % side, texel / side), stack[k], samples);
    const double share = 1 - double(std::popcount(bits)) / samples;
    sum += share;
    squares += share * share;
  }
  const double mean = sum / texel_count;
  return {mean, std::sqrt(std::max(0.0, squares / texel_count - mean * mean))};
}
double binomial(double share, double samples) { return std::sqrt(share * (1 - share) / samples); }

const auto by_triangle = [](std::uint32_t k, std::uint32_t column, std::uint32_t row) {
  return hash_of(k + 17, column, row, 0, 1);
};

// The stack of three surfaces that let 1/2, 3/4 and 1/5 through: .5, .375 and .075 are left behind one, two and all. A mean
// over N texels is off by more than 4 sd / sqrt(N) once in 16,000 times. Independent samples had sd .125, .121 and .066
// with 16.
TEST(stochastic_cover, is_unbiased_for_the_product_and_spreads_less_than_chance) {
  const std::vector<float> stack = {0.5f, 0.75f, 0.2f};
  const double left[] = {0.5, 0.375, 0.075};
  for (const std::uint32_t samples : {5u, 16u, 64u})
    for (std::size_t count = 1; count <= 3; ++count) {
      const double expected = left[count - 1], most = binomial(expected, samples);
      const Spread found =
          free_share({stack.begin(), stack.begin() + static_cast<std::ptrdiff_t>(count)}, samples, by_triangle);
      EXPECT_NEAR(found.mean, expected, 4 * most / std::sqrt(texel_count)) << samples << ' ' << count;
      EXPECT_LT(found.deviation, most) << samples << ' ' << count;
    }
}

// The hash of the texel alone: all cover the same samples, and the densest decides, 1 - .8.
TEST(stochastic_cover, would_be_the_least_share_if_triangles_had_one_hash) {
  const Spread found = free_share({0.5f, 0.75f, 0.2f}, 16, [](std::uint32_t, std::uint32_t column, std::uint32_t row) {
    return hash_of(17, column, row, 0, 1);
  });
  EXPECT_NEAR(found.mean, 0.2, 0.01);
  EXPECT_GT(std::abs(found.mean - 0.075), 4 * binomial(0.075, 16) / std::sqrt(texel_count));
}

// Of 16 samples a surface of 1/2 covers 8 everywhere. Were every draw of 8 out of 16 as likely, two of them would leave 4 free
// in the mean, with variance 8/4 * 8/15; independent samples have sd sqrt(3) of 16. The shuffle does not reach all orders, and
// comes to within a twentieth of the former.
TEST(stochastic_cover, draws_nearly_without_replacement) {
  EXPECT_EQ(free_share({0.5f}, 16, by_triangle).deviation, 0);
  const double even = std::sqrt(2 * 8.0 / 15) / 16;
  EXPECT_NEAR(free_share({0.5f, 0.5f}, 16, by_triangle).deviation, even, even / 20);
}

TEST(stochastic_cover, rounds_up_or_down_and_opaque_covers_all) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const std::uint32_t count = 4 + random.below(most_samples - 3), hash = random.next();
    const auto transmission = static_cast<float>(random.uniform(0, 1));
    const int number = std::popcount(covered(hash, transmission, count));
    const double exact = (1.0 - transmission) * count;
    EXPECT_GT(number + 1 + 1e-5, exact);
    EXPECT_LT(number - 1 - 1e-5, exact);
    EXPECT_EQ(std::popcount(covered(hash, 0, count)), static_cast<int>(count));
    EXPECT_EQ(covered(hash, 1, count), 0u);
  }
}

// Were a sample covered more often than others, layers of several triangles would meet there. Of N texels each of 16 samples is
// covered N/4 times, with sd sqrt(3 N / 16): within 4.5 of them.
TEST(stochastic_cover, every_sample_is_as_likely) {
  for (const std::uint32_t samples : {5u, 12u, 16u, 64u}) {
    std::vector<double> times(samples);
    for (std::uint32_t texel = 0; texel < texel_count; ++texel)
      for (std::uint32_t s = 0; s < samples; ++s)
        times[s] += covers(hash_of(5, texel % side, texel / side, 2, 9), 0.75f, s, samples);
    for (const double t : times) EXPECT_NEAR(t, texel_count / 4.0, 4.5 * std::sqrt(3.0 / 16 * texel_count)) << samples;
  }
}

TEST(stochastic_cover, other_seeds_images_and_triangles_cover_others) {
  const auto differ = [](std::uint32_t triangle, std::uint32_t image, std::uint32_t seed) {
    int count = 0;
    for (std::uint32_t texel = 0; texel < texel_count; ++texel)
      count += covered(hash_of(triangle, texel % side, texel / side, image, seed), 0.5f, 16) !=
               covered(hash_of(5, texel % side, texel / side, 0, 1), 0.5f, 16);
    return count;
  };
  // 8 of 16 are the same by chance once in 12,870 times.
  EXPECT_GT(differ(6, 0, 1), texel_count - 20);
  EXPECT_GT(differ(5, 1, 1), texel_count - 20);
  EXPECT_GT(differ(5, 0, 2), texel_count - 20);
  EXPECT_EQ(differ(5, 0, 1), 0);
}

}  // namespace stochastic_cover_test
