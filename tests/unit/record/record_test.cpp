#include "measure/record/record.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>

#include "measure/scratch_folder.h"

namespace record_test {

using namespace gnomon;
namespace fs = std::filesystem;

/// A folder of its own for each test, gone afterwards.
// 0.02 of 0.1 + 0.3 ms by the device's clock, else 0.5 of 1 + 1 by the host's.
TEST(Record, share_of_the_bare_pass_is_by_the_device_where_both_are) {
  Record r;
  EXPECT_FALSE(floor_share(r));
  r.times(Stage::relight) = r.times(Stage::resolve) = {{1}};
  r.floor.emplace().ms = {{0.5}};
  EXPECT_NEAR(floor_share(r).value(), 0.25, 1e-12);
  r.floor->device_ms = {{0.02}};
  EXPECT_NEAR(floor_share(r).value(), 0.25, 1e-12);  // the stages have no such time
  r.device_times(Stage::relight) = {{0.1}};
  r.device_times(Stage::resolve) = {{0.3}};
  EXPECT_NEAR(floor_share(r).value(), 0.05, 1e-12);
}

// 3,000 rays in 2 + 4 ms are 500,000 in a second; by the device's clock in 0.5 + 1 ms four times as many.
TEST(Record, rays_per_second_are_those_of_a_frame_by_the_device_where_it_has_a_clock) {
  Record r;
  r.times(Stage::relight) = {{2}};
  r.times(Stage::resolve) = {{4}};
  EXPECT_FALSE(rays_per_second(r));  // it counts none
  r.counts = {{"texels", 7, "texel"}, {"rays", 3000, ""}};
  EXPECT_NEAR(rays_per_second(r).value(), 500000, 1e-6);
  r.device_times(Stage::resolve) = {{1}};
  EXPECT_NEAR(rays_per_second(r).value(), 500000, 1e-6);  // half of a frame is no frame
  r.device_times(Stage::relight) = {{0.5}};
  EXPECT_NEAR(rays_per_second(r).value(), 2000000, 1e-6);
  r.stages = {};
  r.device_stages = {};
  EXPECT_FALSE(rays_per_second(r));
}

TEST(Record, clocks_disagree_where_both_cannot_be_right) {
  Record r;
  r.times(Stage::resolve) = {{1}};
  EXPECT_FALSE(clocks_agree(r).has_value());  // there is only one
  r.device_times(Stage::resolve) = {{0.1}};
  EXPECT_EQ(clocks_agree(r), true);  // the rest is the processor's own work
  r.device_times(Stage::resolve) = {{1.2}};
  EXPECT_EQ(clocks_agree(r), false);  // longer than whoever waited for it
  r.device_times(Stage::resolve) = {{0.9}};
  r.floor.emplace().ms = {{1}};
  r.floor->device_ms = {{0.1}};
  EXPECT_EQ(clocks_agree(r), false);  // nothing but the device works in a bare pass
  r.floor->device_ms = {{0.8}};
  EXPECT_EQ(clocks_agree(r), true);
}

class RecordFileTest : public testing::Test {
 protected:
  void write(const std::string& text) const { std::ofstream(records_file(dir), std::ios::binary) << text; }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(records_file(dir), std::ios::binary).rdbuf();
    return all.str();
  }

  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_record");
  const fs::path& dir = scratch.path();
};

Record example(const std::string& job = "00ff") {
  Record r;
  r.job = job;
  r.suite = "quick";
  r.scene = "soup:ground=false";
  r.light = "point";
  r.light_kind = "point";
  r.view = "main";
  r.technique = "shadow_map";
  r.settings = "resolution=256";
  r.label = "small map";
  r.parameters = {{"resolution", 256}, {"filter", "nearest"}};
  r.width = 640;
  r.height = 480;
  r.truth = Truth::mesh;
  r.path = "camera_slide";
  r.place = 17;
  r.status = Status::ok;
  r.support = Support::Kind::approximate;
  r.reason = "one face of the cube";
  r.times(Stage::setup) = {{12.5}, {13}};
  r.times(Stage::resolve) = {{0.1, 0.2, 0.30000000000000004}, {1e-3, 2, 3}};
  r.device_times(Stage::resolve) = {{0.05, 0.1, 0.15}};
  r.harness_times(Stage::build) = {{2.5}, {3.5}};
  r.iterations = {{"resolve", 7}};
  r.stop = "target";
  r.counts = {{"texels", 65536, "texel"}};
  r.bytes = 262144;
  r.peak_bytes = 8589934592;  // beyond 32 bits
  Record::FloorTimes& floor = r.floor.emplace();
  floor.pass = "depth_draw";
  floor.ms = {{0.5, 0.25}, {0.75}};
  floor.device_ms = {{0.125}};
  r.gl = GlInputs{.input_bytes = 1000, .upload_ms = 0.25, .geometry_bytes = 36, .loose_bytes = 0};
  r.classes = {{"B", 10}, {"T", 307190}};
  r.metrics[Truth::mesh] = {{"wrong_rate", 1.0 / 3}, {"displacement_mean", std::nullopt}};
  r.metrics[Truth::shape] = {{"wrong_rate", 0.0}};
  r.causes = {{"acne", 3}, {"crack", 0}, {"off_screen", 2}};
  r.own_causes = {{"off_screen", "What casts the shadow is out of the picture.", {252, 0, 132}}};
  r.frames = {{"wrong_rate", {0.5, std::nullopt, 1.0 / 3}}};
  r.mask = "masks/00ff.exr";
  Record::LightFacts& light = r.lights.emplace_back();
  light.name = light.kind = "point";
  light.support = Support::Kind::approximate;
  light.classes = r.classes;
  light.metrics = r.metrics[Truth::mesh];
  light.causes = r.causes;
  r.scene_facts = Record::SceneFacts{.meshes = 2, .triangles = 12, .closed = true};
  r.notes = {"framing camera"};
  r.context = {{"processor", "an abacus"}, {"threads", 2}};
  r.seconds = 1.5;
  return r;
}

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

