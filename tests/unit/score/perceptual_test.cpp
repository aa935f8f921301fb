#include "measure/score/perceptual.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <functional>

#include "measure/record/record.h"
#include "places.h"

namespace perceptual_test {

using namespace gnomon;

using Value = std::function<int(bool test, int x, int y, int c)>;

Picture picture(int width, int height, const Value& value, bool test) {
  Picture made{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) made.rgb.push_back(static_cast<std::uint8_t>(value(test, x, y, c)));
  return made;
}

// --- the pictures of tests/data/perceptual/make_expected ---------------------------------------------------------------

std::uint32_t scramble(std::uint32_t n) {
  n *= 0x9E3779B1u;
  n ^= n >> 15;
  n *= 0x85EBCA77u;
  return n ^ (n >> 13);
}

int noise(bool test, int x, int y, int c) {
  return static_cast<int>(scramble(x + 1000 * y + 1000000 * c + 5000000 * test) % 256);
}

int disc(bool test, int x, int y, int c) {
  const int floor = std::array{190, 170, 140}[c] - y / 2, dx = x - 30 - 3 * test, dy = y - 24 - test;
  return dx * dx + dy * dy < 200 ? floor / 4 : floor;
}

int stripes(bool test, int x, int y, int c) {
  const int stripe = x / 7, turn = test && stripe % 3 == 0;
  return (stripe + c + turn) % 3 == 0 ? 255 : 20 + y;
}

int edge(bool test, int x, int, int c) {
  if (test) return 40 + 15 * std::clamp(x - 19, 0, 12) + 2 * c;
  return x > 24 ? 220 + 2 * c : 40 + 2 * c;
}

int speck(bool test, int x, int y, int c) { return test && x == 20 && y == 13 ? 250 : 60 + x + 2 * y + 10 * c; }

int extremes(bool test, int, int, int) { return 255 * test; }

int wide(bool test, int x, int y, int c) {
  const bool here = (x - 120) * (x - 120) + (y - 60) * (y - 60) < 90 || (x < 6 && y > 76);
  return static_cast<int>((scramble(x / 3 + 1000 * (y / 3)) >> (3 * c)) % 200) + (test && here ? 40 : 0);
}

const std::map<std::string, Value> formulas = {{"noise", noise}, {"disc", disc},         {"stripes", stripes}, {"edge", edge},
                                               {"speck", speck}, {"extremes", extremes}, {"wide", wide},       {"tiny", noise}};

TEST(perceptual, agrees_with_implementations_that_share_nothing) {
  std::ifstream file(data_file("perceptual/expected.json"));
  const Json expected = Json::parse(file);
  EXPECT_EQ(expected.size(), formulas.size());
  for (const Json& row : expected) {
    const std::string name = row["name"];
    const auto reference = picture(row["width"], row["height"], formulas.at(name), false);
    const auto test = picture(row["width"], row["height"], formulas.at(name), true);
    const auto similarity = ssim(reference, test);
    ASSERT_EQ(similarity.has_value(), !row["ssim"].is_null()) << name;
    if (similarity) {
      EXPECT_NEAR(*similarity, row["ssim"].get<double>(), 1e-9) << name;
    }
    EXPECT_NEAR(*flip(reference, test), row["flip"].get<double>(), 1e-5) << name;
  }
}

// --- properties ------------------------------------------------------------------------------------------------------

Picture random_picture(int width, int height) {
  Picture made{width, height, {}};
  made.rgb = *rc::gen::container<std::vector<std::uint8_t>>(static_cast<std::size_t>(width) * height * 3,
                                                            rc::gen::arbitrary<std::uint8_t>());
  return made;
}

RC_GTEST_PROP(perceptual, is_symmetric_bounded_and_ideal_for_equal_pictures, ()) {
  const int w = *rc::gen::inRange(1, 40), h = *rc::gen::inRange(1, 30);
  const Picture a = random_picture(w, h), b = random_picture(w, h);
  RC_ASSERT(flip(a, a) == 0.0);
  // A sum of products is rounded differently when its factors change places: not bit for bit.
  RC_ASSERT(std::abs(*flip(a, b) - *flip(b, a)) < 1e-7);
  RC_ASSERT(*flip(a, b) >= 0 && *flip(a, b) <= 1);
  RC_ASSERT(ssim(a, b).has_value() == (w >= 11 && h >= 11));
  if (!ssim(a, b)) return;
  RC_ASSERT(ssim(a, a) == 1.0);
  RC_ASSERT(std::abs(*ssim(a, b) - *ssim(b, a)) < 1e-12);
  RC_ASSERT(std::abs(*ssim(a, b)) <= 1);
}

TEST(perceptual, black_against_white_is_as_different_as_can_be) {
  const auto black = picture(40, 30, extremes, false), white = picture(40, 30, extremes, true);
  // Lightness differs by 100 and chroma is 0. Every difference above 0.4 of the largest is above 0.95; there are no edges.
  EXPECT_GT(*flip(black, white), 0.95);
  // Means 0 and 1, no variance: (0 + C1) (0 + C2) / ((1 + C1) (0 + C2)) with C1 = 1e-4.
  EXPECT_NEAR(*ssim(black, white), 1e-4 / 1.0001, 1e-12);
}

/// Mean over the (2 r + 1)-square around each pixel, of the rim outside.
Picture blurred(const Picture& sharp, int r) {
  Picture soft = sharp;
  for (int y = 0; y < sharp.height; ++y)
    for (int x = 0; x < sharp.width; ++x)
      for (int c = 0; c < 3; ++c) {
        int sum = 0;
        for (int j = -r; j <= r; ++j)
          for (int i = -r; i <= r; ++i)
            sum +=
                sharp.rgb[(std::clamp(y + j, 0, sharp.height - 1) * sharp.width + std::clamp(x + i, 0, sharp.width - 1)) * 3 +
                          c];
        soft.rgb[(y * sharp.width + x) * 3 + c] = static_cast<std::uint8_t>(sum / ((2 * r + 1) * (2 * r + 1)));
      }
  return soft;
}

TEST(perceptual, more_blur_looks_more_different) {
  const auto sharp = picture(96, 64, disc, false);
  double last_flip = 0, last_ssim = 1;
  for (const int r : {1, 2, 4, 8}) {
    const auto soft = blurred(sharp, r);
    EXPECT_GT(*flip(sharp, soft), last_flip) << r;
    EXPECT_LT(*ssim(sharp, soft), last_ssim) << r;
    last_flip = *flip(sharp, soft);
    last_ssim = *ssim(sharp, soft);
  }
}

TEST(perceptual, is_the_same_wherever_the_difference_lies_and_on_any_number_of_threads) {
  // Pictures are filtered in tiles of 128 x 64; equal ones are skipped. A speck counts the same inside one, on its border and
  // where four meet. The floor is flat, so that the speck sees the same around it everywhere.
  const auto floor = picture(
      400, 200, [](bool, int, int, int) { return 120; }, false);
  const auto with_speck = [&](int x, int y) {
    Picture made = floor;
    for (int c = 0; c < 3; ++c) made.rgb[(y * made.width + x) * 3 + c] = 30;
    return made;
  };
  const Picture inside = with_speck(60, 30);
  for (const auto& [x, y] : {std::pair{128, 64}, {127, 63}, {133, 69}, {255, 100}, {200, 128}}) {
    EXPECT_NEAR(*flip(floor, with_speck(x, y)), *flip(floor, inside), 1e-9) << x << ' ' << y;
    EXPECT_NEAR(*ssim(floor, with_speck(x, y)), *ssim(floor, inside), 1e-12) << x << ' ' << y;
  }
  const auto a = picture(500, 300, noise, false), b = picture(500, 300, noise, true);
  const auto many = std::pair{flip(a, b), ssim(a, b)};
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(many, (std::pair{flip(a, b), ssim(a, b)}));
}

TEST(perceptual, pictures_of_different_size_are_refused) {
  const auto a = picture(20, 12, noise, false), b = picture(12, 20, noise, false);
  EXPECT_THROW(flip(a, b), Error);
  EXPECT_THROW(ssim(a, b), Error);
  EXPECT_EQ(flip({}, {}), std::nullopt);
  EXPECT_EQ(ssim({}, {}), std::nullopt);
}

}  // namespace perceptual_test
