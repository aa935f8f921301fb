// Each rule of a submission on records that break it alone.
#include <gtest/gtest.h>

#include "measure/submission/rules.h"
#include "submission/submitted.h"

namespace submission_rules_test {

using namespace submitted;
using Lines = std::vector<std::string>;

std::string all(const Lines& lines) { return joined(lines, "\n"); }

TEST(submission_rules, a_right_submission_breaks_none) {
  const World world;
  EXPECT_EQ(all(world.rows().faults), "");
  EXPECT_EQ(all(world.rows().notes), "");
  EXPECT_EQ(all(origin_faults(world.submission)), "");
  EXPECT_EQ(all(system_faults(world.submission)), "");
  EXPECT_EQ(all(time_faults(world.submission.records)), "");
  EXPECT_EQ(all(tuning_faults(world.submission.facts, world.edition, {"fence", "soup", "terrain"})), "");
}

/// One fault, which has these words.
void expect_one(const Lines& faults, const std::string& words) {
  ASSERT_EQ(faults.size(), 1u) << all(faults);
  EXPECT_NE(faults[0].find(words), std::string::npos) << faults[0];
}

TEST(submission_rules, a_row_that_the_edition_does_not_have) {
  World world;
  world.add(world.row(place("fence", "lamp"), contender("shadow_map")));
  expect_one(world.rows().faults, "it is no row of the edition: fence lamp shadow_map");
}

TEST(submission_rules, a_row_that_is_missing_and_a_row_that_is_there_twice) {
  World world;
  world.submission.records.push_back(world.submission.records[0]);
  expect_one(world.rows().faults, "it is there twice: fence point shadow_map");
  world.submission.records.erase(world.submission.records.begin(), world.submission.records.begin() + 1);
  world.submission.records.pop_back();
  expect_one(world.rows().faults, "1 row of the edition is missing: fence point shadow_map");
}

TEST(submission_rules, a_group_may_be_missing_where_the_technique_supports_nothing_of_it) {
  World world;
  world.submission.records.clear();
  for (const Job& job : world.places[0]) world.add(world.row(job, contender("mine")));
  const RowFaults unknown = world.rows();
  EXPECT_EQ(all(unknown.faults), "");
  expect_one(unknown.notes, "mine has no row at some places of the edition, and is not here");
  EXPECT_EQ(all(world.rows([](const Contender&, std::size_t) { return true; }).notes), "");
  expect_one(world.rows([](const Contender&, std::size_t) { return false; }).faults,
             "1 row of the edition is missing: soup sun mine");
}

TEST(submission_rules, a_row_of_another_scene_size_or_light_than_its_name_says) {
  World world;
  world.submission.records[0].context["scene_hash"] = "another";
  expect_one(world.rows().faults, "its scene is not that of the edition");
  world = World();
  world.submission.records[1].width = 32;
  expect_one(world.rows().faults, "its size is 32x36, and the edition's is 64x36: fence sun shadow_map");
  world = World();
  world.submission.records[1].lights[0].name = "moon";
  expect_one(world.rows().faults, "its lights is moon, and the edition's is sun");
}

TEST(submission_rules, settings_by_division) {
  World world;
  world.submission.records.clear();
  for (const Job& job : world.places[0]) {
    world.add(world.row(job, contender("shadow_map", "resolution=512")));
    world.submission.records.back().parameters["resolution"] = 512;
  }
  world.places.pop_back();
  world.edition.suite.groups.pop_back();
  expect_one(world.rows().faults,
             "division default has the settings as they are shipped, and shadow_map:resolution=512 is set");
  world.submission.facts.division = Division::tuned;
  EXPECT_EQ(all(world.rows().faults), "");
  world.submission.records[1] = world.row(world.places[0][1], contender("shadow_map", "resolution=256"));
  world.submission.records[1].parameters["resolution"] = 256;
  const std::string faults = all(world.rows().faults);
  EXPECT_NE(faults.find("one setting of a technique at all places, and shadow_map has 2"), std::string::npos) << faults;
  world.submission.facts.division = Division::open;
  EXPECT_EQ(all(world.rows().faults), "");
}

TEST(submission_rules, parameters_that_are_no_defaults_and_no_settings) {
  World world;
  world.submission.records[0].parameters["resolution"] = 4096;
  expect_one(world.rows().faults, "its resolution = 4096 is not the default 1024");
}

TEST(submission_rules, other_effort_and_no_mask) {
  World world;
  for (Record& record : world.submission.records) record.times(Stage::resolve) = {{1, 2, 3}};
  expect_one(world.rows().faults,
             "it was run with 1 process, and the edition asks for 2: fence point shadow_map and 1 more row");
  world = World();
  world.submission.records[0].times(Stage::relight)[1] = {1, 2};
  expect_one(world.rows().faults, "it was run with 2 repetitions, and the edition asks for 3");
  world = World();
  world.submission.records[0].mask.reset();
  expect_one(world.rows().faults, "it has no mask");
}

TEST(submission_rules, metrics_of_another_version) {
  World world;
  world.submission.facts.metrics["error"] = 2;
  expect_one(world.rows().faults, "metric error is of version 2, and the edition's of 1");
  world = World();
  world.submission.records[0].metrics[Truth::shape]["beauty"] = 1;
  expect_one(world.rows().faults, "its metric beauty has no version");
}

TEST(submission_rules, a_program_that_was_no_commit) {
  World world;
  world.submission.records[0].context["commit"] = "0a1b2c-dirty";
  EXPECT_NE(all(origin_faults(world.submission)).find("a program of commit '0a1b2c-dirty' made it, and a clean one is wanted"),
            std::string::npos);
  world = World();
  world.submission.runs[0]["changes"] = "diff --git";
  expect_one(origin_faults(world.submission), "run.json: run 1 is by a program that was built of changed sources");
  world.submission.runs[0]["changes"] = nullptr;
  expect_one(origin_faults(world.submission), "does not say that its program was built of a commit without changes");
  world = World();
  world.submission.runs[0]["edition"]["division"] = "open";
  expect_one(origin_faults(world.submission), "run 1 is of division open, and the submission of default");
  world.submission.runs[0].erase("edition");
  expect_one(origin_faults(world.submission), "run 1 is not of an edition");
}

TEST(submission_rules, code_that_is_not_the_one_that_is_named) {
  World world;
  world.submission.facts.techniques[0].hash = "another";
  expect_one(origin_faults(world.submission),
             "technique shadow_map is of gnomon 0a1b2c (another), and its rows are of gnomon 0a1b2c (s)");
  world.submission.facts.techniques.clear();
  expect_one(origin_faults(world.submission), "technique shadow_map has rows, and submission.json does not name it");
}

TEST(submission_rules, a_system_that_is_not_told_or_not_that_of_the_rows) {
  for (const char* const key :
       {"processor", "cores", "memory_bytes", "clock_mhz", "os", "kernel", "compiler", "embree", "driver", "load_average"}) {
    World world;
    world.submission.facts.system.erase(key);
    const std::string faults = all(system_faults(world.submission));
    EXPECT_NE(faults.find(fmt::format("the system lacks {}", key)), std::string::npos) << key << ": " << faults;
  }
  World world;
  world.submission.records[1].context["processor"] = "a slide rule";
  expect_one(system_faults(world.submission), "rows have several values of processor: a slide rule, an abacus");
  world.submission.records[0].context["processor"] = "a slide rule";
  expect_one(system_faults(world.submission), "processor of the system is an abacus, and of the rows a slide rule");
}

TEST(submission_rules, times_that_contradict_each_other) {
  const auto faults = [](const std::function<void(Record&)>& change) {
    World world;
    change(world.submission.records[0]);
    return time_faults(world.submission.records);
  };
  expect_one(faults([](Record& r) { r.seconds = 0.29; }), "take longer together than the row");
  EXPECT_EQ(all(faults([](Record& r) { r.seconds = 0.3; })), "");
  expect_one(faults([](Record& r) {
               r.times(Stage::resolve) = {{2, 2, 2}, {2, 2, 2}};
             }),
             "all its times of resolve are one number");
  expect_one(faults([](Record& r) { r.times(Stage::relight)[0][1] = -1; }), "a time of its stages is below 0");
  expect_one(faults([](Record& r) {
               r.device_times(Stage::resolve) = {{9, 9, 9}, {9, 9, 9}};
             }),
             "longer by the device's clock");
  expect_one(faults([](Record& r) { r.times(Stage::relight).clear(); }), "it has no times of relight");
  expect_one(faults([](Record& r) { r.status = Status::failed; }), "it has times, and no answer");
}

TEST(submission_rules, words_on_tuning_name_training_scenes_alone) {
  World world;
  const Lines scenes = {"fence", "soup", "terrain", "bush"};
  SubmissionFacts& facts = world.submission.facts;
  const auto faults = [&] { return tuning_faults(facts, world.edition, scenes); };
  facts.tuning = "by hand";
  expect_one(faults(), "division default has no tuning");
  facts.division = Division::tuned;
  expect_one(faults(), "tuning names no training scene; they are terrain, bush");
  facts.tuning = "gnomon tune on terrain";
  EXPECT_EQ(all(faults()), "");
  facts.tuning = "gnomon tune on terrain and fence.";
  expect_one(faults(), "tuning names fence, which is a scene and none to find settings on");
  facts.tuning = "on terrain, behind fences";  // a part of a word is none
  EXPECT_EQ(all(faults()), "");
  facts.tuning.reset();
  expect_one(faults(), "division tuned says how settings were found");
}

}  // namespace submission_rules_test
