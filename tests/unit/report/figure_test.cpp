#include "report/figure/figure.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "measure/scratch_folder.h"
#include "report/figure/figure_script.h"

namespace figure_test {

using namespace gnomon;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Record row(int size, double cost, double wrong, const std::string& scene = "soup") {
  Record r;
  r.scene = scene;
  r.light = "point";
  r.technique = "map";
  r.settings = fmt::format("size={}", size);
  r.parameters = {{"size", size}};
  r.status = Status::ok;
  for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve})
    r.times(stage) = {{cost}, {cost * 1.5}, {cost / 1.5}};
  r.metrics[Truth::shape] = {{"error", wrong}, {"wrong_rate", wrong}};
  r.classes["T"] = 100;
  r.causes = {{"acne", 3}, {"edge_resolution", 1}};
  r.path = "slide";
  r.frames = {{"error", {wrong, wrong / 2, std::nullopt}}};
  return r;
}

std::vector<Record> some() { return {row(256, 1, 0.2), row(512, 2, 0.1), row(1024, 4, 0)}; }

TEST(figure, texts_cannot_leave_their_quotes) {
  EXPECT_EQ(FigureScript::quoted("it's"), "'it''s'");
  EXPECT_EQ(FigureScript::quoted("a\nsystem 'x'"), "'a system ''x'''");
  EXPECT_EQ(FigureScript::quoted("''x'"), R"("\047\047".'x''')");  // gnuplot 5.4 misreads quotes that begin a text
  EXPECT_EQ(FigureScript::quoted_tic("5 %"), "'5 %%'");
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
  for (const std::string& kind : figure_kinds())
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
  EXPECT_TRUE(has(script(), "layout 1,1")) << script();
  records[1].metrics[Truth::shape]["flicker_1_60"] = 0.25;
  records[1].metrics[Truth::shape]["flicker_1_4"] = 0.5;
  EXPECT_TRUE(has(script(), "layout 1,2")) << script();
  EXPECT_TRUE(has(script(), "set xlabel 'lag (s)'")) << script();
  EXPECT_TRUE(has(script(), "'1/15' 0.0666")) << script();
  EXPECT_TRUE(has(script(), "0.25\t50\n")) << "in percent" << script();
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

TEST(figure, gnuplot_draws_every_kind) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "there is no gnuplot";
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_figure");
  for (const std::string& kind : figure_kinds())
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
  EXPECT_EQ(files, figure_kinds().size() * 3);
}

}  // namespace figure_test
