#pragma once
#include <cmath>

#include "analysis/in_order.h"
#include "report/figure/figure.h"
#include "report/figure/figure_style.h"

namespace gnomon {

/// From a line of text to the next one.
inline constexpr double line_cm = 0.4;
/// Of the text.
inline constexpr double characters_per_cm = 5.6;

/// The gnuplot program of one figure, written line by line. Terminal and style come first in its text, but last in time: the
/// terminal needs the height.
class FigureScript {
 public:
  explicit FigureScript(const FigureOptions& options) : options(options) {}

  template <class... Args>
  void add(fmt::format_string<Args...> format, Args&&... args) {
    body_ += fmt::format(format, std::forward<Args>(args)...) + '\n';
  }
  /// A block of data, fields separated by tabs; returns its name, "$d3". Throws Error on a number that gnuplot cannot draw.
  std::string data(const std::vector<std::string>& lines);
  /// Text in single quotes, as gnuplot reads it.
  static std::string quoted(std::string_view text);
  /// The same for the name of a tic, which gnuplot reads as a format: a percent sign prints as itself.
  static std::string quoted_tic(std::string_view text);
  /// Text that is wrapped where it is longer than so many centimeters.
  static std::string quoted_lines(std::string_view text, double cm);
  static std::string quoted_tic_lines(std::string_view text, double cm);
  static std::vector<std::string> lines_of(std::string_view text, double cm);  ///< wrapped likewise
  static std::size_t line_count(std::string_view text, double cm);             ///< that these have
  static double text_cm(std::string_view text);                                ///< of one line

  const FigureOptions& options;
  double height_cm = 9;  ///< of the whole figure
  std::string shows;     ///< the title of an SVG: "error against relight + resolve"
  /// Rows of a legend that the panels of a multiplot share, below them.
  struct LegendEntry {
    std::string style;  ///< "with points pt 7 lc rgb '#0072b2'"
    std::string text;
  };
  std::vector<LegendEntry> legend;
  std::string heading;             ///< of all panels, below the title
  double legend_cm() const;        ///< that the legend takes
  double title_cm() const;         ///< that title and heading take
  std::string title_text() const;  ///< of `set multiplot`
  /// The next curve that is drawn is called so in an SVG.
  void name_curve(std::string_view name);

  /// The whole program. Its comments "# Shows: " and "# Curve: " are the titles of an SVG, in their order.
  std::string text(const std::filesystem::path& out) const;

 private:
  std::string body_, names_;
  std::size_t blocks_ = 0;
};

/// The `plot` command of one panel, curve by curve. Blocks of data that it names are written before a multiplot opens.
class PlotCommand {
 public:
  /// One curve of this name: "$d3 using 1:2 with lines notitle".
  template <class... Args>
  void add(std::string_view name, fmt::format_string<Args...> format, Args&&... args) {
    names_.emplace_back(name);
    curves_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }
  bool is_empty() const { return curves_.empty(); }
  /// Draws them; without any an empty panel.
  void into(FigureScript& script) const;

 private:
  std::vector<std::string> names_, curves_;
};

/// The least and the greatest of the values added.
struct Extent {
  double least = INFINITY, greatest = -INFINITY;
  void add(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
};

/// What panels have around them; of labels the longest ones.
struct PanelFrame {
  std::vector<std::string> titles;  ///< one a panel
  std::string x_label = {}, y_label = {};
  std::vector<std::vector<std::string>> x_names = {};  ///< of tics that are words: one set a panel, or one of all panels
  std::vector<std::string> y_names = {};               ///< of tics that may be long
  std::size_t most_columns = 2;
  double height_per_width = 0.7;
  double height_cm = 0;  ///< of a panel; 0: by its width
  bool is_bare = false;  ///< no axes: titles alone
};
/// What panels have within.
struct PanelGrid {
  std::size_t columns = 1;
  double width_cm = 0, height_cm = 0, between_cm = 0;
  std::vector<bool> do_names_turn = {};  ///< the words of each set at x tics do not fit beside one another
  std::vector<double> bottoms_cm = {};   ///< of each row's axes; open_panels sets it
  /// Whether the words at x tics of the panel with this number turn.
  bool is_turned(std::size_t panel) const { return !do_names_turn.empty() && do_names_turn[panel % do_names_turn.size()]; }
  /// Numbers of this many characters fit below a panel.
  std::size_t x_labels(std::size_t characters = 5) const;
  std::size_t y_labels() const;
};
/// As many columns as leave each panel its room on a figure of this width.
PanelGrid panel_grid(const PanelFrame& frame, double figure_cm);
/// Opens a multiplot over the figure but for the legend's strip, and sets the height and the name of the
/// horizontal axes. Each row of panels has the margins that its own titles and tics need.
PanelGrid open_panels(FigureScript& script, const PanelFrame& frame);
/// Places the panel with this number, titles it and names its vertical axis; empty: it has no name.
void open_panel(FigureScript& script, const PanelGrid& grid, std::size_t k, std::string_view title, std::string_view y_label);
/// Draws the legend into its strip and ends the multiplot.
void close_panels(FigureScript& script);

/// More panels than this are no figure but an atlas.
inline constexpr std::size_t most_panels = 12;
/// Throws Error on more, saying how to choose.
void require_panels(std::size_t panels, std::string_view what);

/// A value in the unit that people see. Throws Error, which names it as the record has it, on one that gnuplot cannot draw, and
/// below 0 on one of an error, a share, a time or a size.
double shown_number(double value, const Column& column);
/// Throws the same where a finished row has such a value; the baseline, which is not drawn, may.
void require_drawable(std::span<const Record> records, const Column& column);
/// The same for the times of stages.
void require_drawable_times(std::span<const Record> records);
/// Throws Error, which names the value as the record has it, where it is below 0 and the axis has no place for it.
void require_not_negative(double value, std::string_view name);

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
void draw_sheet(std::span<const Record> records, FigureScript& script);

}  // namespace gnomon
