// A quantity against a parameter as lines, one panel for each place.
#include <set>

#include "analysis/growth.h"
#include "analysis/sweep.h"
#include "report/figure/figure_axis.h"

namespace gnomon {

namespace {

bool is_cost(const Column& column) { return column.unit == "ms" || column.unit == "byte"; }

/// Whether the row is drawn. Errors of reference and baseline say nothing of the contenders, and the baseline's cost is none.
bool is_drawn(const Sweep& sweep, const Column& column) {
  if (sweep.role == Role::baseline || (sweep.role == Role::reference && !is_cost(column))) return false;
  return std::any_of(sweep.points.begin(), sweep.points.end(), [](const auto& point) { return point.value.has_value(); });
}

/// In the unit that people see. A time below the clock's resolution is drawn at it.
double shown_value(double value, const Column& column) {
  return (column.unit == "ms" ? std::max(value, clock_ms) : value) * column.shown_scale;
}

/// Where values of x lie: linear unless the parameter is one for a logarithmic axis, or they are spaced by ratios or span more
/// than two decades. A logarithmic axis has no zero: it lies left of the least value. Negative values make an axis linear.
class SweepAxis {
 public:
  SweepAxis(std::vector<double> values, bool is_log_parameter) : values_(std::move(values)) {
    std::ranges::sort(values_);
    for (const double value : values_) {
      all_.add(value);
      if (value > 0) positive_.add(value);
    }
    const bool is_wide = all_.least > 0 && all_.greatest / all_.least > 100;
    is_log_ =
        positive_.least < INFINITY && all_.least >= 0 && (is_log_parameter || is_wide || are_spaced_by_ratio(above_zero()));
    zero_ = positive_.least / std::max(2.0, std::pow(positive_.greatest / positive_.least, 0.15));
  }

  double at(double value) const { return is_log_ && value == 0 ? zero_ : value; }

  /// "set xrange ...", with marks and tics apart from the ends.
  std::string commands(const PanelGrid& grid) const {
    if (!is_log_) {
      const double span = all_.greatest - all_.least, margin = span > 0 ? span * 0.04 : 1;
      return fmt::format("set xtics {}; set xrange [{}:{}]", linear_step(all_.least, all_.greatest, grid.x_labels()),
                         all_.least - margin, all_.greatest + margin);
    }
    const double least = at(all_.least), greatest = all_.greatest;
    const double margin = greatest > least ? std::pow(greatest / least, 0.04) : 2;
    std::vector<double> positive = values_;
    std::erase(positive, 0);
    std::size_t longest = 1;
    for (const double value : positive) longest = std::max(longest, short_number(value).size());
    const std::string at_values = value_tics(std::move(positive), 0.99 / static_cast<double>(grid.x_labels(longest)));
    return fmt::format("set logscale x; set xtics {}; set xrange [{}:{}]{}",
                       at_values.empty() ? log_tics(positive_.least, greatest, grid.x_labels()) : at_values, least / margin,
                       greatest * margin, all_.least == 0 ? fmt::format("; set xtics add ('0' {})", zero_) : "");
  }

 private:
  std::span<const double> above_zero() const { return {std::ranges::upper_bound(values_, 0.0), values_.end()}; }

  std::vector<double> values_;  ///< rising
  Extent all_, positive_;
  bool is_log_ = false;
  double zero_ = 0;
};

/// Points of one line, with 0 at `zero`; where a value is missing, an empty line breaks it.
std::vector<std::string> line_of(const Sweep& sweep, const Column& column, const SweepAxis& axis, double zero) {
  const auto y = [&](double value) {
    const double shown = shown_value(value, column);
    return shown > 0 ? shown : shown + zero;
  };
  std::vector<std::string> lines;
  for (const Sweep::Point& point : sweep.points) {
    if (point.value)
      lines.push_back(
          fmt::format("{}\t{}\t{}\t{}", axis.at(point.x), y(point.value->value), y(point.value->low), y(point.value->high)));
    else if (!lines.empty() && !lines.back().empty())
      lines.emplace_back();
  }
  return lines;
}

/// A quantity of a sweep that is drawn.
struct DrawnSweep {
  const Sweep* sweep;
  const Column* column;
  std::size_t panel, series;
};

/// Quantities of one group in one place.
struct SweepPanel {
  Place place;
  std::size_t group;
  std::vector<const Column*> columns = {};
  PlotCommand plot = {};
  Extent y = {}, positive = {};  ///< of the values, and of those above 0
  /// Where 0 lies: among several quantities a share that spans more than a factor of 20 has a logarithmic axis.
  double zero = 0;

