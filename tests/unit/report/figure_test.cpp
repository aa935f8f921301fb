#include "report/figure/figure.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "figure_rows.h"
#include "measure/cause/causes.h"
#include "measure/picture/picture.h"
#include "measure/scratch_folder.h"

namespace figure_test {

using namespace gnomon;
using namespace figure_rows;

/// A sheet shows pictures, which have tests of their own.
std::vector<std::string> drawn_kinds() {
  std::vector<std::string> kinds = figure_kinds();
  std::erase(kinds, "sheet");
  return kinds;
}

TEST(figure, texts_cannot_leave_their_quotes) {
  EXPECT_EQ(FigureScript::quoted("it's"), "'it''s'");
  EXPECT_EQ(FigureScript::quoted("a\nsystem 'x'"), "'a system ''x'''");
  EXPECT_EQ(FigureScript::quoted("''x'"), R"("\047\047".'x''')");  // gnuplot 5.4 misreads quotes that begin a text
  EXPECT_EQ(FigureScript::quoted_tic("5 %"), "'5 %%'");
  FigureOptions options{.title = "a\nsystem 'x'\\"};
  options.analysis.x = "size";
  std::vector<Record> records = some();
  for (Record& r : records) r.technique = "map\nsystem 'y'\\";
  std::istringstream lines(figure_script(records, "sweep", options, "f.svg"));
  for (std::string line; std::getline(lines, line);) EXPECT_FALSE(line.starts_with("system")) << line;
}

TEST(figure, tics_of_a_logarithmic_axis_are_labeled_at_round_numbers) {
  // Three decades: 1, 2, 5 would be ten labels, 1 and 3 seven, powers of ten four; what has none is small.
  const std::string many = log_tics(0.9, 1100, 5);
  EXPECT_TRUE(has(many, "'1' 1,")) << many;
  EXPECT_TRUE(has(many, "'1000' 1000")) << many;
  EXPECT_TRUE(has(many, "'' 2 1")) << many;
  EXPECT_TRUE(has(log_tics(0.9, 1100, 8), "'300' 300")) << log_tics(0.9, 1100, 8);
  EXPECT_TRUE(has(log_tics(0.1, 3, 6), "'0.2' 0.2")) << log_tics(0.1, 3, 6);
  EXPECT_EQ(value_tics({1024, 256, 512, 256}, 0.2), "('256' 256, '512' 512, '1024' 1024)");
  EXPECT_EQ(value_tics({256, 260, 1024}, 0.2), "");  // they would cover one another
  EXPECT_EQ(short_number(250), "250");
  EXPECT_EQ(short_number(20000), "20k");
  EXPECT_EQ(short_number(1.5e6), "1.5M");
}

TEST(figure, every_kind_makes_a_program_for_every_file_type) {
  for (const std::string& kind : drawn_kinds())
    for (const char* out : {"f.svg", "f.pdf", "f.png"}) {
      FigureOptions options;
      if (kind == "growth" || kind == "sweep") options.analysis.x = "size";
      const std::string script = figure_script(some(), kind, options, out);
      EXPECT_TRUE(has(script, fmt::format("set output '{}'", out))) << kind;
      EXPECT_TRUE(has(script, "plot ")) << kind;
      EXPECT_TRUE(has(script, "EOD")) << kind;
      EXPECT_FALSE(has(script, "nan")) << kind << script;
      EXPECT_FALSE(has(script, "inf")) << kind << script;
    }
  EXPECT_THROW(figure_script(some(), "front", {}, "f.jpg"), Error);
  EXPECT_THROW(figure_script(some(), "fornt", {}, "f.svg"), Error);
}

TEST(figure, motion_has_a_panel_of_flicker_where_a_row_has_it) {
  std::vector<Record> records = some();
  const auto script = [&] { return figure_script(records, "motion", {}, "f.svg"); };
  EXPECT_FALSE(has(script(), "lag (s)"));
  EXPECT_TRUE(has(script(), "# Panels: 1 row of 1\n")) << script();
  records[1].metrics[Truth::shape]["flicker_1_60"] = 0.25;
  records[1].metrics[Truth::shape]["flicker_1_4"] = 0.5;
  EXPECT_TRUE(has(script(), "# Panels: 1 row of 2\n")) << script();
  EXPECT_TRUE(has(script(), "set xlabel 'lag (s)'")) << script();
  EXPECT_TRUE(has(script(), "'1/15' 0.0666")) << script();
  EXPECT_TRUE(has(script(), "0.25\t50\n")) << "in percent" << script();
}

TEST(figure, motion_of_many_settings_says_their_parameters_once) {
  std::vector<Record> records;
  for (int k = 0; k < 48; ++k) {
    records.push_back(row(k, 1, 0.1));
    records.back().settings =
        fmt::format("resolution={},bias=receiver_plane,filter=percentage_closer_{},depth_bias={}", k, k % 4, k % 3);
  }
  const std::string script = figure_script(records, "motion", {}, "f.pdf");
  EXPECT_TRUE(has(script, "set multiplot title 'map: bias=receiver_plane; resolution, filter, depth_bias'")) << script;
  EXPECT_TRUE(has(script, "title '7, percentage_closer_3, 1'")) << script;
  // Two columns of 24 rows in the place of 48 rows, 22 cm.
  EXPECT_LT(number_after(script, "cm,"), 25) << script;
  records.resize(8);
  EXPECT_TRUE(has(figure_script(records, "motion", {}, "f.pdf"), "title 'map:resolution=7,bias="))
      << "few have their whole names";
}

TEST(figure, nothing_to_draw_is_an_error) {
  Record failed = row(256, 1, 0.1);
  failed.status = Status::failed;
  for (const std::string& kind : figure_kinds())
    EXPECT_THROW(figure_script(std::vector{failed}, kind, {}, "f.svg"), Error) << kind;
}

TEST(figure, no_error_at_all_has_its_place_on_a_logarithmic_axis) {
  const std::string script = figure_script(some(), "front", {}, "f.svg");
  EXPECT_TRUE(has(script, "set ytics add ('0' 2.5)")) << script;  // a fourth of the least, 10 %
}

TEST(figure, exponents_stay_within_their_panel) {
  // log10 of the times 3, 0, 0, 0 at log2 of the sizes 8 .. 11: slope -0.9, and the line ends at -0.6, below all points.
  const std::vector<Record> records{row(256, 1000, 0), row(512, 1, 0), row(1024, 1, 0), row(2048, 1, 0)};
  FigureOptions options{.width_cm = 8.5};
  options.analysis.x = "size";
  const std::string script = figure_script(records, "growth", options, "f.svg");
  const double bottom = number_after(script, "set yrange ["), label = number_after(script, "set label '-2.99' at 2048,");
  EXPECT_GT(bottom, std::pow(10, -0.6)) << script;
  EXPECT_GT(label, bottom) << script;
}

TEST(figure, a_row_of_panels_has_room_for_its_own_turned_words) {
  std::vector<Record> records;
  for (int k = 0; k < 16; ++k) {
    records.push_back(row(1, 1, 0.1 + 0.01 * k));
    records.back().parameters = {{"a", k % 2}, {"b", k / 2 % 2}, {"c", k / 4 % 2}, {"d", k / 8 ? "bits" : "word"}};
    records.back().settings = records.back().parameters.dump();
  }
  const auto height = [&] { return number_after(figure_script(records, "parameters", {}, "f.pdf"), "cm,"); };
  const double plain = height();
  for (Record& r : records) r.parameters["d"] = r.parameters["d"].get<std::string>() + "_that_does_not_fit_below_its_panel";
  // Two rows of two panels: 38 characters at 5.6 per cm, turned by 45 degrees, below the second row alone.
  EXPECT_NEAR(height() - plain, 38 / 5.6 * 0.71, 0.02);
  EXPECT_TRUE(has(figure_script(records, "parameters", {}, "f.pdf"), "rotate by 45 right ('word_that"));
}

TEST(figure, a_legend_is_no_wider_than_its_figure) {
  // Five names of 23 characters, 4.1 cm, and the front: a column takes 5.7 cm, and 16 cm hold two.
  std::vector<Record> records = some();
  for (const int size : {2048, 4096}) records.push_back(row(size, size, 0.05));
  for (Record& r : records) r.label = fmt::format("a_name_of_characters_{:02}", &r - records.data());
  EXPECT_TRUE(has(figure_script(records, "front", {}, "f.svg"), "vertical maxrows 3 "))
      << figure_script(records, "front", {}, "f.svg");
}

TEST(figure, bars_have_as_many_tics_as_have_room) {
  std::vector<Record> records = some();
  const auto script = [&](double width_cm) { return figure_script(records, "causes", {.width_cm = width_cm}, "f.svg"); };
  EXPECT_TRUE(has(script(16), "set xrange [0:100]; set xtics 10")) << script(16);
  for (Record& r : records) r.technique = "a_technique_with_a_long_name_beside_its_bar";
  // 8.5 cm less 3.5 of the name and 2.2 of the error hold three numbers of three digits.
  EXPECT_TRUE(has(script(8.5), "set xrange [0:100]; set xtics 50")) << script(8.5);
}

/// The colors that curves and legend of a program have.
std::set<std::string> colors_in(const std::string& script) {
  std::set<std::string> colors;
  std::istringstream lines(script);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("plot ") || line.starts_with("  "))
      for (std::size_t at = 0; (at = line.find("rgb '#", at)) != line.npos; ++at) colors.insert(line.substr(at + 5, 7));
  return colors;
}

