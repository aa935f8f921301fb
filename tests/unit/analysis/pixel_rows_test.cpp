// Analyses of rows that have the truth over the pixel beside that at pixel centers.
#include <gtest/gtest.h>

#include "analysis/front.h"
#include "analysis_rows.h"
#include "report/analysis/analysis_table.h"

namespace pixel_rows_test {

using namespace analysis_rows;

/// A row that errs so much at centers and over pixels, where the best constant mask errs by 0.1.
Record pixel_row(const std::string& setting, double ms, double error, double over_pixel, TruthOver over = TruthOver::pixel) {
  Record r = with_constant(row(setting, ms, ms, error), 0.1);
  r.truth_over = over;
  r.metrics[Truth::shape]["coverage_error_mean"] = over_pixel;
  r.metrics[Truth::shape]["coverage_error_mean_floor"] = 0.001;
  r.metrics[Truth::shape]["coverage_constant_error"] = 0.1;
  return r;
}

/// A filter that blurs every edge is right over pixels, and worse than no shadow at their centers.
std::vector<Record> sharp_and_smooth(TruthOver over = TruthOver::pixel) {
  return {pixel_row("sharp", 1, 0.01, 0.02, over), pixel_row("smooth", 2, 0.12, 0.005, over)};
}

TEST(pixel_rows, fronts_and_budgets_rank_by_either_truth) {
  const std::vector<Record> records = sharp_and_smooth();
  const std::vector<Field> centers = find_fields(records, {.error = "error"}),
                           pixels = find_fields(records, {.error = "coverage_error_mean"});
  EXPECT_EQ(find_front(centers[0], "lower")[0].standing, Standing::front);
  EXPECT_EQ(find_front(centers[0], "lower")[1].standing, Standing::constant) << "by the error at centers";
  EXPECT_EQ(find_front(pixels[0], "lower")[0].standing, Standing::front) << "the cheapest";
  EXPECT_EQ(find_front(pixels[0], "lower")[1].standing, Standing::front);
  const Budgets budgets{.times = {10}, .memories = {}, .errors = {}};
  EXPECT_EQ(find_best(centers[0], budgets, "lower")[0].winner, 0u);
  EXPECT_EQ(find_best(pixels[0], budgets, "lower")[0].winner, 1u);
  EXPECT_EQ(noise_floor(records[0], "coverage_error_mean"), 0.001);
}

TEST(pixel_rows, the_best_constant_mask_is_that_of_the_truth) {
  Record r = pixel_row("a", 1, 0.01, 0.11);
  EXPECT_TRUE(beats_constant(r));
  EXPECT_TRUE(beats_constant(r, "wrong_rate"));
  EXPECT_FALSE(beats_constant(r, "coverage_error_mean"));
  EXPECT_FALSE(beats_constant(r, "coverage_error_rms"));
  EXPECT_EQ(constant_metric("coverage_error_mean"), "coverage_constant_error");
  EXPECT_EQ(constant_metric("penumbra_error_mean"), "constant_error");
}

TEST(pixel_rows, judge_by_pixels_where_all_ask_for_that) {
  EXPECT_EQ(judging_metric(sharp_and_smooth()), "coverage_error_mean");
  EXPECT_EQ(judging_metric(sharp_and_smooth(TruthOver::both)), "error");
  EXPECT_EQ(judging_metric({}), "error");
  std::vector<Record> mixed = sharp_and_smooth();
  mixed.push_back(row("older", 1, 1, 0.1));
  EXPECT_EQ(judging_metric(mixed), "error");
  mixed.back().status = Status::failed;
  EXPECT_EQ(judging_metric(mixed), "coverage_error_mean") << "a row without results judges nothing";
}

TEST(pixel_rows, tables_show_the_floor_beside_the_error) {
  const std::vector<Record> records = sharp_and_smooth();
  const std::string text = analyze(records, "front", {.metric = "coverage_error_mean", .all = true}, Format::terminal);
  EXPECT_TRUE(has(text, "Front of coverage error mean in %")) << text;
  EXPECT_TRUE(has(text, "coverage error mean floor")) << text;
}

}  // namespace pixel_rows_test
