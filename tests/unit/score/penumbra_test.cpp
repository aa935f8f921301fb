// Width, shift and hardening of penumbrae that are made by formulas: straight and round ones, with the noise of random samples.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "hand_made.h"
#include "measure/score/score.h"

namespace penumbra_test {

using namespace gnomon;

constexpr int width = 480, height = 270;
constexpr std::size_t pixels = std::size_t{width} * height;
const std::vector<PixelClass> tested(pixels, PixelClass::T);

using Field = std::function<double(double x, double y)>;
std::vector<float> drawn(const Field& v) {
  std::vector<float> mask;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) mask.push_back(static_cast<float>(std::clamp(v(x, y), 0.0, 1.0)));
  return mask;
}

/// Lit left of `middle`, dark right of it; seen across at an angle.
Field straight(double middle, double wide, double degrees = 0) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  return [=](double x, double y) { return 0.5 - ((x - middle) * c + (y - height / 2.0) * s) / wide; };
}
/// A round shadow; its edge is that of a disc light over a straight edge, no ramp.
Field round(double radius, double wide) {
  return [=](double x, double y) {
    const double t = std::clamp(2 * (std::hypot(x - 240.3, y - 134.8) - radius) / wide, -1.0, 1.0);
    return 0.5 + (t * std::sqrt(1 - t * t) + std::asin(t)) / std::numbers::pi;
  };
}

/// The mean of so many random samples of each pixel.
std::vector<float> sampled(const Field& v, int samples, std::uint64_t seed) {
  std::vector<float> mask = drawn(v);
  Random random(seed);
  for (float& value : mask) {
    if (value <= 0 || value >= 1) continue;
    int lit = 0;
    for (int k = 0; k < samples; ++k) lit += random.uniform(0, 1) < value;
    value = static_cast<float>(lit) / static_cast<float>(samples);
  }
  return mask;
}

std::optional<double> metric(std::span<const float> truth, std::span<const float> mask, std::string_view name,
                             std::span<const float> half = {}) {
  const Evidence e{.width = width,
                   .height = height,
                   .classes = tested,
                   .reference = truth,
                   .mask = mask,
                   .reference_half = half,
                   .kind = AnswerKind::fraction};
  return measure_metric(Scoring(e), name);
}

TEST(penumbra, an_equal_mask_has_the_same_width_and_place) {
  for (const double degrees : {0.0, 20.0, 45.0}) {
    const std::vector<float> truth = drawn(straight(240.3, 10, degrees));
    EXPECT_EQ(metric(truth, truth, "penumbra_width_ratio"), 1);
    EXPECT_EQ(metric(truth, truth, "penumbra_shift"), 0);
  }
}

// A ramp's width is that of the ramp, at any angle.
TEST(penumbra, width_is_that_of_the_ramp) {
  for (const double wide : {6.0, 10.0, 15.0, 20.0, 30.0})
    for (const double degrees : {0.0, 30.0, 77.0, 180.0}) {
      const auto ratio = metric(drawn(straight(240, 10, degrees)), drawn(straight(240, wide, degrees)), "penumbra_width_ratio");
      EXPECT_NEAR(ratio.value(), wide / 10, 0.02 * wide / 10) << wide << ' ' << degrees;
    }
}

// Moving the middle of a shadow at greater x to the left by k enlarges it by k; at an angle a its line moves by k cos a.
TEST(penumbra, shift_is_signed_and_measured_across_the_line) {
  for (const double k : {-3.25, -0.5, 0.25, 2.0, 7.5})
    for (const double degrees : {0.0, 35.0, 60.0})
      EXPECT_NEAR(metric(drawn(straight(240, 10, degrees)), drawn(straight(240 - k, 10, degrees)), "penumbra_shift").value(),
                  k * std::cos(degrees * std::numbers::pi / 180), 0.01)
          << k << ' ' << degrees;
  EXPECT_NEAR(metric(drawn(straight(240, 10, 180)), drawn(straight(242, 10, 180)), "penumbra_shift").value(), 2, 0.01);
}

struct Case {
  const char* name;
  Field truth;
  std::function<Field(double factor)> widened;
  std::function<Field(double pixels)> larger;
};
const Case cases[] = {
    {"straight", straight(240.3, 8), [](double f) { return straight(240.3, 8 * f); },
     [](double s) { return straight(240.3 - s, 8); }},
    {"aslant", straight(240.3, 12, 33), [](double f) { return straight(240.3, 12 * f, 33); },
     [](double s) { return straight(240.3 - s / std::cos(33 * std::numbers::pi / 180), 12, 33); }},
    {"round", round(80, 9), [](double f) { return round(80, 9 * f); }, [](double s) { return round(80 + s, 9); }}};