TEST(figure, curves_have_colors_of_the_palette_alone) {
  std::set<std::string> known{"#ffffff", std::string(ink_color), std::string(faint_color)};
  for (const std::string_view color : figure_colors) known.emplace(color);
  std::vector<Record> records;
  for (int k = 0; k < 40; ++k)
    for (const int size : {256, 512}) {
      records.push_back(row(size, 1 + k, 0.001 * k + 0.01));
      records.back().technique = fmt::format("technique_{}", k % 20);
      records.back().settings += fmt::format(",k={}", k);
      records.back().parameters["k"] = k;
      records.back().causes = std::map<std::string, std::uint64_t>();
      for (const CauseInfo& cause : cause_infos()) (*records.back().causes)[std::string(cause.name)] = 3 + k;
    }
  for (const std::string& kind : drawn_kinds()) {
    FigureOptions options;
    if (kind == "growth" || kind == "sweep") options.analysis.x = "size";
    std::vector<Record> drawn = records;
    if (kind == "stages" || kind == "causes") drawn.resize(60);
    if (kind == "map") drawn.resize(20);
    for (const std::string& color : colors_in(figure_script(drawn, kind, options, "f.svg")))
      EXPECT_TRUE(known.contains(color)) << kind << " " << color;
  }
}

TEST(figure, a_narrow_one_leaves_each_panel_its_room) {
  std::vector<Record> records = some();
  for (Record& r : some()) {
    r.scene = "another_scene_with_a_long_name";
    records.push_back(r);
  }
  for (Record& r : records) r.settings += ",filter=percentage_closer,bias=receiver_plane,depth_bias=0.25";
  FigureOptions options{.width_cm = 8.5};
  options.analysis.x = "size";
  const std::string script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "# Panels: 2 rows of 1\n")) << "two of 8.5 cm beside each other would have 2 cm each\n" << script;
  EXPECT_TRUE(has(script, "keyentry with points pt 0 lc rgb '#ffffff' title '")) << "names of settings go on below\n" << script;
  options.width_cm = 16;
  EXPECT_TRUE(has(figure_script(records, "sweep", options, "f.svg"), "# Panels: 1 row of 2\n"));
}

