#pragma once
#include <cmath>

#include "analysis/in_order.h"
#include "report/figure/figure.h"

namespace gnomon {

/// The gnuplot program of one figure, written line by line. Terminal and style come first in its text, but last in time: the
/// terminal needs the height.
class FigureScript {
 public:
  explicit FigureScript(const FigureOptions& options) : options(options) {}

  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    body_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
  }
  /// A block of data, fields separated by tabs; returns its name, "$d3".
  std::string data(const std::vector<std::string>& lines);
  /// Text in single quotes, as gnuplot reads it.
  static std::string quoted(std::string_view text);
  /// The same for the name of a tic, which gnuplot reads as a format: a percent sign prints as itself.
  static std::string quoted_tic(std::string_view text);

  const FigureOptions& options;
  double height_cm = 9;
  /// Rows of a legend that the panels of a multiplot share, below them.
  struct LegendEntry {
    std::string style;  ///< "with points pt 7 lc rgb '#0072b2'"
    std::string text;
  };
  std::vector<LegendEntry> legend;
  double legend_cm() const;  ///< that the legend takes

  /// The whole program.
  std::string text(const std::filesystem::path& out) const;

 private:
  std::string body_;
  std::size_t blocks_ = 0;
};

/// The `plot` command of one panel, curve by curve. Blocks of data that it names are written before a multiplot opens.
class PlotCommand {
 public:
  /// One curve: "$d3 using 1:2 with lines notitle".
  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    curves_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
  bool is_empty() const { return curves_.empty(); }
  /// Draws them; without any an empty panel.
  void into(FigureScript& script) const;

 private:
  std::vector<std::string> curves_;
};

/// The least and the greatest of the values added.
struct Extent {
  double least = INFINITY, greatest = -INFINITY;
  void add(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};

/// Colors that people with any color vision tell apart (Okabe and Ito 2008), "#0072b2", then again from the start.
std::string series_color(std::size_t index);
/// Shape of a series' marks: filled ones that differ, another one each time that the colors start again.
int series_mark(std::size_t index);

/// Opens a multiplot of `panels` panels over the figure but for the legend's strip, each `panel_cm` high, and sets the height.
/// Returns the number of columns.
std::size_t open_panels(FigureScript& script, std::size_t panels, std::size_t most_columns, double panel_cm);
/// Titles the next panel and names its vertical axis; empty: it has no name.
void open_panel(FigureScript& script, std::string_view title, std::string_view y_label);
/// Draws the legend into its strip and ends the multiplot.
void close_panels(FigureScript& script);

/// More panels than this are no figure but an atlas.
inline constexpr std::size_t most_panels = 12;
/// Throws Error on more, saying how to choose.
void require_panels(std::size_t panels, std::string_view what);

/// "250", "10k", "1.5M".
std::string short_number(double value);
/// Tics of a logarithmic axis over this range with at most `most` labels, unless powers of ten alone are more; the rest are
/// small.
std::string log_tics(double least, double greatest, std::size_t most);
/// Tics at the values themselves; empty where two of them are nearer than this share of a logarithmic axis.
std::string value_tics(std::vector<double> values, double share);

/// "wrong (%)"; "umbra area ratio", which says its unit.
std::string axis_label(const Column& column);

// One function per kind.
void draw_front(std::span<const Record> records, FigureScript& script);
void draw_growth(std::span<const Record> records, FigureScript& script);
void draw_stages(std::span<const Record> records, FigureScript& script);
void draw_causes(std::span<const Record> records, FigureScript& script);
void draw_map(std::span<const Record> records, FigureScript& script);
void draw_motion(std::span<const Record> records, FigureScript& script);
void draw_sweep(std::span<const Record> records, FigureScript& script);
void draw_parameters(std::span<const Record> records, FigureScript& script);

}  // namespace gnomon
