#include "measure/record/record.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>

#include "record/record_example.h"

namespace record_test {

using namespace gnomon;
using record_example::example;

Record read(const std::string& line) { return Json::parse(line).get<Record>(); }

TEST(record, what_a_row_asks_for_beside_the_centers_is_there_where_it_does) {
  Record r = example();
  const Json without = Json::parse(record_line(r));
  EXPECT_FALSE(without.contains("truth_over"));
  EXPECT_FALSE(without["lights"][0].contains("pixel_truth"));
  r.truth_over = TruthOver::both;
  r.lights[0].pixel_truth =
      Record::PixelFacts{.rays = 64, .kept = 0.75, .tested = 300000, .error_mean = 0.0625, .error_max = 0.125};
  const Record back = read(record_line(r));
  EXPECT_EQ(record_line(back), record_line(r));
  EXPECT_EQ(back.truth_over, TruthOver::both);
  EXPECT_EQ(back.lights[0].pixel_truth->tested, 300000u);
  EXPECT_EQ(back.lights[0].pixel_truth->error_max, 0.125);
  EXPECT_TRUE(back.unknown.empty());
}

TEST(record, every_field_survives_writing_and_reading) {
  const std::string line = record_line(example());
  const Record back = read(line);
  EXPECT_EQ(record_line(back), line);  // every member is written, so equal lines are equal records
  EXPECT_EQ(back.label, "small map");
  EXPECT_EQ(back.truth, Truth::mesh);
  EXPECT_EQ(back.support, Support::Kind::approximate);
  EXPECT_EQ(back.times(Stage::resolve), example().times(Stage::resolve));  // to the last bit
  EXPECT_TRUE(back.times(Stage::build).empty());
  EXPECT_EQ(back.device_times(Stage::resolve), example().device_times(Stage::resolve));
  ASSERT_TRUE(back.floor);
  EXPECT_EQ(back.floor->pass, "depth_draw");
  EXPECT_EQ(back.floor->ms, example().floor->ms);
  EXPECT_EQ(back.floor->device_ms, example().floor->device_ms);
  EXPECT_EQ(back.harness_times(Stage::build), example().harness_times(Stage::build));
  EXPECT_EQ(back.peak_bytes, 8589934592u);
  EXPECT_EQ(back.metric("wrong_rate"), 1.0 / 3);
  EXPECT_EQ(back.metric(Truth::shape, "wrong_rate"), 0);
  EXPECT_EQ(back.gl->upload_ms, 0.25);
  EXPECT_EQ(back.scene_facts->triangles, 12u);
  EXPECT_EQ(back.path, "camera_slide");
  EXPECT_EQ(back.place, 17u);
  EXPECT_EQ(back.iterations.at("resolve"), 7u);
  EXPECT_EQ(back.stop, "target");
  EXPECT_EQ(back.causes, example().causes);
  ASSERT_EQ(back.own_causes.size(), 1u);
  EXPECT_EQ(back.own_causes[0].name, "off_screen");
  EXPECT_EQ(back.own_causes[0].sentence, "What casts the shadow is out of the picture.");
  EXPECT_EQ(back.own_causes[0].color, (std::array<std::uint8_t, 3>{252, 0, 132}));
  EXPECT_EQ(back.frames, example().frames);  // a frame without a value keeps its place
  EXPECT_TRUE(back.unknown.empty());
}

RC_GTEST_PROP(record, any_text_and_number_survives_on_one_line, ()) {
  Record r = example();
  r.scene = *rc::gen::string<std::string>();
  r.reason = *rc::gen::string<std::string>();
  const auto value = *rc::gen::arbitrary<double>();
  r.metrics[Truth::mesh]["wrong_rate"] = value;
  r.times(Stage::build) = {{std::abs(value)}};
  const std::string line = record_line(r);
  RC_ASSERT(std::count(line.begin(), line.end(), '\n') == 1);
  const Record back = read(line);
  RC_ASSERT(back.metric("wrong_rate") == (std::isfinite(value) ? std::optional(value) : std::nullopt));
  RC_ASSERT(record_line(read(record_line(back))) == record_line(back));
}

TEST(record, missing_values_are_written_as_null_and_read_as_nothing) {
  Record r;
  r.scene = "soup";
  r.technique = "none";
  r.lights.emplace_back();
  const Json json = r;
  for (const char* field :
       {"label", "support", "bytes", "peak_bytes", "gl", "mask", "error_picture", "scene_facts", "seconds", "causes"})
    EXPECT_TRUE(json.at(field).is_null()) << field;
  const Record back = json.get<Record>();
  EXPECT_FALSE(back.label || back.support || back.bytes || back.gl || back.mask || back.scene_facts || back.seconds);
  EXPECT_EQ(back.metric("wrong_rate"), std::nullopt);
}

TEST(record, infinite_and_undefined_metrics_become_null) {
  Record r = example();
  r.metrics[Truth::mesh] = {{"a", std::nan("")}, {"b", INFINITY}};
  const Record back = read(record_line(r));
  EXPECT_EQ(back.metrics.at(Truth::mesh).size(), 2u);
  EXPECT_EQ(back.metric("a"), std::nullopt);
  EXPECT_EQ(back.metric("b"), std::nullopt);
}

TEST(record, text_that_is_not_utf8_does_not_lose_the_row) {
  Record r = example();
  r.reason = "bad byte \xff here";
  EXPECT_EQ(read(record_line(r)).reason, "bad byte \xEF\xBF\xBD here");
}

TEST(record, unknown_fields_are_kept) {
  Json json = example();
  json["mood"] = "fine";
  const Record back = json.get<Record>();
  EXPECT_EQ(back.technique, "shadow_map");
  EXPECT_EQ(Json(back), json);
}

TEST(record, rows_are_sorted_by_place_within_their_suite) {
  std::vector<Record> records;
  for (const auto& [suite, place, job] : {std::tuple("b", 2, "1"), std::tuple("a", 1, "2"), std::tuple("b", 0, "3"),
                                          std::tuple("a", 0, "4"), std::tuple("a", 1, "5")}) {
    records.push_back(example(job));
    records.back().suite = suite;
    records.back().place = static_cast<std::uint64_t>(place);
  }
  sort_by_place(records);
  std::string jobs;
  for (const Record& record : records) jobs += record.job;
  EXPECT_EQ(jobs, "31425");  // suite b was there first; 2 and 5 share a place and keep their order
}

TEST(record, wrong_field_is_named_with_its_value_and_what_is_allowed) {
  const auto message = [](const char* field, Json value) -> std::string {
    Json json = example();
    json[field] = std::move(value);
    try {
      json.get<Record>();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message("width", "wide"), "width = \"wide\" is not a whole number, 0 or more");
  EXPECT_EQ(message("width", 1.5), "width = 1.5 is not a whole number, 0 or more");
  EXPECT_EQ(message("status", "fine"), "status = \"fine\" is not one of ok, unsupported, failed");
  EXPECT_EQ(message("technique", nullptr), "technique is missing");
  EXPECT_EQ(message("schema", 99), "schema = 99 is that of a newer program, this one reads 7");
  EXPECT_EQ(message("schema", 2),
            "schema = 2 is that of an older program, this one reads 7: run the rows again, or, of schema 2 to 6, convert the "
            "folder with scripts/convert_records");
  EXPECT_EQ(message("lights", Json::array()), "lights = [] is not an array of one light or more");
  EXPECT_EQ(message("answer", "fraction"), "answer = fraction is not binary, that of its lights");
  EXPECT_EQ(message("answer", "soft"), "answer = \"soft\" is not one of binary, fraction, received, transmitted");
  EXPECT_EQ(message("stages", {{"build", {{"x"}}}}), "stages.build = \"x\" is not a number");
  EXPECT_EQ(message("gl", {{"upload_ms", true}}), "gl.upload_ms = true is not a number");
  const auto color = [&](const Json& value) { return message("own_causes", Json::array({{{"color", value}}})); };
  EXPECT_EQ(color({1, 2, 256}), "own_causes.color = [1,2,256] is not three whole numbers, 0 .. 255");
  for (const Json& bad : {Json{1, 2}, Json{1, 2, -3}, Json{1, 2, 3.5}, Json{1, 2, 3, 4}, Json("red"), Json{1, 2, "3"}})
    EXPECT_NE(color(bad).find("is not three whole numbers, 0 .. 255"), std::string::npos) << bad;
  EXPECT_NE(message("own_causes", std::vector(201, Json::object())).find("is not an array of at most 200"), std::string::npos);
}

}  // namespace record_test
