// Tables, pages and figures of rows whose geometry moves.
#include "report/figure/figure.h"
#include "report/figure/figure_style.h"
#include "report/html/html_parts.h"
#include "table_rows.h"

namespace moving_rows_test {

using namespace table_rows;

/// Update 3, then relight 0.5 and resolve 2.5; relight 4 at the first frame.
Record moving(const std::string& technique) {
  Record r = row(technique, 2, 0.1);
  r.path = "walk";
  r.start = 0.5;
  r.frame_rate = 60;
  r.times(Stage::build) = {{1}, {1}, {1}, {1}, {1}};
  r.times(Stage::relight) = {{4}, {4}, {4}, {4}, {4}};
  r.times(Stage::update) = {{3}, {3}, {3}, {3}, {3}};
  r.moving_times(Stage::relight) = {{0.5}, {0.5}, {0.5}, {0.5}, {0.5}};
  r.moving_times(Stage::resolve) = {{2.5}, {2.5}, {2.25}, {2.5}, {2.75}};
  return r;
}

/// As `moving`, without motion.
Record still(const std::string& technique) {
  Record r = moving(technique);
  r.path.clear();
  r.start.reset();
  r.frame_rate.reset();
  r.times(Stage::update).clear();
  r.moving_stages = {};
  return r;
}

TEST(moving_rows, columns_have_each_time_and_the_cost_with_its_interval) {
  const std::vector<Record> records{moving("a"), still("b")};
  const std::vector<std::string> times{"update_ms", "relight_ms", "moving_relight_ms", "moving_resolve_ms", "motion_ms"};
  EXPECT_EQ(render_table(records, Format::csv, {.columns = times}), joined(times, ",") + "\r\n3,4,0.5,2.5,6\r\n,4,,,\r\n");
  const std::vector<std::string> ends{"motion_ms_low", "motion_ms_high", "update_ms_mad", "moving_resolve_ms_low"};
  const std::vector<std::string> lines = lines_of(render_table(records, Format::csv, {.columns = ends}));
  EXPECT_EQ(lines[1], "5.75,6.25,0,2.25\r");
  EXPECT_EQ(lines[2], ",,,\r");
  EXPECT_EQ(render_table(records, Format::csv, {.columns = {"start", "frame_rate"}}), "start,frame_rate\r\n0.5,60\r\n,\r\n");
}

TEST(moving_rows, a_headline_has_update_and_motion_where_a_row_has_them) {
  const std::vector<Record> with{moving("a"), moving("b")}, without{still("a"), still("b")};
  const auto header = [](const std::vector<Record>& records) {
    return line_with(render_table(records, Format::markdown), "| technique ");
  };
  EXPECT_TRUE(has(header(with), "| build (ms) | update (ms) | relight (ms) | resolve (ms) | motion (ms) |")) << header(with);
  EXPECT_TRUE(has(header(without), "| build (ms) | relight (ms) | resolve (ms) |")) << header(without);
  EXPECT_TRUE(has(render_table(with, Format::latex), "update"));
  EXPECT_FALSE(has(render_table(without, Format::latex), "update"));
  EXPECT_FALSE(has(render_table(without, Format::terminal), "motion"));
  const std::string text = render_table(with, Format::terminal);
  EXPECT_TRUE(has(text, "\nmotion: update, and relight and resolve after it;")) << text;
  EXPECT_TRUE(has(text, "path walk from 0.5 s at 60 Hz, 640 x 480")) << text;
}

TEST(moving_rows, of_several_rates_each_has_a_group_and_the_rate_a_column) {
  std::vector<Record> records{moving("a"), moving("a")};
  records[1].frame_rate = 120;
  EXPECT_TRUE(has(lines_of(render_table(records, Format::markdown))[0], "| path | frame rate (Hz) |"));
  EXPECT_FALSE(has(render_table(records, Format::terminal), "*")) << "rows of two groups do not compete";
}

TEST(moving_rows, a_page_has_the_cost_of_the_event_and_its_stages) {
  const std::vector<Record> records{moving("a"), still("b")};
  const auto data_of = [](const std::vector<Record>& rows) {
    std::vector<std::string> names;
    for (const Column& column : all_columns(rows)) names.push_back(column.name);
    return report_data(lay_out(rows, names), rows);
  };
  const Json data = data_of(records);
  EXPECT_EQ(data["stages"], (Json{"setup", "build", "update", "relight", "resolve", "moving_relight", "moving_resolve"}));
  std::map<std::string, std::string> headings;
  for (const Json& cost : data["costs"]) headings[cost["name"].get<std::string>()] = cost["heading"].get<std::string>();
  EXPECT_EQ(headings["motion"], "geometry moves: update + relight + resolve");
  EXPECT_EQ(headings["geometry"], "another scene: build + relight + resolve");
  EXPECT_EQ(data["rows"][0]["costs"]["motion"], (Json{6, 5.75, 6.25}));
  EXPECT_EQ(data["rows"][0]["stages"]["moving_relight"][0], 0.5);
  EXPECT_FALSE(data["rows"][1]["costs"].contains("motion"));
  EXPECT_FALSE(data["rows"][1]["stages"].contains("update"));
}

TEST(moving_rows, bars_are_of_the_stages_of_one_event) {
  const std::vector<Record> records{moving("a"), moving("b")};
  FigureOptions options;
  const auto script = [&] { return figure_script(records, "stages", options, "f.svg"); };
  EXPECT_TRUE(has(script(), "'build'"));
  EXPECT_FALSE(has(script(), "update"));
  options.bars = Cost::motion;
  const std::string color(figure_colors[static_cast<std::size_t>(Stage::resolve)]);
  for (const std::string& part :
       {std::string("'update'"), std::string("'moving relight'"), std::string("'moving resolve'"), color})
    EXPECT_TRUE(has(script(), part)) << part;
  EXPECT_FALSE(has(script(), "'build'"));
  options.bars = Cost::bytes;
  EXPECT_THROW(script(), Error);
  options.bars = Cost::motion;
  const std::vector<Record> standing{still("a"), still("b")};
  try {
    figure_script(standing, "stages", options, "f.svg");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "there is nothing to draw: no place has update, moving relight and moving resolve of every setting");
  }
}

}  // namespace moving_rows_test