  /// "acne, peter panning (%)".
  std::string y_label() const {
    if (columns.size() == 1) return axis_label(*columns.front());
    std::vector<std::string> headings;
    for (const Column* column : columns) headings.push_back(column->heading);
    return fmt::format("{} ({})", joined(headings, ", "), columns.front()->shown_unit);
  }
};

/// A vertical axis.
struct YAxis {
  std::string commands;                 ///< "set yrange ..."
  std::vector<std::string> names = {};  ///< of its tics
};

YAxis linear_axis(double least, double greatest, std::size_t labels) {
  const double step = linear_step(least, greatest, labels);
  return {fmt::format("unset logscale y; set ytics {}; set yrange [{}:{}]", step, least, greatest),
          linear_names(least, greatest, step)};
}

/// The axis of what one panel shows. Shares, times and sizes are read against 0, but for costs of more than two
/// decades; ratios against 1.
YAxis y_axis(const SweepPanel& panel, std::size_t labels) {
  const Column& column = *panel.columns.front();
  Extent ys = panel.y;
  if (panel.zero > 0) {
    const auto [least, greatest] = panel.positive;
    const bool has_zero = ys.least <= 0;
    const std::string tics = log_tics(least, greatest * 1.3, labels);
    return {fmt::format("set logscale y; set ytics {}; set yrange [{}:{}]{}", tics, has_zero ? panel.zero / 1.5 : least / 1.3,
                        greatest * 1.3, has_zero ? fmt::format("; set ytics add ('0' {})", panel.zero) : ""),
            names_of_tics(tics)};
  }
  if (is_cost(column) && ys.least > 0 && ys.greatest / ys.least > 100) {
    const std::string tics = log_tics(ys.least / 1.3, ys.greatest * 1.3, labels);
    return {fmt::format("set logscale y; set ytics {}; set yrange [{}:{}]", tics, ys.least / 1.3, ys.greatest * 1.3),
            names_of_tics(tics)};
  }
  const bool has_zero = column.shown_unit == "%" || is_cost(column);
  if (has_zero && ys.least >= 0) return linear_axis(0, ys.greatest > 0 ? ys.greatest * 1.06 : 1, labels);
  if (column.unit == "ratio") {
    ys.add(0.95);
    ys.add(1.05);
  }
  const double span = ys.greatest - ys.least;
  const double margin = span > 0 ? span * 0.06 : std::max(std::abs(ys.greatest) * 0.05, 0.05);
  return linear_axis(ys.least - margin, ys.greatest + margin, labels);
}

/// What to draw: each place has a panel for each group, each setting and quantity a color and mark.
struct DrawnSweeps {
  std::vector<DrawnSweep> rows = {};
  std::vector<Place> places = {};
  std::vector<SweepPanel> panels = {};
  std::vector<std::string> series = {};
  std::vector<double> xs = {};

  void add(const Sweeps& sweeps, const Column& column, std::size_t group, bool is_only) {
    for (const Sweep& sweep : sweeps.rows) {
      if (!is_drawn(sweep, column)) continue;
      auto panel =
          std::ranges::find_if(panels, [&](const SweepPanel& one) { return one.place == sweep.place && one.group == group; });
      if (panel == panels.end()) panel = panels.insert(panel, SweepPanel{.place = sweep.place, .group = group});
      add_once(panel->columns, &column);
      add_once(places, sweep.place);
      const std::string name = is_only ? sweep.setting : fmt::format("{}: {}", sweep.setting, column.heading);
      add_once(series, name);
      rows.push_back({&sweep, &column, static_cast<std::size_t>(panel - panels.begin()), index_of(series, name)});
      for (const Sweep::Point& point : sweep.points) add_once(xs, point.x);
    }
  }

