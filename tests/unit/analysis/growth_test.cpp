#include "analysis/growth.h"

#include <gnomon/kit/random.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "analysis_rows.h"

namespace growth_test {

using namespace analysis_rows;

RC_GTEST_PROP(growth, the_exponent_of_a_power_law_is_found, ()) {
  const double exponent = *rc::gen::inRange(-300, 301) / 100.0, coefficient = *rc::gen::inRange(1, 1000) / 10.0;
  std::vector<double> x, y;
  for (int k = 0; k < *rc::gen::inRange(3, 9); ++k) {
    x.push_back(std::pow(2, k) * 3);
    y.push_back(coefficient * std::pow(x.back(), exponent));
  }
  const PowerLaw law = fit_power_law(x, y);
  RC_ASSERT(std::abs(law.exponent - exponent) < 1e-9);
  RC_ASSERT(std::abs(law.coefficient / coefficient - 1) < 1e-8);
  RC_ASSERT(law.r2 > 1 - 1e-9);
}

TEST(growth, least_squares_by_hand) {
  // ln x = 0, 1, 2 and ln y = 0, 1, 0: slope 0, mean 1/3, so R^2 is 0.
  const std::vector<double> x{1, std::exp(1), std::exp(2)}, y{1, std::exp(1), 1};
  const PowerLaw law = fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, 0, 1e-12);
  EXPECT_NEAR(law.coefficient, std::exp(1.0 / 3), 1e-12);
  EXPECT_NEAR(law.r2, 0, 1e-12);
}

Growth stage_of(const Growths& growths, const std::string& stage) {
  for (const Growth& growth : growths.rows)
    if (growth.stage == stage) return growth;
  throw Error("there is no stage {}", stage);
}

TEST(growth, scenes_of_one_family_are_one_series) {
  const Growths growths = find_growth(family({10, 100, 1000}, 1.5), "triangles");
  ASSERT_EQ(growths.rows.size(), 3u);  // build, relight, resolve
  const Growth resolve = stage_of(growths, "resolve");
  EXPECT_EQ(resolve.place.scene, "soup:seed=7,count=*");
  ASSERT_TRUE(resolve.exponent);
  EXPECT_NEAR(resolve.exponent->value, 1.5, 1e-9);
  EXPECT_NEAR(resolve.coefficient, 2, 1e-6);
  EXPECT_TRUE(resolve.exponent->has_interval);
  EXPECT_NEAR(stage_of(growths, "relight").exponent->value, 0, 1e-9);
  // The same by the scene's parameter, which only the reference has.
  EXPECT_NEAR(stage_of(find_growth(family({10, 100, 1000}, 1.5), "count"), "resolve").exponent->value, 1.5, 1e-9);
}

TEST(growth, what_does_not_change_the_triangles_does_not_join_scenes) {
  // Two seeds at every count: seed 8 has the same triangles as 7, so the two are series of their own.
  std::vector<Record> records = family({10, 100, 1000}, 1);
  for (Record r : family({10, 100, 1000}, 2)) {
    r.scene.replace(r.scene.find("seed=7"), 6, "seed=8");
    records.push_back(r);
  }
  std::set<std::string> scenes;
  for (const Growth& growth : find_growth(records, "triangles").rows) {
    scenes.insert(growth.place.scene);
    EXPECT_EQ(growth.points.size(), 3u);
  }
  EXPECT_EQ(scenes, (std::set<std::string>{"soup:seed=7,count=*", "soup:seed=8,count=*"}));
  records.push_back(row("a", 1, 1, 0.1, "bunny"));
  const auto families = scene_families(records);
  EXPECT_EQ(families.at("bunny"), "bunny");
  EXPECT_EQ(families.at(records[0].scene), "soup:seed=7,count=*");
  EXPECT_EQ(families.at(records[5].scene), "soup:seed=8,count=*");
}

