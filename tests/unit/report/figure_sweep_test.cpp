#include <gtest/gtest.h>

#include "figure_rows.h"

namespace figure_sweep_test {

using namespace gnomon;
using namespace figure_rows;

TEST(figure_sweep, the_left_margin_has_room_for_the_tics) {
  FigureOptions options{.width_cm = 8.5};
  options.analysis.x = "size";
  options.metrics = {"error", "false_dark_rate"};
  const auto margin_cm = [&](double wrong) {
    std::vector<Record> records;
    for (const int size : {256, 512, 1024}) {
      records.push_back(row(size, 1, wrong / size));
      records.back().metrics[Truth::shape]["false_dark_rate"] = wrong / size;
    }
    return 8.5 * number_after(figure_script(records, "sweep", options, "f.svg"), "set lmargin at screen ");
  };
  // 0.0001 has six characters, 10 two: 5.6 of them have a cm, and 0.7 cm are always free.
  EXPECT_NEAR(margin_cm(0.001) - margin_cm(100), 6 / 5.6 - 0.7, 0.01);
}

TEST(figure_sweep, a_sweep_holds_several_quantities) {
  std::vector<Record> records = some();
  FigureOptions options;
  options.analysis.x = "size";
  options.metrics = {"cause.acne", "error", "resolve_ms"};
  const std::string script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "# Panels: 2 rows of 1\n")) << "shares in one panel, times in another\n" << script;
  EXPECT_TRUE(has(script, "set ylabel 'acne, error (%)'")) << script;
  EXPECT_TRUE(has(script, "# Curve: map: acne\n")) << script;
  EXPECT_TRUE(has(script, "title 'map: error'")) << script;
}

TEST(figure_sweep, quantities_that_differ_tenfold_have_panels_one_above_the_other) {
  std::vector<Record> records;
  for (int k = 0; k < 5; ++k) {
    records.push_back(row(1 << k, 1, 0.5 / std::pow(10, k)));
    records.back().metrics[Truth::shape]["false_lit_rate"] = 0.0014 * k;
    records.back().metrics[Truth::shape]["false_dark_rate"] = 0.3 / std::pow(10, k);
  }
  FigureOptions options;
  options.analysis.x = "size";
  options.metrics = {"error", "false_dark_rate"};
  EXPECT_TRUE(has(figure_script(records, "sweep", options, "f.svg"), "# Panels: 1 row of 1\n")) << "50 and 30 % at most";
  options.metrics = {"error", "false_lit_rate"};
  std::string script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "# Panels: 2 rows of 1\n")) << "50 and 0.7 % at most\n" << script;
  EXPECT_TRUE(has(script, "set ylabel 'error (%)'")) << script;
  EXPECT_TRUE(has(script, "set ylabel 'false lit (%)'")) << script;
  // 50 % to 0.005 % are four decades.
  EXPECT_TRUE(has(script, "set logscale y; set ytics ('' 0.005 1, ")) << script;
  // Two places beside one another, of one quantity in each row.
  for (int k = 0; k < 5; ++k) {
    records.push_back(records[k]);
    records.back().scene = "box";
  }
  script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "# Panels: 2 rows of 2\n")) << script;
  // Zero has its place below the least.
  records[4].metrics[Truth::shape]["error"] = 0;
  script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "set ytics add ('0' 0.0125)")) << "a fourth of 0.05 %\n" << script;
}

TEST(figure_sweep, values_spaced_by_ratio_have_a_logarithmic_axis) {
  EXPECT_TRUE(are_spaced_by_ratio(std::vector<double>{0.5, 1, 2, 4, 8}));
  EXPECT_TRUE(are_spaced_by_ratio(std::vector<double>{1, 2, 5, 10}));
  EXPECT_FALSE(are_spaced_by_ratio(std::vector<double>{1, 2, 3, 4}));
  EXPECT_FALSE(are_spaced_by_ratio(std::vector<double>{1, 2, 4, 8, 10}));
  EXPECT_FALSE(are_spaced_by_ratio(std::vector<double>{1, 2}));
  std::vector<Record> records;
  for (const int size : {0, 1, 2, 4}) records.push_back(row(size, 1, 0.1));
  FigureOptions options;
  options.analysis.x = "size";
  EXPECT_TRUE(has(figure_script(records, "sweep", options, "f.svg"), "set logscale x; set xtics ('1' 1, '2' 2, '4' 4)"));
}

TEST(figure_sweep, a_logarithmic_parameter_has_a_logarithmic_axis_with_a_place_for_zero) {
  std::vector<Record> records;
  for (const char* size : {"0.1", "0.2", "0.4"}) records.push_back(row(256, 1, 0.1, fmt::format("soup:size={}", size)));
  FigureOptions options;
  options.analysis.x = "size";
  for (Record& r : records) r.parameters = Json::object();
  std::string script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "set logscale x; set xtics ('0.1' 0.1, '0.2' 0.2, '0.4' 0.4)")) << script;
  records.push_back(row(256, 1, 0.1, "soup:size=0"));
  records.back().parameters = Json::object();
  script = figure_script(records, "sweep", options, "f.svg");
  EXPECT_TRUE(has(script, "set xtics add ('0' 0.05)")) << "half of the least\n" << script;
  options.analysis.x = "height";
  for (Record& r : records) r.scene = fmt::format("sphere_over_plane:height={}", 1 + (&r - records.data()));
  EXPECT_FALSE(has(figure_script(records, "sweep", options, "f.svg"), "logscale x"));
}

}  // namespace figure_sweep_test
