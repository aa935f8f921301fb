// Fields of rows whose geometry moves.
#include <gtest/gtest.h>

#include "measure/record/record.h"

namespace record_motion_test {

using namespace gnomon;

Record still() {
  Record r;
  r.scene = "walking_boxes";
  r.technique = "shadow_map";
  r.lights.emplace_back().name = "sun";
  r.status = Status::ok;
  r.times(Stage::build) = {{4, 4.5}};
  r.times(Stage::relight) = {{2, 2.5}};
  r.times(Stage::resolve) = {{1, 1.5}};
  return r;
}

Record moving() {
  Record r = still();
  r.path = "walk";
  r.start = 0;
  r.frame_rate = 59.94;
  r.frame_count = 7;
  r.times(Stage::update) = {{3, 0.30000000000000004}};
  r.moving_times(Stage::relight) = {{0.5, 0.25}};
  r.moving_times(Stage::resolve) = {{1.25, 1.75}};
  r.iterations["update"] = 8;
  return r;
}

TEST(record_motion, fields_survive_writing_and_reading) {
  const std::string line = record_line(moving());
  const Record back = Json::parse(line).get<Record>();
  EXPECT_EQ(record_line(back), line);
  EXPECT_EQ(back.start, 0);
  EXPECT_EQ(back.frame_rate, 59.94);
  EXPECT_EQ(back.frame_count, 7);
  for (const Stage stage : all_stages) {
    EXPECT_EQ(back.times(stage), moving().times(stage)) << name(stage);
    EXPECT_EQ(back.moving_times(stage), moving().moving_times(stage)) << name(stage);
  }
  EXPECT_EQ(back.iterations.at("update"), 8u);
  EXPECT_TRUE(back.unknown.empty());
}

TEST(record_motion, stages_are_written_by_name_and_only_where_they_were_timed) {
  const Json json = moving();
  EXPECT_EQ(json["stages"].size(), 4u);
  EXPECT_EQ(json["stages"]["update"], Json::parse("[[3,0.30000000000000004]]"));
  EXPECT_EQ(json["moving_stages"], Json::parse(R"({"relight":[[0.5,0.25]],"resolve":[[1.25,1.75]]})"));
  EXPECT_EQ(json["start"], 0.0);
}

// A line of schema 6 differs from today's in `schema` alone.
TEST(record_motion, a_row_that_stands_still_has_none_of_the_fields) {
  const Json json = still();
  for (const char* key : {"start", "frame_rate", "frame_count", "moving_stages"}) EXPECT_FALSE(json.contains(key)) << key;
  EXPECT_FALSE(json["stages"].contains("update"));
  const Record back = json.get<Record>();
  EXPECT_FALSE(back.start || back.frame_rate);
  EXPECT_TRUE(back.moving_times(Stage::relight).empty());
}

TEST(record_motion, what_was_measured_is_forgotten_and_where_it_was_asked_for_stays) {
  Record r = moving();
  forget_results(r);
  EXPECT_TRUE(r.times(Stage::update).empty());
  EXPECT_TRUE(r.moving_times(Stage::relight).empty());
  EXPECT_EQ(r.frame_rate, 59.94);
  EXPECT_EQ(r.path, "walk");
}

TEST(record_motion, kept_frames_are_written_where_there_are_some) {
  EXPECT_FALSE(Json(moving()).contains("kept_frames"));
  Record r = moving();
  r.mask = "masks/walk.exr";
  r.kept_frames = {.numbers = {0, 3, 12345}, .mask = "frames/walk", .reference = "frames/reference-0"};
  const Record back = Json::parse(record_line(r)).get<Record>();
  ASSERT_TRUE(back.kept_frames);
  EXPECT_EQ(back.kept_frames->numbers, r.kept_frames->numbers);
  EXPECT_TRUE(back.unknown.empty());
  EXPECT_EQ(pictures(back), (std::vector<std::string>{"masks/walk.exr", "frames/walk/0000.png", "frames/walk/0003.png",
                                                      "frames/walk/12345.png"}));
  EXPECT_EQ(shared_pictures(back).back(), "frames/reference-0/12345.png");
  EXPECT_TRUE(shared_pictures(moving()).empty());
}

TEST(record_motion, a_wrong_field_is_named) {
  Json json = moving();
  json["moving_stages"]["relight"] = Json::array({Json::array({"soon"})});
  try {
    json.get<Record>();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "moving_stages.relight = \"soon\" is not a number");
  }
}

}  // namespace record_motion_test
