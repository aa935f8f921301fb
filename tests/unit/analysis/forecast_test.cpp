#include "analysis/forecast.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "analysis_rows.h"
#include "error_words.h"

namespace forecast_test {

using namespace analysis_rows;

RC_GTEST_PROP(forecast, a_line_is_found_and_has_no_width, ()) {
  const double fixed = *rc::gen::inRange(1, 1000) / 10.0, each = *rc::gen::inRange(0, 1000) / 100.0;
  std::vector<double> x, y;
  for (int k = 0; k < *rc::gen::inRange(3, 9); ++k) {
    x.push_back(std::pow(2, k));
    y.push_back(fixed + each * x.back());
  }
  const CostLine line = fit_cost_line(x, y);
  RC_ASSERT(std::abs(line.at(1000) / (fixed + each * 1000) - 1) < 1e-8);
  RC_ASSERT(line.half_width(1000) < 1e-5 * line.at(1000));
}

// Points (0, 1), (1, 1), (2, 2) weigh 1, 1 and 1/4. Their middle is x = 2/3, y = 10/9; the sum of squares about it is 1, that
// of products 1/3. The line misses them by -1/9, 2/9 and -2/9 of their y: the variance is (1 + 4 + 4) / 81 over 3 - 2.
TEST(forecast, least_relative_squares_by_hand) {
  const CostLine line = fit_cost_line(std::vector<double>{0, 1, 2}, std::vector<double>{1, 1, 2});
  EXPECT_NEAR(line.each, 1.0 / 3, 1e-12);
  EXPECT_NEAR(line.fixed, 8.0 / 9, 1e-12);
  EXPECT_NEAR(line.relative_variance, 1.0 / 9, 1e-12);
  // In the middle nothing of the slope's doubt is left; the 0.975 quantile of Student's t with one degree is tan(0.475 pi).
  EXPECT_NEAR(line.half_width(2.0 / 3), std::tan(0.475 * std::numbers::pi) * std::sqrt((100.0 / 81 + 4.0 / 9) / 9), 1e-9);
}

// Costs of 1, 4, 16 and 64 lights that scatter by 3 % about a line, and the cost of 256: 95 % lie in the interval, within what
// 4000 tries leave open and what weights by scattered costs change.
TEST(forecast, intervals_hold_what_they_promise) {
  Random random(7);
  const std::vector<double> x{1, 4, 16, 64};
  const auto cost = [&](double lights) { return (5 + 2 * lights) * (1 + 0.03 * normal(random)); };
  int held = 0;
  constexpr int tries = 4000;
  for (int k = 0; k < tries; ++k) {
    std::vector<double> y;
    for (const double lights : x) y.push_back(cost(lights));
    const CostLine line = fit_cost_line(x, y);
    held += std::abs(cost(256) - line.at(256)) <= line.half_width(256);
  }
  EXPECT_GT(held, 0.93 * tries);
  EXPECT_LT(held, 0.97 * tries);
}

// relight takes 3 ms, resolve 2 ms for each triangle.
TEST(forecast, costs_of_rows_are_extrapolated_and_marked_by_where_they_end) {
  const Forecasts found = find_forecasts(family({10, 20, 40, 80}, 1), "count", Cost::light, 1000);
  ASSERT_EQ(found.rows.size(), 1u);
  const Forecast& row = found.rows[0];
  EXPECT_EQ(row.xs, (std::vector<double>{10, 20, 40, 80}));
  EXPECT_NEAR(row.fixed, 3, 1e-9);
  EXPECT_NEAR(row.each, 2, 1e-9);
  EXPECT_NEAR(row.value.value().value, 2003, 1e-6);
  EXPECT_TRUE(row.is_foretold());
  EXPECT_NEAR(row.foretold->value, 163, 1e-8);
  EXPECT_EQ(find_forecasts(family({10, 20, 40}, 1), "count", Cost::light).to, 160) << "four times the greatest";
  // Bytes are the same in every row, and memory has no processes.
  EXPECT_NEAR(find_forecasts(family({10, 20, 40}, 1), "count", Cost::bytes).rows[0].value->value, 1 << 20, 1e-3);
}

// Twice the triangles, four times the time: no line, and the interval says so.
TEST(forecast, what_is_no_line_is_not_foretold_narrowly) {
  const Forecasts found = find_forecasts(family({10, 20, 40, 80}, 2), "count", Cost::resolve);
  const ValueWithInterval value = found.rows[0].value.value();
  EXPECT_GT(value.high - value.low, value.value);
  EXPECT_GE(value.low, 0);
}

TEST(forecast, what_cannot_be_forecast_says_why) {
  EXPECT_EQ(find_forecasts(family({10, 20}, 1), "count", Cost::light).rows[0].why_not, "too few points");
  std::vector<Record> fast = family({10, 20, 40}, 1);
  for (Record& r : fast) r.times(Stage::resolve) = {{1e-4}, {1e-4}, {1e-4}};
  EXPECT_EQ(find_forecasts(fast, "count", Cost::resolve).rows[0].why_not, "below the clock");
  for (Record& r : fast) r.bytes = 0;
  EXPECT_EQ(find_forecasts(fast, "count", Cost::bytes).rows[0].why_not, "no cost");
  EXPECT_EQ(find_forecasts(family({10, 20, 40}, 1), "count", Cost::light).rows[0].foretold, std::nullopt);
}

TEST(forecast, questions_without_an_answer_are_refused) {
  const std::vector<Record> rows = family({10, 20, 40}, 1);
  const auto words = [&](const std::string& axis, std::optional<double> to) {
    return error_words::error_of([&] { find_forecasts(rows, axis, Cost::light, to); });
  };
  EXPECT_TRUE(has(words("count", 40), "--to 40 is not beyond 40")) << words("count", 40);
  EXPECT_TRUE(has(words("lights", {}), "several lights together")) << words("lights", {});
  EXPECT_TRUE(has(words("cuont", {}), "did you mean count?")) << words("cuont", {});
  EXPECT_TRUE(has(words("pixels", {}), "no setting was measured at two values of pixels")) << words("pixels", {});
}

}  // namespace forecast_test
