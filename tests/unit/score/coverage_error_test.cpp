// Errors of masks against the truth over the pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "hand_made.h"
#include "measure/row/score_row.h"

namespace coverage_error_test {

using namespace gnomon;

/// Four pixels; the tests write their masks.
struct Row {
  Scene scene;
  MeasuredRow measured;
  std::vector<PixelClass> classes = {PixelClass::T, PixelClass::T, PixelClass::T, PixelClass::U};
  const std::vector<float> lit = std::vector<float>(4, 1.0f);
  std::vector<float> mean = {0.5f, 0.25f, 1, 0.5f}, error = {0.25f, 0.5f, 0.0625f, 1}, half = {0.625f, 0, 1, 0};
  std::vector<std::uint8_t> kept = {64, 31, 32, 64};  // the second keeps less than half
  hand_made::Picture picture{4, 1};

  Row() {
    scene.meshes = {hand_made::square(4, 0)};
    for (int x = 0; x < 4; ++x) picture.set(static_cast<std::size_t>(x), {0.1f * static_cast<float>(x), 0, 0}, {0, 1, 0}, 0, 0);
    picture.gbuffer.view = {.eye = {0, 5, 1}, .target = {0, 0, 0}};
  }
  Answer& add(std::vector<float> mask, bool is_over_pixel = true) {
    MeasuredLight& light = measured.lights.emplace_back();
    light.light = {.name = fmt::format("sun_{}", std::size(measured.lights)), .kind = DirectionalLight{{0, -1, 0}}};
    Answer& answer = light.answer;
    answer.gbuffer = picture.gbuffer;
    answer.reference.mask = lit;
    answer.reference.classes = classes;
    answer.mask = std::move(mask);
    if (is_over_pixel) answer.pixel_truth = {.mean = mean, .error = error, .half = half, .kept = kept};
    return answer;
  }
  Metrics metrics() {
    put_together(measured, scene);
    return score(measured, scene).whole.metrics;
  }
};

// Two pixels are tested: off by 1/2 and by 0.
TEST(coverage_error, is_over_tested_pixels_that_keep_half_of_their_rays) {
  Row row;
  row.add({1, 0, 1, 0});
  const Metrics metrics = row.metrics();
  EXPECT_DOUBLE_EQ(metrics.at("coverage_error_mean").value(), 0.25);
  EXPECT_DOUBLE_EQ(metrics.at("coverage_error_rms").value(), std::sqrt(0.25 / 2));
  EXPECT_DOUBLE_EQ(metrics.at("error").value(), 1.0 / 3) << "the truth at centers tests the second pixel, too";
  // Half of the rays are off by 1/8 at the first pixel; a floor is 1.1 times what it measures.
  EXPECT_DOUBLE_EQ(metrics.at("coverage_error_mean_floor").value(), 1.1 * 0.125 / 2);
  EXPECT_DOUBLE_EQ(metrics.at("coverage_error_rms_floor").value(), 1.1 * std::sqrt(0.125 * 0.125 / 2));
  EXPECT_DOUBLE_EQ(metrics.at("coverage_constant_error").value(), 0.25) << "any value of 0.5 .. 1";
  EXPECT_EQ(metrics.at("constant_error"), 0.0) << "the reference is lit";
}

TEST(coverage_error, is_not_defined_where_the_row_does_not_ask_for_it) {
  Row row;
  row.add({1, 0, 1, 0}, false);
  const Metrics metrics = row.metrics();
  for (const char* name : {"coverage_error_mean", "coverage_error_rms", "coverage_error_mean_floor", "coverage_error_rms_floor",
                           "coverage_constant_error"})
    EXPECT_EQ(metrics.at(name), std::nullopt) << name;
  EXPECT_FALSE(pixel_facts(row.measured.lights[0].answer));
}

TEST(coverage_error, facts_are_of_the_tested_pixels) {
  Row row;
  const auto facts = pixel_facts(row.add({1, 1, 1, 1}));
  ASSERT_TRUE(facts);
  EXPECT_EQ(facts->rays, 64);
  EXPECT_DOUBLE_EQ(facts->kept, (64 + 31 + 32) / (3 * 64.0));
  EXPECT_EQ(facts->tested, 2u);
  EXPECT_DOUBLE_EQ(facts->error_mean, (0.25 + 0.0625) / 2);
  EXPECT_DOUBLE_EQ(facts->error_max, 0.25);
}

// Two suns give the same light: their truth is the mean of both, and a light without a truth over the pixel counts as lit. At
// the first pixel that is (0.5 + 1) / 2, and the mask is 1.
TEST(coverage_error, of_several_lights_compares_the_light_received) {
  Row row;
  row.add({1, 0, 1, 0});
  row.add({1, 1, 1, 1}, false);
  const Metrics metrics = row.metrics();
  EXPECT_NEAR(metrics.at("coverage_error_mean").value(), 0.25 / 2, 1e-7);
  EXPECT_NEAR(metrics.at("coverage_error_rms").value(), std::sqrt(0.25 * 0.25 / 2), 1e-7);
  EXPECT_NEAR(metrics.at("coverage_error_mean_floor").value(), 1.1 * 0.0625 / 2, 1e-7);
}

}  // namespace coverage_error_test
