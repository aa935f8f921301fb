#include "report/figure/figure_style.h"

#include <gnomon/error.h>
#include <gnomon/param.h>

namespace gnomon {

namespace {

/// Circle, square, triangles up and down, diamond, pentagon: gnuplot's numbers.
constexpr std::array filled_marks{7, 5, 9, 11, 13, 15}, open_marks{6, 4, 8, 10, 12, 14};

std::string variables_of(const std::array<std::string_view, 8>& colors) {
  std::string text = ":root{";
  for (std::size_t k = 0; k < colors.size(); ++k) text += fmt::format("--series-{}:{};", k, colors[k]);
  for (const Stage stage : all_stages)
    text += fmt::format("--stage-{}:{};", name(stage), colors[static_cast<std::size_t>(stage)]);
  return text + "}";
}

}  // namespace

std::string color_variables() {
  return fmt::format("{}\n@media screen and (prefers-color-scheme:dark){{{}}}\n", variables_of(figure_colors),
                     variables_of(dark_figure_colors));
}

void require_series(std::size_t count, std::string_view what) {
  if (count > most_series)
    throw Error("{} {} are more than the {} that one figure tells apart; --filter chooses among them", count, what,
                most_series);
}

SeriesStyle series_style(std::size_t index) {
  // The next round of colors has open marks, the one after it filled ones again, each color the next shape.
  const std::size_t color = index % figure_colors.size(), round = index / figure_colors.size();
  const auto& marks = round % 2 == 0 ? filled_marks : open_marks;
  return {figure_colors[color], marks[(color + round / 2) % marks.size()], static_cast<int>(round % 5) + 1};
}

int series_mark(std::size_t index) {
  const std::size_t shape = index % filled_marks.size();
  return index % most_marks < filled_marks.size() ? filled_marks[shape] : open_marks[shape];
}

int reference_mark(std::size_t index) {
  constexpr std::array crosses{2, 1, 3};  // oblique, upright, both
  return crosses[index % crosses.size()];
}

}  // namespace gnomon