TEST(growth, stills_at_other_times_are_series_of_their_own) {
  std::vector<Record> records;
  for (const char* const time : {"@0.5", "@walk=1"})
    for (Record r : family({10, 100, 1000}, 1)) {
      r.scene += time;
      records.push_back(r);
    }
  for (const char* const axis : {"triangles", "count"}) {
    std::set<std::string> scenes;
    for (const Growth& growth : find_growth(records, axis).rows) {
      scenes.insert(growth.place.scene);
      EXPECT_EQ(growth.points.size(), 3u);
    }
    EXPECT_EQ(scenes, (std::set<std::string>{"soup:seed=7,count=*@0.5", "soup:seed=7,count=*@walk=1"})) << axis;
  }
}

TEST(growth, two_points_are_too_few_and_one_is_no_series) {
  const Growths two = find_growth(family({10, 100}, 1), "triangles");
  EXPECT_FALSE(stage_of(two, "resolve").exponent);
  EXPECT_EQ(stage_of(two, "resolve").why_not, "too few points");
  // Beside a series of two, one of a single point is counted.
  std::vector<Record> records = family({10, 100}, 1);
  for (Record r : family({10}, 1)) {
    r.technique = "other";
    records.push_back(std::move(r));
  }
  const Growths one = find_growth(records, "triangles");
  EXPECT_EQ(one.rows.size(), 3u);  // build, relight, resolve
  EXPECT_EQ(one.single, 1u);
  EXPECT_THROW(find_growth(family({10}, 1), "triangles"), Error);
}

TEST(growth, times_that_the_clock_does_not_see_make_no_exponent) {
  std::vector<Record> records = family({10, 100, 1000}, 1);
  for (Record& r : records) r.times(Stage::relight) = {{4e-5}, {5e-5}, {4e-5}};
  EXPECT_EQ(stage_of(find_growth(records, "triangles"), "relight").why_not, "below the clock");
}

TEST(growth, the_interval_holds_the_noise_of_the_processes) {
  // Exponent 1, every process off by up to 20 %: the interval must contain 1 and exclude 0.5 and 1.5.
  std::vector<Record> records = family({10, 100, 1000, 10000}, 1);
  Random random(3);
  for (Record& r : records)
    for (auto& process : r.times(Stage::resolve)) process[0] *= random.uniform(0.8, 1.2);
  const Growth growth = stage_of(find_growth(records, "triangles"), "resolve");
  EXPECT_LT(growth.exponent->low, growth.exponent->high);
  EXPECT_LE(growth.exponent->low, 1.05);
  EXPECT_GE(growth.exponent->high, 0.95);
  EXPECT_GT(growth.exponent->low, 0.5);
  EXPECT_LT(growth.exponent->high, 1.5);
}

TEST(growth, lights_are_summed_in_their_order_after_one_build) {
  std::vector<Record> records;
  for (const char* light : {"a", "b", "c"}) {
    records.push_back(row("t", 2, 3, 0.1));
    records.back().light = light;
  }
  const Growth total = stage_of(find_growth(records, "lights"), "total");
  ASSERT_EQ(total.points.size(), 3u);
  // Build 1, then 5 for every light.
  EXPECT_EQ(total.points[0].value.value, 6);
  EXPECT_EQ(total.points[1].value.value, 11);
  EXPECT_EQ(total.points[2].value.value, 16);
  EXPECT_EQ(total.points[2].x, 3);
  EXPECT_NEAR(stage_of(find_growth(records, "lights"), "resolve").exponent->value, 1, 1e-9);
}

TEST(growth, a_parameter_of_the_technique_is_an_axis_and_leaves_the_name) {
  std::vector<Record> records;
  for (const int resolution : {256, 512, 1024, 2048}) {
    records.push_back(row(fmt::format("map:bias=2,resolution={}", resolution), resolution * resolution * 1e-4, 1, 0.1));
    if (resolution == 1024) records.back().label = "usual";  // a label of one point does not split the series
  }
  const Growths growths = find_growth(records, "resolution");
  const Growth relight = stage_of(growths, "relight");
  EXPECT_EQ(relight.setting, "map:bias=2");
  EXPECT_EQ(relight.points.size(), 4u);
  EXPECT_NEAR(relight.exponent->value, 2, 1e-9);
  EXPECT_THROW(find_growth(records, "resolutoin"), Error);
}

