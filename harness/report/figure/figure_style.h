#pragma once
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

namespace gnomon {

// Colors and marks of what figures draw. Every two of these colors, and white, are at least 20 apart in CIE Lab (1976), also to
// people without green or without red cones; figure_style_test.cpp computes it.

/// Of series, stages and causes.
inline constexpr std::array<std::string_view, 8> figure_colors{"#0072b2", "#d55e00", "#009e73", "#9a4679",
                                                               "#f0b400", "#56b5ea", "#5b4300", "#4c2c71"};
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