  /// Panels of a place beside one another, or of a group.
  void arrange(bool by_group) {
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < panels.size(); ++k) order.push_back(k);
    std::ranges::stable_sort(order, {}, [&](std::size_t k) {
      const std::size_t place = index_of(places, panels[k].place);
      return by_group ? std::pair(panels[k].group, place) : std::pair(place, panels[k].group);
    });
    std::vector<SweepPanel> arranged;
    for (const std::size_t k : order) arranged.push_back(std::move(panels[k]));
    panels = std::move(arranged);
    for (DrawnSweep& row : rows) row.panel = index_of(order, row.panel);
  }
};

/// For each quantity the number of its group, which one panel shows: those of one unit, unless one is more than ten times
/// another one, which would lie flat. Then each has a group of its own.
std::vector<std::size_t> groups_of(std::span<const Sweeps> all, std::span<const Column> columns) {
  constexpr double most = 10;
  std::vector<std::string> names;
  std::vector<std::size_t> groups;
  std::vector<double> greatest(columns.size(), 0);
  for (std::size_t k = 0; k < columns.size(); ++k)
    for (const Sweep& sweep : all[k].rows)
      for (const Sweep::Point& point : sweep.points)
        if (is_drawn(sweep, columns[k]) && point.value)
          greatest[k] = std::max(greatest[k], std::abs(shown_value(point.value->value, columns[k])));
  for (const Column& column : columns) {
    Extent sizes;
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns[k].shown_unit == column.shown_unit && greatest[k] > 0) sizes.add(greatest[k]);
    const std::string name = sizes.greatest > most * sizes.least ? column.name : " " + column.shown_unit;
    add_once(names, name);
    groups.push_back(index_of(names, name));
  }
  return groups;
}

/// Color, mark and dashes of a series, in every panel the same. Lines that coincide nest: the first is the widest, beneath.
std::string style_of(std::size_t series, std::size_t count) {
  const double beneath = count > 1 ? 1 - static_cast<double>(series) / static_cast<double>(count - 1) : 0;
  const auto [color, mark, dashes] = series_style(series);
  return fmt::format("pt {} ps {:.2f} lw {:.2f} dt {} lc rgb '{}'", mark, 0.55 + 0.65 * beneath, 1.1 + 2.4 * beneath, dashes,
                     color);
}

/// Finds what the vertical axes of panels span.
void find_extents(DrawnSweeps& drawn, bool has_several) {
  for (const DrawnSweep& row : drawn.rows)
    for (const Sweep::Point& point : row.sweep->points) {
      if (!point.value) continue;
      SweepPanel& panel = drawn.panels[row.panel];
      for (const double value : {point.value->low, point.value->value, point.value->high}) {
        const double shown = shown_value(value, *row.column);
        panel.y.add(shown);
        if (shown > 0) panel.positive.add(shown);
      }
    }
  for (SweepPanel& panel : drawn.panels) {
    const bool is_share = panel.columns.front()->shown_unit == "%";
    if (has_several && is_share && panel.y.least >= 0 && panel.positive.greatest > 20 * panel.positive.least)
      panel.zero = panel.positive.least / 4;
  }
}

void add_sweep(const DrawnSweep& row, DrawnSweeps& drawn, const SweepAxis& axis, FigureScript& script) {
  SweepPanel& panel = drawn.panels[row.panel];
  const bool has_interval =
      std::ranges::any_of(row.sweep->points, [](const auto& point) { return point.value && point.value->has_interval; });
  panel.plot.add(drawn.series[row.series], "{} using {} {} notitle",
                 script.data(line_of(*row.sweep, *row.column, axis, panel.zero)),
                 has_interval ? "1:2:3:4 with yerrorlines" : "1:2 with linespoints", style_of(row.series, drawn.series.size()));
}