/// Rays of that many samples and seeds, with an error of 0.4 samples^exponent, off by up to `noise` of it.
std::vector<Record> rays(std::initializer_list<int> samples, int seeds, double exponent, double noise) {
  std::vector<Record> records;
  Random random(5);
  for (const int count : samples)
    for (int seed = 1; seed <= seeds; ++seed) {
      Record r = row(fmt::format("rays:samples={},seed={}", count, seed), 1, 1, 0.1);
      if (seed == 1) r.label = fmt::format("rays:samples={},seed=1", count);  // as a sweep over the default has it
      r.metrics[Truth::shape]["penumbra_error_rms"] = 0.4 * std::pow(count, exponent) * random.uniform(1 - noise, 1 + noise);
      r.answer = AnswerKind::fraction;
      r.lights[0].reference = Record::ReferenceFacts{.target = 0.001};
      records.push_back(std::move(r));
    }
  return records;
}

TEST(growth, a_quantity_grows_and_seeds_are_its_repetitions) {
  const Growths growths = find_growth(rays({16, 32, 64, 128, 256}, 5, -0.5, 0.1), "samples", "penumbra_error_rms");
  ASSERT_EQ(growths.rows.size(), 1u);
  const Growth& growth = growths.rows[0];
  EXPECT_EQ(growth.setting, "rays");
  EXPECT_EQ(growth.stage, "penumbra_error_rms");
  ASSERT_EQ(growth.points.size(), 5u);
  for (const Growth::Point& point : growth.points) {
    EXPECT_EQ(point.rows, 5u);
    EXPECT_TRUE(point.value.has_interval);
    EXPECT_NEAR(point.value.value, 0.4 / std::sqrt(point.x), 0.04 / std::sqrt(point.x));
  }
  ASSERT_TRUE(growth.exponent && growth.exponent->has_interval);
  EXPECT_NEAR(growth.exponent->value, -0.5, 0.05);
  EXPECT_LT(growth.exponent->high - growth.exponent->low, 0.1);
  // One seed: how far the points lie from the line is all that is known of its slope.
  const Growth single = find_growth(rays({16, 32, 64}, 1, -0.5, 0), "samples", "penumbra_error_rms").rows.at(0);
  EXPECT_NEAR(single.exponent->value, -0.5, 1e-9);
  EXPECT_TRUE(single.exponent->has_interval);
  EXPECT_NEAR(single.exponent->low, -0.5, 1e-6);
  EXPECT_NEAR(single.exponent->high, -0.5, 1e-6);
}

TEST(growth, slopes_between_neighbors_and_of_the_upper_half_by_hand) {
  // ln x = 0, 1, 2, 3 and ln y = 0, 2, 1, 2: slopes 2, -1, 1; the upper half has 1. The line: mean x 1.5, sum of squares 5, of
  // products -1.5 * 0 - 0.5 * 2 + 0.5 * 1 + 1.5 * 2 = 2.5, so 0.5; y about its mean 1.25: 2.75, less 0.5 * 2.5: 1.5 is missed.
  std::vector<Record> records = family({1, 2, 3, 4}, 0);
  const double x[] = {1, std::exp(1), std::exp(2), std::exp(3)}, y[] = {1, std::exp(2), std::exp(1), std::exp(2)};
  const PowerLaw law = fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, 0.5, 1e-12);
  EXPECT_NEAR(*law.misfit, 4.302653 * std::sqrt(1.5 / 2 / 5), 1e-5);
  const int sizes[] = {1000, 10'000, 100'000, 1'000'000};
  for (std::size_t k = 0; k < 4; ++k) {
    records[k].scene_facts->triangles = static_cast<std::uint64_t>(sizes[k]);
    records[k].times(Stage::resolve) = {{y[k]}, {y[k]}, {y[k]}};
  }
  const Growth growth = stage_of(find_growth(records, "triangles"), "resolve");
  const double decade = std::log(10);
  EXPECT_NEAR(growth.least_slope, -1 / decade, 1e-9);
  EXPECT_NEAR(growth.greatest_slope, 2 / decade, 1e-9);
  EXPECT_NEAR(growth.upper_slope, 1 / decade, 1e-9);
}

