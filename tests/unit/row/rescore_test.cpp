#include "measure/row/rescore.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <fstream>

#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/row/row.h"
#include "measure/scene/load.h"
#include "measure/score/score.h"
#include "measure/scratch_folder.h"

namespace rescore_test {

using namespace gnomon;
namespace fs = std::filesystem;

/// A run's folder with one record whose mask the test writes by hand.
class RescoreTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(dir_ / "masks"); }

  /// The record of a scene's first view and light, as a run would leave it with no metrics.
  Record row(const std::string& scene_name) {
    scene_ = load_scene(scene_name);
    Record record;
    record.job = "0123456789abcdef";
    record.scene = scene_name;
    record.technique = "shadow_map";
    record.light = scene_.lights.front().name;
    const Light* const lights[] = {&scene_.lights.front()};
    describe_lights(record, scene_, lights);
    record.view = scene_.views.front().name;
    record.width = width, record.height = height;
    record.status = Status::ok;
    record.mask = "masks/mask.exr";
    FrameStore frames(scene_, cache_root() / "frames");
    record.context["scene_hash"] = frames.scene_hash({scene_.lights.front().name});
    record.context["frames"] = frame_version();
    return record;
  }
  Reference reference(Truth truth) {
    FrameStore frames(scene_, cache_root() / "frames");
    return frames.reference({scene_.views.front(), width, height, scene_.has_curved_shapes() ? truth : Truth::shape},
                            scene_.lights.front());
  }
  void write(const std::map<std::string, std::vector<float>>& channels) {
    std::vector<std::string> names;
    std::vector<std::span<const float>> values;
    for (const auto& [name, mask] : channels) {
      names.push_back(scene_.lights.front().name + "." + name);
      values.push_back(mask);
    }
    write_exr(dir_ / "masks/mask.exr", width, height, names, values);
  }
  /// Rescores the one record.
  RescoreSummary again(Record& record) {
    std::vector<Record> records{record};
    Progress quiet(true);
    const RescoreSummary result = rescore(records, dir_, quiet);
    record = records.front();
    return result;
  }
  std::string complaint(Record record) {
    try {
      again(record);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
  static std::vector<float> floats(std::span<const float> values) { return {values.begin(), values.end()}; }

  static constexpr int width = 64, height = 36;
  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon_rescore");
  const fs::path& dir_ = scratch_.path();
  Scene scene_;
};

TEST_F(RescoreTest, the_reference_itself_is_right_and_its_opposite_wrong_everywhere) {
  Record record = row("single_triangle");
  std::vector<float> mask = floats(reference(Truth::shape).mask);
  write({{"V", mask}});
  EXPECT_EQ(again(record).rows, 1u);
  EXPECT_EQ(record.metric("wrong_rate"), 0);
  EXPECT_EQ(record.metric("ssim"), 1);
  EXPECT_EQ(record.metric("flip"), 0);
  EXPECT_EQ(record.metrics[Truth::mesh], record.metrics[Truth::shape]) << "no curved shape: one truth";
  EXPECT_EQ(record.classes, class_counts(reference(Truth::shape).classes));
  EXPECT_EQ(record.causes, std::nullopt) << "no channel, no causes";

  for (float& v : mask) v = 1 - v;
  write({{"V", mask}});
  again(record);
  EXPECT_EQ(record.metric("wrong_rate"), 1);
  EXPECT_EQ(*record.metric("false_dark_rate") + *record.metric("false_lit_rate"), 1);
}

TEST_F(RescoreTest, causes_are_counted_by_name) {
  Record record = row("single_triangle");
  std::vector<float> causes(width * height, 0.0f);
  causes[5] = causes[6] = static_cast<float>(Cause::acne);
  causes[7] = static_cast<float>(Cause::unexplained);
  write({{"V", floats(reference(Truth::shape).mask)}, {"cause", causes}});
  again(record);
  ASSERT_TRUE(record.causes.has_value());
  EXPECT_EQ(record.causes->at("acne"), 2u);
  EXPECT_EQ(record.causes->at("unexplained"), 1u);
  EXPECT_EQ(record.causes->at("edge_resolution"), 0u);
}

TEST_F(RescoreTest, the_snapping_floor_is_that_of_the_frame) {
  Record record = row("fence");
  record.metrics[Truth::shape] = record.metrics[Truth::mesh] = {{"wrong_rate", 0.25}};
  const Reference truth = reference(Truth::shape);
  write({{"V", floats(truth.mask)}});
  again(record);
  EXPECT_EQ(record.metric("wrong_rate"), 0.0);
  const auto flips = static_cast<double>(std::ranges::count(truth.snapping, 1));
  const auto tested = static_cast<double>(std::ranges::count(truth.classes, PixelClass::T));
  EXPECT_GT(flips, 0);
  EXPECT_EQ(record.metric(Truth::shape, "snapping_floor"), flips / tested);
  EXPECT_EQ(record.metric(Truth::mesh, "snapping_floor"), flips / tested) << "no curved shape, so that both truths are one";
}

TEST_F(RescoreTest, causes_of_other_frames_are_dropped_and_said) {
  const auto lost = [](const RescoreSummary& result) {
    return result.notes.size() == 1 && result.notes[0].find("1 row loses its causes") != std::string::npos;
  };
  Record record = row("single_triangle");
  // One tested pixel is wrong, and a cause tells why.
  const Reference truth = reference(Truth::shape);
  const auto tested = std::find(truth.classes.begin(), truth.classes.end(), PixelClass::T) - truth.classes.begin();
  std::vector<float> mask = floats(truth.mask), causes(width * height, 0.0f);
  mask[static_cast<std::size_t>(tested)] = 1 - mask[static_cast<std::size_t>(tested)];
  causes[static_cast<std::size_t>(tested)] = static_cast<float>(Cause::acne);
  write({{"V", mask}, {"cause", causes}});
  EXPECT_TRUE(again(record).notes.empty());
  ASSERT_TRUE(record.causes);
  EXPECT_EQ(record.causes->at("acne"), 1u);

  const std::map<std::string, std::uint64_t> counted = *record.causes;
  record.context["frames"] = frame_version() - 1;
  EXPECT_TRUE(lost(again(record)));
  EXPECT_EQ(record.causes, std::nullopt);
  EXPECT_EQ(record.lights[0].causes, std::nullopt);
  EXPECT_EQ(record.context["frames"], frame_version() - 1) << "the mask in the folder is as old as before";

  // Counts that no channel repeats are those of another mask.
  record.context["frames"] = frame_version();
  write({{"V", mask}});
  record.causes = record.lights[0].causes = counted;
  EXPECT_TRUE(lost(again(record)));
  EXPECT_EQ(record.causes, std::nullopt);
}

TEST_F(RescoreTest, each_truth_is_scored_against_its_own_mask_and_keeps_its_values_without_one) {
  Record record = row("sphere_over_plane");
  const auto shape = floats(reference(Truth::shape).mask), mesh = floats(reference(Truth::mesh).mask);
  record.metrics[Truth::mesh]["wrong_rate"] = 0.125;
  write({{"V", shape}});
  again(record);
  EXPECT_EQ(record.metric(Truth::shape, "wrong_rate"), 0);
  EXPECT_EQ(record.metrics[Truth::mesh], (Metrics{{"wrong_rate", 0.125}}));
  auto wrong = mesh;
  for (float& v : wrong) v = 1 - v;
  write({{"V", shape}, {"mesh", wrong}});
  again(record);
  EXPECT_EQ(record.metric(Truth::shape, "wrong_rate"), 0);
  EXPECT_EQ(record.metric(Truth::mesh, "wrong_rate"), 1);
  // The headline truth may be the other one.
  record.truth = Truth::mesh;
  write({{"V", mesh}, {"shape", shape}});
  again(record);
  EXPECT_EQ(record.metric(Truth::shape, "wrong_rate"), 0);
  EXPECT_EQ(record.metric(Truth::mesh, "wrong_rate"), 0);
}

TEST_F(RescoreTest, a_broken_mask_is_named_with_its_row) {
  const Record record = row("single_triangle");
  auto mask = floats(reference(Truth::shape).mask);
  const auto says = [&](std::initializer_list<const char*> words) {
    const std::string text = complaint(record);
    EXPECT_NE(text.find("single_triangle"), text.npos) << text;
    for (const char* word : words) EXPECT_NE(text.find(word), text.npos) << text;
  };
  says({"masks/mask.exr", "not there"});
  for (const float wild : {-0.5f, 1.5f, NAN}) {
    auto spoiled = mask;
    spoiled[100] = wild;
    write({{"V", spoiled}});
    says({"pixel 100", "0 .. 1"});
  }
  for (const float wild : {0.5f, -1.0f, static_cast<float>(Cause::unexplained) + 1, 1e9f, NAN}) {
    std::vector<float> causes(mask.size(), 0.0f);
    causes[3] = wild;
    write({{"V", mask}, {"cause", causes}});
    says({"cause", "whole number"});
  }
  write({{"other", mask}});
  says({"no channel"});
  std::ofstream(dir_ / "masks/mask.exr") << "not a picture";
  says({"masks/mask.exr"});
}

TEST_F(RescoreTest, rows_that_are_not_ok_are_passed_over) {
  Record record = row("single_triangle");
  record.status = Status::unsupported;
  record.mask = std::nullopt;
  const RescoreSummary result = again(record);
  EXPECT_EQ(result.rows, 0u);
  EXPECT_TRUE(result.notes.empty());
}

TEST_F(RescoreTest, records_are_replaced_as_a_whole) {
  Record record = row("single_triangle");
  RecordWriter writer(dir_);
  writer.append(record);
  record.metrics[Truth::shape]["wrong_rate"] = 0.5;
  writer.replace(std::vector{record, record});
  // One job counts once, by its last line.
  const auto kept = read_record_file(records_file(dir_)).records;
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept.front().metric("wrong_rate"), 0.5);
}

}  // namespace rescore_test
