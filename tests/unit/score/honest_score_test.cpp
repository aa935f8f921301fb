// What a mask can gain by saying nothing: the error that rows are judged by, against masks made from the reference's.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "measure/score/score.h"

namespace honest_score_test {

using namespace gnomon;

constexpr int width = 40, height = 30;
constexpr std::size_t pixels = std::size_t{width} * height;

/// A disc of shadow, whose classes have some of each.
struct Scored {
  std::vector<float> reference = std::vector<float>(pixels, 1.0f);
  std::vector<PixelClass> classes = std::vector(pixels, PixelClass::T);

  Scored() {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        if (std::hypot(x - 18.5, y - 14.5) < 9) reference[y * width + x] = 0;
        if (x % 7 == 3 && y % 5 == 2) classes[y * width + x] = PixelClass::U;
      }
  }

  double metric(std::span<const float> mask, std::string_view name) const {
    const Evidence e{.width = width, .height = height, .classes = classes, .reference = reference, .mask = mask};
    return measure_metric(Scoring(e), name).value();
  }
  double error(std::span<const float> mask) const { return metric(mask, "error"); }
  bool changes_a_tested_pixel(std::span<const float> mask) const {
    for (std::size_t i = 0; i < pixels; ++i)
      if (classes[i] == PixelClass::T && mask[i] != reference[i]) return true;
    return false;
  }
  /// The mask whose pixel at (x, y) is `of(x, y)`; what lies outside is that of the rim.
  std::vector<float> made(const auto& of) const {
    std::vector<float> mask;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) mask.push_back(of(x, y));
    return mask;
  }
  float at(int x, int y) const {
    return reference[static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * width + std::clamp(x, 0, width - 1)];
  }
};

TEST(honest_score, every_change_of_a_tested_pixel_is_worse) {
  const Scored s;
  EXPECT_EQ(s.error(s.reference), 0);
  Random random(5);
  std::vector<float> noise(pixels);
  for (float& v : noise) v = static_cast<float>(random.uniform(0, 1));
  const std::pair<const char*, std::vector<float>> fooling[] = {
      {"constant 0", std::vector(pixels, 0.0f)},
      {"constant 0.5", std::vector(pixels, 0.5f)},
      {"constant 1", std::vector(pixels, 1.0f)},
      {"random", noise},
      {"shifted", s.made([&](int x, int y) { return s.at(x - 1, y); })},
      {"flipped", s.made([&](int x, int y) { return s.at(width - 1 - x, y); })},
      {"inverted", s.made([&](int x, int y) { return 1 - s.at(x, y); })},
      {"compressed", s.made([&](int x, int y) { return 0.1f + 0.8f * s.at(x, y); })},
      {"blurred", s.made([&](int x, int y) {
         float sum = 0;
         for (int k = 0; k < 9; ++k) sum += s.at(x + k % 3 - 1, y + k / 3 - 1);
         return sum / 9;
       })},
      {"half shifted", s.made([&](int x, int y) { return (s.at(x, y) + s.at(x - 1, y)) / 2; })}};
  for (const auto& [name, mask] : fooling) {
    EXPECT_TRUE(s.changes_a_tested_pixel(mask)) << name;
    EXPECT_GT(s.error(mask), 0) << name;
  }
  EXPECT_DOUBLE_EQ(s.error(fooling[1].second), 0.5) << "one half is off by one half everywhere";
  EXPECT_DOUBLE_EQ(s.error(fooling[6].second), 1);
}

// A curve bends no mask of 0 and 1, but one with shares.
TEST(honest_score, a_curve_over_a_fraction_is_worse) {
  Scored s;
  for (std::size_t i = 0; i < pixels; ++i) s.reference[i] = static_cast<float>(i % 11) / 10;
  for (const float power : {1 / 2.2f, 2.2f})
    EXPECT_GT(s.error(s.made([&](int x, int y) { return std::pow(s.at(x, y), power); })), 0.05) << power;
}

RC_GTEST_PROP(honest_score, the_mean_of_two_masks_errs_at_most_as_the_mean_of_their_errors, ()) {
  const Scored s;
  Random random(*rc::gen::arbitrary<std::uint32_t>());
  std::vector<float> a, b, mean;
  for (std::size_t i = 0; i < pixels; ++i) {
    a.push_back(static_cast<float>(random.uniform(0, 1)));
    b.push_back(random.uniform(0, 1) < 0.5 ? 0.0f : 1.0f);
    mean.push_back((a[i] + b[i]) / 2);
  }
  RC_ASSERT(s.error(mean) <= (s.error(a) + s.error(b)) / 2 + 1e-7);
}

// No constant errs less than the one that is told, and one errs as much.
RC_GTEST_PROP(honest_score, no_constant_mask_beats_the_best, ()) {
  Scored s;
  Random random(*rc::gen::arbitrary<std::uint32_t>());
  const bool is_binary = *rc::gen::arbitrary<bool>();
  const double lit = random.uniform(0, 1);
  for (float& v : s.reference)
    v = is_binary ? (random.uniform(0, 1) < lit ? 1.0f : 0.0f) : static_cast<float>(random.uniform(0, 1));
  const double best = s.metric(s.reference, "constant_error");
  double least = 1;
  for (int k = 0; k <= 200; ++k) least = std::min(least, s.error(std::vector(pixels, static_cast<float>(k) / 200)));
  RC_ASSERT(best <= least + 1e-7);
  RC_ASSERT(least <= best + 0.003);
  if (is_binary) {
    std::size_t tested = 0, dark = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      tested += s.classes[i] == PixelClass::T;
      dark += s.classes[i] == PixelClass::T && s.reference[i] == 0;
    }
    RC_ASSERT(std::abs(best - static_cast<double>(std::min(dark, tested - dark)) / static_cast<double>(tested)) < 1e-12);
  }
}

}  // namespace honest_score_test