// The truth is a power law that each size of a scene misses in a way of its own, beside 5 % from process to process.
TEST(growth, the_interval_covers_the_exponent_whatever_the_misfit) {
  for (const double misfit : {0.0, 0.05, 0.15})
    for (const int count : {3, 6}) {
      Random random(11, static_cast<std::uint64_t>(count));
      const auto normal = [&] {  // of twelve uniform numbers, within 6
        double sum = -6;
        for (int k = 0; k < 12; ++k) sum += random.uniform(0, 1);
        return sum;
      };
      int covered = 0;
      constexpr int trials = 120;
      for (int trial = 0; trial < trials; ++trial) {
        std::vector<Record> records;
        for (int k = 0; k < count; ++k) {
          const int triangles = 1000 << 2 * k;
          Record r = family({triangles}, 0).front();
          const double middle = 0.001 * triangles * std::exp(misfit * normal());
          r.stages = {};
          for (int p = 0; p < 5; ++p) {
            const double here = middle * std::exp(0.05 * normal());
            r.times(Stage::resolve).push_back({here, here * 1.01, here * 0.99});
          }
          records.push_back(std::move(r));
        }
        const ValueWithInterval exponent = *stage_of(find_growth(records, "triangles"), "resolve").exponent;
        covered += exponent.low <= 1 && 1 <= exponent.high;
      }
      RecordProperty(fmt::format("covered_{}_{}", count, static_cast<int>(100 * misfit)), covered);
      EXPECT_GE(covered, 0.9 * trials) << misfit << ", " << count << " sizes";
    }
}

// 0.4 / samples passes three standard errors of the reference, 0.003, between 128 and 256.
TEST(growth, errors_that_the_reference_may_have_made_are_left_out) {
  const Growth growth = find_growth(rays({32, 64, 128, 256, 512}, 3, -1, 0), "samples", "penumbra_error_rms").rows.at(0);
  EXPECT_EQ(growth.points.size(), 5u);
  EXPECT_EQ(growth.left_out, 2u);
  EXPECT_NEAR(growth.exponent->value, -1, 1e-9);
  const Growth below = find_growth(rays({128, 256, 512}, 3, -1, 0), "samples", "penumbra_error_rms").rows.at(0);
  EXPECT_FALSE(below.exponent);
  EXPECT_EQ(below.why_not, "below the reference");
  // Under a light without area there is no such error, and a time has none.
  std::vector<Record> hard = rays({128, 256, 512}, 3, -1, 0);
  for (Record& r : hard) r.answer = AnswerKind::binary;
  EXPECT_EQ(find_growth(hard, "samples", "penumbra_error_rms").rows.at(0).left_out, 0u);
  EXPECT_EQ(find_growth(rays({128, 256, 512}, 3, -1, 0), "samples", "resolve_ms").rows.at(0).left_out, 0u);
}

TEST(growth, a_quantity_that_no_row_has_or_that_lights_do_not_sum_is_an_error) {
  const std::vector<Record> records = rays({16, 32, 64}, 2, -0.5, 0);
  EXPECT_THROW(find_growth(records, "samples", "penumbra_eror_rms"), Error);
  EXPECT_THROW(find_growth(records, "lights", "penumbra_error_rms"), Error);
}

TEST(growth, picture_sizes_are_an_axis) {
  std::vector<Record> records;
  for (const int scale : {1, 2, 4}) {
    records.push_back(row("t", 1, 0.5 * scale * scale, 0.1));
    records.back().width = 160 * scale;
    records.back().height = 90 * scale;
  }
  EXPECT_NEAR(stage_of(find_growth(records, "pixels"), "resolve").exponent->value, 1, 1e-9);
}

}  // namespace growth_test