TEST_F(RecordFileTest, a_newer_schema_is_refused_with_file_and_line) {
  Json newer = example();
  newer["schema"] = record_schema + 1;
  write(record_line(example("1")) + newer.dump() + "\n");
  try {
    read_records(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string said = fmt::format("records.jsonl:2: schema = {} is that of a newer program", record_schema + 1);
    EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
  }
}

TEST_F(RecordFileTest, what_was_appended_is_read_in_order) {
  RecordWriter writer(dir);
  for (const char* job : {"1", "2", "3"}) writer.append(example(job));
  writer.close();
  const std::vector<Record> records = read_records(dir);
  ASSERT_EQ(records.size(), 3u);
  EXPECT_EQ(records[0].job + records[1].job + records[2].job, "123");
}

TEST_F(RecordFileTest, job_that_ran_again_counts_once_by_its_last_line) {
  Record first = example("1"), again = example("1");
  first.status = Status::failed;
  write(record_line(first) + record_line(example("2")) + record_line(again));
  const std::vector<Record> records = read_records(dir);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].job, "1");
  EXPECT_EQ(records[0].status, Status::ok);
}

TEST_F(RecordFileTest, unfinished_last_line_is_left_out_with_a_note_wherever_it_was_cut) {
  const std::string whole = record_line(example("1")), cut = record_line(example("2"));
  for (const std::size_t length : {std::size_t{1}, cut.size() / 2, cut.size() - 2}) {
    write(whole + cut.substr(0, length));
    const RecordFile file = read_record_file(records_file(dir));
    EXPECT_EQ(file.records.size(), 1u);
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_NE(file.notes[0].find("records.jsonl:2: the last line is unfinished"), std::string::npos);
  }
  write(whole + cut.substr(0, cut.size() - 1));  // only the newline is missing
  EXPECT_EQ(read_record_file(records_file(dir)).records.size(), 2u);
}

TEST_F(RecordFileTest, torn_line_in_the_middle_is_an_error_with_file_and_line) {
  const std::string line = record_line(example());
  write(line + line.substr(0, 40) + "\n" + line);
  try {
    read_records(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("records.jsonl:2: not a record"), std::string::npos) << error.what();
  }
}

TEST_F(RecordFileTest, folder_without_records_is_an_error_and_an_empty_file_is_not) {
  EXPECT_THROW(read_records(dir), Error);
  write("");
  EXPECT_TRUE(read_records(dir).empty());
}

TEST_F(RecordFileTest, writer_mends_the_line_of_a_killed_run_before_it_appends) {
  const std::string whole = record_line(example("1")), cut = record_line(example("2")), next = record_line(example("3"));
  write(whole + cut.substr(0, cut.size() / 2));
  RecordWriter(dir).append(example("3"));
  EXPECT_EQ(text(), whole + next);
  write(whole + cut.substr(0, cut.size() - 1));
  RecordWriter(dir).append(example("3"));
  EXPECT_EQ(text(), whole + cut + next);
}

TEST_F(RecordFileTest, unfinished_line_longer_than_a_block_is_found_whole) {
  Record large = example("2");
  large.reason = std::string(20000, 'x');
  const std::string whole = record_line(example("1")), cut = record_line(large);
  write(whole + cut.substr(0, 15000));
  RecordWriter{dir};
  EXPECT_EQ(text(), whole);
}

TEST_F(RecordFileTest, second_writer_on_the_same_folder_is_refused) {
  RecordWriter first(dir);
  EXPECT_THROW(RecordWriter{dir}, Error);
  first.close();
  EXPECT_NO_THROW(RecordWriter{dir});
}

TEST_F(RecordFileTest, replaced_records_are_there_at_once_and_stay_the_writers) {
  RecordWriter writer(dir);
  for (const char* job : {"1", "2", "3"}) writer.append(example(job));
  writer.replace(std::vector{example("2")});
  EXPECT_EQ(text(), record_line(example("2")));
  EXPECT_THROW(RecordWriter{dir}, Error) << "the new file is locked like the old one";
  writer.append(example("4"));
  EXPECT_EQ(text(), record_line(example("2")) + record_line(example("4")));
  writer.close();
  EXPECT_NO_THROW(RecordWriter{dir});
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), fs::directory_iterator()), 1) << "nothing else is left in the folder";
}

TEST_F(RecordFileTest, device_in_place_of_the_file_is_refused) {
  fs::create_symlink("/dev/full", records_file(dir));
  try {
    const RecordWriter writer(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("it is there and no regular file"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(fs::is_symlink(records_file(dir)));
}

TEST_F(RecordFileTest, write_that_fits_only_in_part_is_taken_back) {
  RecordWriter writer(dir);
  writer.append(example("1"));
  const std::string before = text();
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{before.size() + 50, old.rlim_max};  // the next line is longer than 50 bytes
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  try {
    writer.append(example("2"));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the record of shadow_map 2 could not be written: only 50 of "), std::string::npos)
        << error.what();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(text(), before);
  EXPECT_NO_THROW(writer.append(example("2")));
  EXPECT_EQ(read_records(dir).size(), 2u);
}

}  // namespace record_test
