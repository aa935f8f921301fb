// Runs side by side: which rows belong together, and what is said of each machine.
#include "report/analysis/machine_table.h"

#include <gtest/gtest.h>

#include <fstream>

#include "analysis_rows.h"
#include "measure/picture/picture.h"
#include "measure/scratch_folder.h"

namespace machine_table_test {
using namespace analysis_rows;

/// Drawn by a card in a tenth of the time, of which its own clock sees half.
Record on_card(Record r) {
  for (const Stage stage : {Stage::relight, Stage::resolve}) {
    for (std::vector<double>& process : r.times(stage))
      for (double& ms : process) ms /= 10;
    r.device_times(stage) = r.times(stage);
    for (std::vector<double>& process : r.device_times(stage))
      for (double& ms : process) ms /= 2;
  }
  Record::FloorTimes& floor = r.floor.emplace();
  floor.pass = "depth_draw";
  floor.ms = {{0.04}};
  floor.device_ms = {{0.03}};
  r.context["gl_renderer"] = "a card";
  return r;
}

std::vector<MachineRun> two_machines() {
  MachineRun slow{.dir = "slow", .records = {row("a", 2, 4, 0.25), row("b:n=2", 1, 1, 0.5), row("only_here", 1, 1, 0)}};
  for (Record& r : slow.records) r.context["gl_renderer"] = "software";
  MachineRun fast{.dir = "fast", .records = {on_card(row("b:n=2", 1, 1, 0.5)), on_card(row("a", 2, 4, 0.125))}};
  return {slow, fast};
}

TEST(machine_table, the_same_setting_stands_in_one_row) {
  const std::vector<MachineRun> runs = two_machines();
  const std::vector<MachineRow> rows = rows_by_machine(runs);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0], (MachineRow{&runs[0].records[0], &runs[1].records[1]}));
  EXPECT_EQ(rows[1], (MachineRow{&runs[0].records[1], &runs[1].records[0]}));
  EXPECT_EQ(rows[2], (MachineRow{&runs[0].records[2], nullptr}));
}

// A: 2 + 4 ms; B: 0.2 + 0.4, on the device 0.1 + 0.2, of which the bare pass takes 0.03; ten times as fast.
TEST(machine_table, times_of_both_clocks_ratio_bare_share_and_error) {
  const Json table = Json::parse(render_machines(two_machines(), Format::json, {}));
  const Json& first = table["rows"][0];
  EXPECT_EQ(first["A.frame_ms"], 6);
  EXPECT_NEAR(first["B.frame_ms"].get<double>(), 0.6, 1e-12);
  EXPECT_NEAR(first["B.frame_device_ms"].get<double>(), 0.3, 1e-12);
  EXPECT_NEAR(first["B.ratio"].get<double>(), 10, 1e-9);
  EXPECT_NEAR(first["B.floor_share"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(first["A.error"], 0.25);
  EXPECT_EQ(first["B.error"], 0.125);
  EXPECT_FALSE(first.contains("A.frame_device_ms"));
  EXPECT_EQ(table["rows"].size(), 2u);  // what one machine alone has is no row of both
}

// Rays of the processor in 2 + 4 ms, of the card by its own clock in 0.1 + 0.2 ms; who counts none has no number.
TEST(machine_table, rays_per_second_of_each_machine) {
  std::vector<MachineRun> runs = two_machines();
  for (Record* r : {&runs[0].records[0], &runs[1].records[1]}) r->counts = {{"rays", 120000, ""}};
  const Json table = Json::parse(render_machines(runs, Format::json, {}));
  EXPECT_NEAR(table["rows"][0]["A.rays_per_second"].get<double>(), 2e7, 1);
  EXPECT_NEAR(table["rows"][0]["B.rays_per_second"].get<double>(), 4e8, 1);
  EXPECT_TRUE(table["rows"][1]["A.rays_per_second"].is_null());
  const std::string text = render_machines(runs, Format::markdown, {});
  EXPECT_TRUE(has(text, "A rays (Mray/s)")) << text;
  EXPECT_TRUE(has(text, "rays: count rays over")) << text;
  EXPECT_FALSE(has(render_machines(two_machines(), Format::markdown, {}), "rays"));
}

void refuse(Record& record, const std::string& reason) {
  forget_results(record);
  record.status = Status::unsupported;
  record.reason = reason;
}

TEST(machine_table, what_one_machine_could_not_do_is_said_and_what_none_did_is_counted) {
  std::vector<MachineRun> runs = two_machines();
  refuse(runs[1].records[0], "it has too little memory");
  for (MachineRun& run : runs) {
    Record none = row("none", 1, 1, 0);
    refuse(none, "it cannot");
    run.records.push_back(none);
  }
  const std::string text = render_machines(runs, Format::markdown, {});
  EXPECT_TRUE(has(text, "B: soup point main b:n=2 unsupported: it has too little memory")) << text;
  EXPECT_TRUE(has(text, "left out: 1 row that no machine did")) << text;
}

TEST(machine_table, fits_a_terminal_and_says_who_is_who) {
  const std::string text = render_machines(two_machines(), Format::terminal, {.width = 80, .pixels = {}});
  EXPECT_TRUE(has(text, "A: slow, software"));
  EXPECT_TRUE(has(text, "B: fast, a card"));
  for (std::size_t at = 0; at < text.find("\nms:"); at = text.find('\n', at) + 1) EXPECT_LE(text.find('\n', at) - at, 80u);
}

TEST(machine_table, one_run_or_none_in_common_is_refused) {
  std::vector<MachineRun> runs = two_machines();
  EXPECT_THROW(render_machines(std::span(runs).first(1), Format::terminal, {}), Error);
  for (Record& r : runs[1].records) r.width = 320;
  EXPECT_THROW(render_machines(runs, Format::terminal, {}), Error);
}

// Two pixels of six are another step of eight bits; the third differs by less than half a step.
TEST(machine_table, pixels_whose_visibility_differs_are_counted_and_listed) {
  const ScratchFolder folder = ScratchFolder::temporary("machines");
  std::vector<MachineRun> runs = two_machines();
  const std::vector<float> masks[] = {{1, 1, 1, 0, 0, 0}, {1, 0, 0.9985f, 0, 0.25f, 0}};
  for (std::size_t run = 0; run < 2; ++run) {
    runs[run].dir = folder.path() / std::to_string(run);
    for (Record& r : runs[run].records) {
      r.width = 3;
      r.height = 2;
      if (r.technique != "a") continue;
      r.mask = "a.exr";
      const std::vector<std::string> names = {"point.V"};
      const std::vector<std::span<const float>> values = {masks[run]};
      write_exr(runs[run].dir / *r.mask, 3, 2, names, values);
    }
  }
  const std::filesystem::path list = folder.path() / "pixels.jsonl";
  const Json table = Json::parse(render_machines(runs, Format::json, {.width = 0, .pixels = list}));
  EXPECT_EQ(table["rows"][0]["B.differing"], 2);
  EXPECT_TRUE(table["rows"][1]["B.differing"].is_null());
  std::ifstream file(list);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const Json listed = Json::parse(line);
  EXPECT_EQ(listed["count"], 2);
  EXPECT_EQ(listed["pixels"], Json::parse("[[1, 0, 1.0, 0.0], [1, 1, 0.0, 0.25]]"));
  EXPECT_FALSE(std::getline(file, line));
}

}  // namespace machine_table_test