/// What a figure of these rows says against drawing them; empty: it draws them.
std::string refusal(const std::vector<Record>& records, const std::string& kind, FigureOptions options = {}) {
  try {
    if (options.analysis.x.empty()) options.analysis.x = kind == "parameters" ? "" : "size";
    figure_script(records, kind, options, "f.svg");
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(figure, what_it_cannot_draw_it_refuses_in_its_own_words) {
  for (const double value : {1e300, 1e308, std::numeric_limits<double>::infinity(), 1e-300, -0.5})
    for (const std::string kind : {"front", "sweep", "motion", "map", "parameters"}) {
      std::vector<Record> records = some();
      records[1].metrics[Truth::shape]["error"] = value;
      records[1].frames["error"][0] = value;
      // As the record has it, not in percent.
      EXPECT_TRUE(has(refusal(records, kind), fmt::format("cannot draw error = {}:", value)))
          << kind << ": " << refusal(records, kind);
    }
  std::vector<Record> records = some();
  records[1].times(Stage::resolve) = {{-1.0}, {-1.0}};
  for (const char* const kind : {"front", "growth", "stages"})
    EXPECT_TRUE(has(refusal(records, kind), "cannot draw resolve_ms = -1:")) << kind << ": " << refusal(records, kind);
}

TEST(figure, what_may_be_negative_is_drawn_where_its_axis_has_a_place) {
  std::vector<Record> records = some();
  for (Record& r : records) r.metrics[Truth::shape]["penumbra_shift"] = -0.5 * r.parameters["size"].get<int>();
  FigureOptions options;
  options.analysis.metric = options.analysis.growing = "penumbra_shift";
  for (const char* const kind : {"sweep", "parameters", "map"}) EXPECT_EQ(refusal(records, kind, options), "") << kind;
  EXPECT_TRUE(has(refusal(records, "growth", options), "cannot draw penumbra_shift = -128:"))
      << refusal(records, "growth", options);
  for (Record& r : records) r.metrics[Truth::shape]["ssim"] = -0.25;
  options.analysis.metric = "ssim";
  EXPECT_TRUE(has(refusal(records, "front", options), "cannot draw ssim = -0.25:")) << refusal(records, "front", options);
}

TEST(figure, gnuplot_draws_every_kind) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no gnuplot";
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_figure");
  for (const std::string& kind : drawn_kinds())
    for (const char* ending : {"svg", "pdf", "png"}) {
      FigureOptions options{.title = "it's \"quoted\" & <more>"};
      if (kind == "growth" || kind == "sweep") options.analysis.x = "size";
      const auto out = folder.path() / fmt::format("{}.{}", kind, ending);
      run_gnuplot(figure_script(some(), kind, options, out), out);
      EXPECT_GT(std::filesystem::file_size(out), 1000u) << out;
    }
  EXPECT_THROW(run_gnuplot("this is no program\n", folder.path() / "x.svg"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "x.svg"));
  // Nothing else stays beside the figures.
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, drawn_kinds().size() * 3);
}

