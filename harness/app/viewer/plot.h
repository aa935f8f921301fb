#pragma once
#include <span>
#include <string>
#include <vector>

namespace gnomon::viewer {

/// An axis of a plot: what it measures, and from where to where.
struct PlotAxis {
  std::string title;
  double low = 0, high = 1;
  bool is_log = false;
};
struct PlotTick {
  double value;
  std::string words;
};
/// Multiples of 1, 2 or 5 times a power of ten within the axis, about `count` of them; of a logarithmic one the powers of ten,
/// where there are two at least, else 1, 2 and 5 times them.
std::vector<PlotTick> plot_ticks(const PlotAxis& axis, int count);

/// A curve that ends where a value is no number, and begins again; with a band to both sides where `half_band` has values.
struct PlotCurve {
  std::string name;
  unsigned color = 0;
  std::span<const double> x, y, half_band = {};
  bool has_points = false, is_thin = false;
};
/// Draws the plot with ticks, titles and, above it, the curves' names into the room that is left.
void draw_plot(const PlotAxis& x, const PlotAxis& y, std::span<const PlotCurve> curves);

}  // namespace gnomon::viewer
