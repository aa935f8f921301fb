#include "measure/run/estimate.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <thread>

#include "measure/scratch_folder.h"

namespace estimate_test {

using namespace gnomon;
namespace fs = std::filesystem;

RowCost cost(const std::string& job, const std::string& technique = "shadow_map", const std::string& scene = "soup") {
  return {.job = job,
          .scene = scene,
          .technique = technique,
          .settings = "",
          .path = "",
          .width = 100,
          .height = 100,
          .machine = "here",
          .is_measured = true,
          .once = 0.5,
          .process = 0.1,
          .stages = {0, 0, 0}};
}

Job job(const std::string& hash, const std::string& technique = "shadow_map", const std::string& scene = "soup") {
  return {hash, scene, "sun", "main", {"sun"}, {technique, "", ""}, 100, 100, "", 0};
}

TimeEstimate estimate(std::vector<RowCost> costs, const Job& of, const Effort& effort = {1, 0, 1}) {
  return Estimator(std::move(costs), "here")(std::span(&of, 1), effort);
}

TEST(estimate, seconds_grow_with_processes_warm_ups_and_repetitions_as_a_batch_spends_them) {
  RowCost slow = cost("1");
  slow.stages = {0, 0, 100};  // 100 ms: one call is one sample
  // once 0.5 + 5 x (0.1 + (3 + 3) x 0.1)
  EXPECT_NEAR(slow.seconds({5, 3, 3}), 0.5 + 5 * (0.1 + 0.6), 1e-3);
  EXPECT_NEAR(slow.seconds({1, 3, 3}), 0.5 + 0.7, 1e-3);
  EXPECT_NEAR(slow.seconds({1, 1, 10}), 0.5 + 0.1 + 1.1, 1e-3);
  slow.stages = {0, 0, 1000};  // over 0.5 s: one warm-up fills 0.3 s, and one repetition
  EXPECT_NEAR(slow.seconds({2, 3, 5}), 0.5 + 2 * (0.1 + 2), 1e-3);
  slow.stages = {0, 0, 0.1};  // 0.1 ms: sixteen calls a sample
  EXPECT_NEAR(slow.seconds({1, 3, 3}), 0.5 + 0.1 + (3 + 48) * 1e-4, 1e-4);
  slow.is_measured = false;  // unsupported: tried once
  EXPECT_EQ(slow.seconds({5, 3, 3}), 0.5);
}

RC_GTEST_PROP(estimate, a_record_gives_back_the_seconds_that_it_took, ()) {
  // Whatever the split into parts, the same effort costs the same: that is what "seconds" of the record says.
  Record r;
  r.job = "1";
  r.status = Status::ok;
  const auto ms = [] { return *rc::gen::inRange(1, 400000) / 1000.0; };
  const Effort effort{*rc::gen::inRange(1, 7), 3, *rc::gen::inRange(2, 6)};
  const std::vector<double> process(static_cast<std::size_t>(effort.repetitions), ms());
  r.times(Stage::setup) = ProcessTimes(static_cast<std::size_t>(effort.processes), {ms()});
  r.times(Stage::resolve) = ProcessTimes(static_cast<std::size_t>(effort.processes), process);
  const double least = cost_of(r).seconds(effort);  // without `seconds`: what the stages alone need
  r.seconds = least + *rc::gen::inRange(0, 10000) / 1000.0;
  RC_ASSERT(std::abs(cost_of(r).seconds(effort) - *r.seconds) < 1e-9 * (1 + *r.seconds));
}

TEST(estimate, build_that_another_light_paid_is_not_paid_twice) {
  Record r;
  r.status = Status::ok;
  r.times(Stage::build) = {{200, 200, 200}};
  r.times(Stage::resolve) = {{1, 1, 1}};
  r.seconds = 0.25;  // less than six builds: they were timed at the first light
  const RowCost cost = cost_of(r);
  EXPECT_EQ(cost.stages[0], 0);
  EXPECT_NEAR(cost.seconds({1, 3, 3}), 0.25, 1e-9);
  r.seconds = 2;
  EXPECT_EQ(cost_of(r).stages[0], 200);
}

TEST(estimate, the_nearest_row_counts) {
  // From far to near; each new row is nearer than all before it and takes over.
  Job wanted = job("1");
  wanted.contender.settings = "resolution=64";
  std::vector<RowCost> costs;
  const auto add = [&](double seconds, auto change) {
    RowCost c = cost("9");
    c.once = seconds;
    c.process = 0;
    change(c);
    costs.push_back(c);
    return estimate(costs, wanted);
  };
  EXPECT_EQ(estimate({}, wanted).unknown, 1u);
  EXPECT_EQ(add(1, [](RowCost& c) { c.technique = "other", c.scene = "box"; }).seconds, 1);
  EXPECT_EQ(add(2, [](RowCost& c) { c.scene = "box"; }).seconds, 2);
  EXPECT_EQ(add(3, [](RowCost& c) { c.scene = "hut", c.settings = "resolution=64"; }).seconds, 3);
  EXPECT_EQ(add(4, [](RowCost&) {}).seconds, 4);
  // The same row at twice the height: half of what is paid for each pixel.
  EXPECT_EQ(add(10, [](RowCost& c) { c.settings = "resolution=64", c.height = 200; }).seconds, 5);
  const TimeEstimate similar = add(6, [](RowCost& c) { c.settings = "resolution=64"; });
  EXPECT_EQ(similar.seconds, 6);
  EXPECT_EQ(similar.similar, 1u);
  const TimeEstimate exact = add(7, [](RowCost& c) { c.settings = "resolution=64", c.job = "1"; });
  EXPECT_EQ(exact.seconds, 7);
  EXPECT_EQ(exact.here, 1u);
}

TEST(estimate, each_frame_of_a_row_costs_its_references_masks_and_causes) {
  RowCost still = cost("9");  // once 0.5, a process 0.1
  still.stages = {20, 20, 60};
  Job moving = job("1");
  moving.path = "walk";
  moving.frame_count = 10;
  moving.times = FrameTimes{10, 60, 0};
  // With a repetition of four frames, each of which is taken to cost what the whole scene does: 100 ms, so two of them a
  // sample.
  EXPECT_NEAR(estimate({still}, moving).seconds, 10 * 0.5 + 0.1 + 0.1 + 2 * 0.1, 1e-9);
  RowCost moved = still;
  moved.path = "walk";
  moved.frames = 5;
  moved.motion = 10;  // 10 ms a frame: four of them a sample
  EXPECT_NEAR(estimate({moved}, moving).seconds, 2 * 0.5 + 0.1 + 0.1 + 4 * 0.01, 1e-9);
  EXPECT_NEAR(estimate({moved}, job("1")).seconds, 0.5 / 5 + 0.1 + 0.1, 1e-9) << "a still has no walk";
  moved.frames = 0;  // of a line that does not tell
  EXPECT_NEAR(estimate({moved}, moving).seconds, 0.5 + 0.1 + 0.1 + 4 * 0.01, 1e-9);
  still.is_measured = false;
  still.job = "1";
  EXPECT_EQ(estimate({still}, moving).seconds, 0.5) << "an unsupported row ends at its first frame";
}

TEST(estimate, the_walk_of_a_record_is_part_of_what_a_process_takes) {
  Record r;
  r.status = Status::ok;
  r.times(Stage::resolve) = {{1, 1}, {1, 1}};
  r.times(Stage::update) = {{20, 20}, {20, 20}};
  r.moving_times(Stage::relight) = {{5, 5}, {5, 5}};
  r.moving_times(Stage::resolve) = {{1, 1}, {1, 1}};
  r.frames["wrong_rate"] = {0, 0, 0};
  r.seconds = 3;
  const RowCost cost = cost_of(r);
  EXPECT_EQ(cost.frames, 3);
  EXPECT_EQ(cost.motion, 26);
  EXPECT_NEAR(cost.seconds({2, 3, 2}), 3, 1e-9);
  // Another process: its opening, three warm-ups and two samples of four frames, and those of resolve, of two calls.
  EXPECT_NEAR(cost.seconds({3, 3, 2}) - cost.seconds({2, 3, 2}), usual_opening + (3 + 8) * 0.026 + (3 + 4) * 0.001, 1e-9);
}

TEST(estimate, equally_near_rows_give_their_median) {
  std::vector<RowCost> costs;
  for (const double seconds : {1.0, 2.0, 100.0}) {
    costs.push_back(cost("9"));
    costs.back().once = seconds;
    costs.back().process = 0;
  }
  EXPECT_EQ(estimate(costs, job("1")).seconds, 2);
}

TEST(estimate, unsupported_rows_say_nothing_of_other_rows) {
  RowCost refused = cost("1");
  refused.is_measured = false;
  refused.once = 0.01;
  EXPECT_EQ(estimate({refused}, job("1")).seconds, 0.01);
  EXPECT_EQ(estimate({refused}, job("2")).unknown, 1u);
}

TEST(estimate, another_machine_is_scaled_by_the_jobs_that_both_have_run) {
  std::vector<RowCost> costs;
  for (int k = 0; k < 5; ++k) {
    costs.push_back(cost(std::to_string(k)));
    RowCost slow = cost(std::to_string(k));
    slow.machine = "there";
    slow.once *= 4;
    slow.process *= 4;
    costs.push_back(slow);
  }
  RowCost only_there = cost("there");
  only_there.machine = "there";
  costs.push_back(only_there);
  const TimeEstimate scaled = estimate(costs, job("there"));
  EXPECT_NEAR(scaled.seconds, 0.6 / 4, 1e-9);  // once 0.5 + one process of 0.1, four times as fast here
  EXPECT_EQ(scaled.elsewhere, 1u);
  costs.erase(costs.begin(), costs.begin() + 2);  // four jobs are too few to tell machines apart
  EXPECT_NEAR(estimate(costs, job("there")).seconds, 0.6, 1e-9);
}

TEST(estimate, says_where_it_comes_from) {
  EXPECT_EQ(text({.seconds = 250, .here = 140, .similar = 18}),
            "estimated time: 4 min 10 s (from 140 rows measured on this machine, 18 guessed from similar rows)");
  EXPECT_EQ(text({.seconds = 2, .elsewhere = 1}), "estimated time: 2 s (from 1 row measured elsewhere)");
  EXPECT_EQ(text({.unknown = 3}), "estimated time: nothing is known yet; a run that ends here is remembered");
}

class HistoryTest : public testing::Test {
 protected:
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_history");
  const fs::path dir = scratch.path();
};

TEST_F(HistoryTest, remembers_the_last_cost_of_a_job_and_skips_what_it_cannot_read) {
  const History history(dir / "deep/history.jsonl");
  EXPECT_TRUE(history.read().empty());
  RowCost first = cost("1"), again = cost("1"), elsewhere = cost("1");
  first.stages = {0.1, 1.0 / 3, 7};
  again.once = 2;
  elsewhere.machine = "there";
  history.add(std::vector{first, cost("2"), elsewhere});
  ASSERT_EQ(history.read().size(), 3u);
  EXPECT_EQ(history.read()[0].stages, first.stages);
  EXPECT_EQ(history.read()[0].seconds({}), first.seconds({}));
  std::ofstream(dir / "deep/history.jsonl", std::ios::app) << "{\"job\": \"3\"}\nnot json\n";
  history.add(std::vector{again});
  const std::vector<RowCost> costs = history.read();
  ASSERT_EQ(costs.size(), 3u);
  EXPECT_EQ(costs[0].job, "2");
  EXPECT_EQ(costs[1].machine, "there");
  EXPECT_EQ(costs[2].once, 2);
}

TEST_F(HistoryTest, lines_without_frames_are_those_of_stills_or_do_not_tell) {
  const History history(dir / "history.jsonl");
  RowCost still = cost("1"), on_path = cost("2"), moving = cost("3");
  on_path.path = "orbit";
  moving.path = "walk";
  moving.frames = 7;
  moving.motion = 2.5;
  history.add(std::vector{still, on_path, moving});
  EXPECT_EQ(history.read()[2].frames, 7);
  EXPECT_EQ(history.read()[2].motion, 2.5);
  std::string text;
  std::ifstream lines(dir / "history.jsonl");
  for (std::string line; std::getline(lines, line);) {
    Json json = Json::parse(line);
    json.erase("frames");
    json.erase("motion");
    text += json.dump() + "\n";
  }
  std::ofstream(dir / "history.jsonl") << text;
  ASSERT_EQ(history.read().size(), 3u);
  EXPECT_EQ(history.read()[0].frames, 1);
  EXPECT_EQ(history.read()[1].frames, 0);
  EXPECT_EQ(history.read()[2].motion, 0);
}

TEST_F(HistoryTest, forgets_the_oldest_rows_beyond_its_bound) {
  const History history(dir / "history.jsonl");
  std::vector<RowCost> many;
  for (std::size_t k = 0; k < History::most_rows; ++k) many.push_back(cost(std::to_string(k)));
  history.add(many);
  history.add(std::vector{cost("new"), cost("0")});
  const std::vector<RowCost> costs = history.read();
  EXPECT_EQ(costs.size(), History::most_rows);
  EXPECT_EQ(costs.front().job, "2");  // "0" is young again, "1" was the oldest
  EXPECT_EQ(costs.back().job, "0");
}

TEST_F(HistoryTest, writers_at_the_same_time_lose_nothing) {
  const fs::path file = dir / "history.jsonl";
  std::vector<std::thread> writers;
  for (int w = 0; w < 4; ++w)
    writers.emplace_back([&, w] {
      for (int k = 0; k < 10; ++k) History(file).add(std::vector{cost(fmt::format("{}-{}", w, k))});
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_EQ(History(file).read().size(), 40u);
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), {}), 2);  // the file and its lock
}

TEST_F(HistoryTest, a_place_that_cannot_be_written_is_an_error) {
  std::ofstream(dir / "file") << "no folder";
  EXPECT_THROW(History(dir / "file/history.jsonl").add(std::vector{cost("1")}), Error);
}

}  // namespace estimate_test
