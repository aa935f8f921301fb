#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace gnomon {

// Colors and marks of what figures draw. Every two of these colors, and white, are at least 20 apart in CIE Lab (1976), also to
// people without green or without red cones; figure_style_test.cpp computes it. The plots of the report have the same colors.

/// Of series, stages and causes.
inline constexpr std::array<std::string_view, 8> figure_colors{"#0072b2", "#d55e00", "#009e73", "#9a4679",
                                                               "#f0b400", "#56b5ea", "#5b4300", "#4c2c71"};
/// The same on the dark ground of a page, in the same order and as far apart, each with a contrast of at least 3 to the ground;
/// tests/report/page_test.js computes it.
inline constexpr std::array<std::string_view, 8> dark_figure_colors{"#52aeea", "#ff914c", "#3dc38f", "#a66aa6",
                                                                    "#f8de4a", "#aadaff", "#8d6900", "#8b6be2"};
/// Both as variables of a style sheet: --series-0 and on, and --stage-build and the like, which are those that figures have. A
/// page follows its reader's setting; paper is light.
std::string color_variables();
/// Of what series are read against: references, intervals, levels.
inline constexpr std::string_view ink_color = "#000000";
/// Of what lies behind series: fronts, clouds of points.
inline constexpr std::string_view faint_color = "#bbbbbb";

/// How one series looks. No two of a figure are alike: where colors start again, marks and dashes differ.
struct SeriesStyle {
  std::string_view color;
  int mark;    ///< gnuplot's number of a shape
  int dashes;  ///< gnuplot's number of a line's dashes
};

/// More series than these cannot be told apart.
inline constexpr std::size_t most_series = 96;
/// Throws Error on more, saying how to choose.
void require_series(std::size_t count, std::string_view what);

/// Of the series with this number, below `most_series`.
SeriesStyle series_style(std::size_t index);
/// Shape of a mark that goes with any color: another one for each number below `most_marks`.
inline constexpr std::size_t most_marks = 12;
int series_mark(std::size_t index);
/// Shapes of crosses, which no series has: of references.
inline constexpr std::size_t most_references = 3;
int reference_mark(std::size_t index);

}  // namespace gnomon