TEST(penumbra, widened_and_shifted_ones_are_found_through_noise) {
  for (const Case& c : cases)
    for (const int samples : {0, 64, 256}) {
      const std::vector<float> truth = drawn(c.truth);
      std::uint64_t seed = 1;
      const auto mask = [&](const Field& v) { return samples > 0 ? sampled(v, samples, seed++) : drawn(v); };
      const auto is_near = [&](const Field& v, std::string_view name, double right) {
        const auto found = metric(truth, mask(v), name);
        ASSERT_TRUE(found.has_value()) << c.name << ' ' << samples << ' ' << name << ' ' << right;
        EXPECT_NEAR(*found, right, 0.05 * std::abs(right)) << c.name << ' ' << samples << ' ' << name;
      };
      for (const double factor : {1.0, 1.5, 2.0}) is_near(c.widened(factor), "penumbra_width_ratio", factor);
      for (const double shift : {0.3, 2.0, -2.0}) is_near(c.larger(shift), "penumbra_shift", shift);
      EXPECT_NEAR(metric(truth, mask(c.widened(1.5)), "penumbra_shift").value(), 0, 0.1) << "wider is no shift";
      EXPECT_NEAR(metric(truth, mask(c.larger(2)), "penumbra_width_ratio").value(), 1, 0.05) << "a shift widens nothing";
    }
}

// The penumbra widens with x, as the caster's distance does: by 0.1 px for each px in the reference.
struct Hardening {
  hand_made::Picture picture{width, height};
  std::vector<float> distance;

  Hardening() {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        picture.set(static_cast<std::size_t>(y) * width + x, {0.1f * x, 0, 0.1f * y}, {0, 1, 0}, 0, 0);
        distance.push_back(1 + 0.05f * x);
      }
  }
  static Field edge(double growth) {
    return [=](double x, double y) { return 0.5 - (y - height / 2.0) / (6 + growth * x); };
  }
  std::optional<double> of(const std::vector<float>& mask) const {
    const std::vector<float> truth = drawn(edge(0.1));
    const Evidence e{.width = width,
                     .height = height,
                     .classes = tested,
                     .reference = truth,
                     .mask = mask,
                     .gbuffer = &picture.gbuffer,
                     .caster_distance = distance,
                     .kind = AnswerKind::fraction};
    return measure_metric(Scoring(e), "contact_hardening");
  }
};

TEST(penumbra, hardening_is_the_ratio_of_the_growths) {
  const Hardening h;
  for (const double growth : {0.05, 0.1, 0.15, 0.2})
    for (const int samples : {0, 64, 256}) {
      const auto found = h.of(samples > 0 ? sampled(Hardening::edge(growth), samples, 9) : drawn(Hardening::edge(growth)));
      ASSERT_TRUE(found.has_value()) << growth << ' ' << samples;
      EXPECT_NEAR(*found, growth / 0.1, 0.05 * growth / 0.1) << growth << ' ' << samples;
    }
}

TEST(penumbra, nothing_is_told_of_what_has_no_umbra_or_too_few_lines) {
  // The light is never hidden by more than nine tenths.
  const Field weak = [](double x, double y) { return 0.1 + 0.9 * std::clamp(straight(240, 10)(x, y), 0.0, 1.0); };
  for (const char* name : {"penumbra_width_ratio", "penumbra_shift"}) {
    EXPECT_EQ(metric(drawn(weak), drawn(weak), name), std::nullopt) << name;
    EXPECT_EQ(metric(drawn(straight(240, 10)), drawn(straight(60, 10)), name), std::nullopt) << name << ": another shadow";
    // 9 lines, and 10.
    for (const int lines : {9, 10}) {
      const Field few = [&](double x, double y) { return y < lines + 2 ? straight(240, 4)(x, y) : 1; };
      std::vector<PixelClass> classes(pixels, PixelClass::F);
      for (int y = 1; y < lines + 1; ++y) std::fill_n(classes.begin() + y * width, width, PixelClass::T);
      const std::vector<float> truth = drawn(few);
      Evidence e{.width = width, .height = height, .classes = classes, .reference = truth, .mask = truth};
      e.kind = AnswerKind::fraction;
      EXPECT_EQ(measure_metric(Scoring(e), name).has_value(), lines - 2 >= 10) << "the 3 x 3 pixels must be there: " << lines;
    }
  }
}

// A reference of eight replicas, of which half are told: its floor is what its noise makes of the error of a right mask.
TEST(floors, are_what_the_references_noise_makes_of_a_right_mask) {
  const Field truth = straight(240.3, 30);
  const std::vector<float> half = sampled(truth, 128, 3), other = sampled(truth, 128, 4), right = drawn(truth);
  std::vector<float> whole;
  for (std::size_t i = 0; i < pixels; ++i) whole.push_back((half[i] + other[i]) / 2);
  const auto asked = [&](std::span<const float> mask, std::string_view name) {
    return metric(whole, mask, name, half).value();
  };
  for (const char* name : {"error", "penumbra_error_mean", "penumbra_error_rms"}) {
    const std::string floor = std::string(name) == "error" ? "error_floor" : std::string(name) + "_floor";
    EXPECT_NEAR(asked(right, floor) / asked(right, name), 1.1, 0.05) << name << ": a tenth more, for it is measured";
    EXPECT_GT(asked(drawn(straight(232, 30)), name), 5 * asked(right, floor)) << name << ": a real error is far above";
  }
  EXPECT_EQ(asked(right, "outside_error_mean_floor"), 0) << "where all rays agree the reference is right";
  EXPECT_LT(asked(right, "penumbra_width_ratio_floor"), 0.02);
  EXPECT_LT(asked(right, "penumbra_shift_floor"), 0.1);
  EXPECT_DOUBLE_EQ(1.1 * asked(half, "error"), asked(right, "error_floor")) << "by definition";
}

}  // namespace penumbra_test