TEST(figure, a_sheet_shows_the_error_picture_of_every_row_without_its_legend) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_sheet");
  std::vector<Record> records = some();
  EXPECT_THROW(figure_script(records, "sheet", {}, "f.svg"), Error) << "no row has a picture";
  for (Record& r : records) {
    r.width = 64;
    r.height = 36;
    r.error_picture = (folder.path() / fmt::format("it's {}.png", r.settings)).string();
    // 12 rows of a legend below the view.
    write_png(*r.error_picture, {64, 48, std::vector<std::uint8_t>(3 * 64 * 48, 200), 12});
  }
  const std::string script = figure_script(records, "sheet", {}, "f.svg");
  EXPECT_TRUE(has(script, "# Panels: 2 rows of 2\n")) << script;
  EXPECT_TRUE(has(script, "it''s size=512.png' binary filetype=png with rgbimage")) << script;
  EXPECT_TRUE(has(script, "set yrange [11.5:47.5]")) << script;
  EXPECT_TRUE(has(script, "set multiplot title 'map'")) << "what all share, once\n" << script;
  EXPECT_TRUE(has(script, "set title 'size=256, error\u00a020.0\u00a0%'")) << script;
  EXPECT_TRUE(has(script, "border lc rgb '#666666' title 'acne'")) << "a white color shows in its frame\n" << script;
  if (std::system("gnuplot --version > /dev/null 2>&1") == 0)
    for (const char* ending : {"svg", "pdf", "png"}) {
      const auto out = folder.path() / fmt::format("sheet.{}", ending);
      run_gnuplot(figure_script(records, "sheet", {}, out), out);
      EXPECT_GT(std::filesystem::file_size(out), 1000u) << out;
    }
  records[0].height = 100;
  EXPECT_THROW(figure_script(records, "sheet", {}, "f.svg"), Error) << "the file is another picture";
}

}  // namespace figure_test
