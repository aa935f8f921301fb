// What of two records of a row must be the same, and what drivers may do otherwise.
#include <gtest/gtest.h>

#include "error_words.h"
#include "measure/images/image_files.h"
#include "measure/scratch_folder.h"
#include "measure/submission/numbers.h"
#include "measure/submission/repeat.h"
#include "record/record_example.h"

namespace submission_numbers_test {

using namespace gnomon;
using record_example::example;

std::vector<std::string> texts(const std::vector<NumberDifference>& differences) {
  std::vector<std::string> result;
  for (const NumberDifference& one : differences) result.push_back(one.text());
  return result;
}

using Texts = std::vector<std::string>;

TEST(submission_numbers, times_and_machine_are_no_numbers) {
  Record now = example();
  now.times(Stage::resolve) = {{7}};
  now.seconds = 9;
  now.context["processor"] = "another";
  now.peak_bytes = 1;
  EXPECT_EQ(texts(number_differences(example(), now)), Texts());
}

TEST(submission_numbers, the_last_digit_counts) {
  Record now = example();
  now.metrics[Truth::shape]["wrong_rate"] = 5e-324;
  EXPECT_EQ(texts(number_differences(example(), now)), Texts{"metrics.shape.wrong_rate 0.0 -> 5e-324"});
}

TEST(submission_numbers, what_came_later_is_no_difference_unless_it_holds_something) {
  Record now = example();
  now.metrics[Truth::shape]["newer"] = 1;
  now.parameters["newer"] = "default";
  (*now.causes)["newer"] = 0;
  EXPECT_EQ(texts(number_differences(example(), now)), Texts());
  (*now.causes)["newer"] = 2;
  EXPECT_EQ(texts(number_differences(example(), now)), Texts{"causes.newer 0 -> 2"});
  EXPECT_EQ(texts(number_differences(now, example())), (Texts{"causes.newer 2 -> 0", "parameters.newer default -> -"}));
}

TEST(submission_numbers, a_mask_decides_classes_metrics_and_causes) {
  Record now = example();
  now.counts[0].value = 1;
  now.classes["T"] = 1;
  (*now.causes)["acne"] = 4;
  EXPECT_EQ(texts(mask_differences(example(), now, true)), (Texts{"classes.T 307190 -> 1", "causes.acne 3 -> 4"}));
  EXPECT_EQ(texts(mask_differences(example(), now, false)), Texts{"classes.T 307190 -> 1"});
}

TEST(submission_numbers, numbers_of_pixels_that_are_not_tested_can_be_left_out) {
  Record now = example();
  now.metrics[Truth::mesh]["displacement_mean"] = 1;  // was null
  now.metrics[Truth::mesh]["wrong_rate"] = 0.5;
  const auto tested = of_tested_pixels(number_differences(example(), now));
  ASSERT_EQ(tested.size(), 1u);
  EXPECT_EQ(tested[0].path, "metrics.mesh.wrong_rate");
}

TEST(submission_numbers, pixels_of_two_masks_are_counted_by_light) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon-numbers");
  Record record = example();
  record.width = 2;
  record.height = 2;
  const std::vector<float> first = {0, 1, 0.5f, 1}, second = {0, 0.998f, 0.25f, 0};  // 0.002 is below 1/256
  const std::vector<std::string> names = {"point.V"};
  const std::vector<std::span<const float>> a = {first}, b = {second};
  image_files().write_exr(scratch.path() / "a.exr", 2, 2, names, a);
  image_files().write_exr(scratch.path() / "b.exr", 2, 2, names, b);
  EXPECT_EQ(pixels_apart(record, scratch.path() / "a.exr", scratch.path() / "b.exr", 0), 3u);
  EXPECT_EQ(pixels_apart(record, scratch.path() / "a.exr", scratch.path() / "b.exr", DriverDifferences::threshold), 2u);
}

TEST(submission_numbers, what_drivers_may_do_is_of_one_row) {
  const DriverDifferences shipped = DriverDifferences::shipped();
  Record record = example();
  record.scene = "fence";
  record.light = "point";
  record.technique = "shadow_map";
  record.settings = "";
  EXPECT_EQ(shipped.pixels_of(record), 13u);  // as tests/data/drivers.toml has it
  record.settings = "resolution=64";
  EXPECT_EQ(shipped.pixels_of(record), 0u);
}

TEST(submission_numbers, a_seed_draws_the_same_rows_each_time) {
  std::vector<Record> records;
  for (int k = 0; k < 40; ++k) records.push_back(example(fmt::format("{}", k)));
  const auto any = [](const Record&) { return true; };
  const auto drawn = drawn_rows(records, 5, 1, any);
  EXPECT_EQ(drawn.size(), 5u);
  EXPECT_EQ(drawn_rows(records, 5, 1, any), drawn);
  EXPECT_NE(drawn_rows(records, 5, 2, any), drawn);
  EXPECT_EQ(drawn_rows(records, 100, 1, any).size(), records.size());
  const auto one = drawn_rows(records, 5, 1, [](const Record& record) { return record.job == "7"; });
  EXPECT_EQ(one, std::vector<std::size_t>{7});
}

}  // namespace submission_numbers_test