/// Where quantities have panels of their own, those of one place lie one above the other: alone, or two places beside each
/// other. Of more places panels of a place lie beside each other.
PanelFrame arrange(DrawnSweeps& drawn, double width_cm) {
  PanelFrame frame;
  const std::size_t places = drawn.places.size();
  frame.titles.resize(drawn.panels.size());
  std::set<std::size_t> groups;
  for (const SweepPanel& panel : drawn.panels) groups.insert(panel.group);
  const bool are_all = drawn.panels.size() == groups.size() * places;
  const bool are_rows = groups.size() > 1 && are_all && places <= panel_grid(frame, width_cm).columns;
  if (groups.size() > 1) drawn.arrange(are_rows);
  if (are_rows) frame.most_columns = places;
  if (are_rows && places == 1) frame.height_per_width = 0.4;
  for (std::size_t k = 0; k < drawn.panels.size(); ++k)
    frame.titles[k] = are_rows && k >= places ? "" : title(drawn.panels[k].place, drawn.places);
  return frame;
}

}  // namespace

void draw_sweep(std::span<const Record> records, FigureScript& script) {
  const AnalysisOptions& wanted = script.options.analysis;
  const std::vector<std::string> quantities =
      script.options.metrics.empty() ? std::vector{wanted.metric} : script.options.metrics;
  std::vector<Sweeps> all;
  std::vector<Column> columns;
  for (const std::string& quantity : quantities) {
    all.push_back(find_sweeps(records, wanted.x, quantity));
    columns.push_back(quantity_column(quantity));
    require_drawable(records, columns.back());
  }
  DrawnSweeps drawn;
  const std::vector<std::size_t> groups = groups_of(all, columns);
  for (std::size_t k = 0; k < all.size(); ++k) drawn.add(all[k], columns[k], groups[k], all.size() == 1);
  const std::string& parameter = all.front().parameter;
  if (drawn.rows.empty())
    throw Error("there is nothing to draw: no contender of the sweep of {} has a {}", parameter, joined(quantities, ", "));
  require_panels(drawn.panels.size(),
                 all.size() == 1 ? "scenes, lights and views" : "scenes, lights, views and groups of quantities");
  require_series(drawn.series.size(), all.size() == 1 ? "settings" : "settings and quantities");

  const SweepAxis axis(drawn.xs, is_log_parameter(records, parameter));
  for (std::size_t k = 0; k < drawn.series.size(); ++k)
    script.legend.push_back({"with linespoints " + style_of(k, drawn.series.size()), drawn.series[k]});
  PanelFrame frame = arrange(drawn, script.options.width_cm);
  find_extents(drawn, all.size() > 1);
  for (const DrawnSweep& row : drawn.rows) add_sweep(row, drawn, axis, script);
  const std::string x_label = all.front().unit.empty() ? parameter : fmt::format("{} ({})", parameter, all.front().unit);
  frame.x_label = x_label;
  std::vector<std::string> labels;
  for (const SweepPanel& panel : drawn.panels) add_once(labels, panel.y_label());
  frame.y_label = std::ranges::max(labels, {}, [](const std::string& label) { return label.size(); });
  script.shows = fmt::format("{} against {}", joined(labels, ", "), x_label);
  // The left margin has room for the tics.
  const std::size_t y_labels = panel_grid(frame, script.options.width_cm).y_labels();
  std::vector<YAxis> y_axes;
  for (const SweepPanel& panel : drawn.panels) {
    y_axes.push_back(y_axis(panel, y_labels));
    for (const std::string& name : y_axes.back().names) frame.y_names.push_back(name);
  }
  const PanelGrid grid = open_panels(script, frame);
  script.add("{}", axis.commands(grid));
  for (std::size_t k = 0; k < drawn.panels.size(); ++k) {
    const SweepPanel& panel = drawn.panels[k];
    open_panel(script, grid, k, frame.titles[k], k % grid.columns == 0 || labels.size() > 1 ? panel.y_label() : "");
    script.add("{}", y_axes[k].commands);
    panel.plot.into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
