// A quantity against a parameter as lines, one panel for each place.
#include "analysis/growth.h"
#include "analysis/sweep.h"
#include "report/figure/figure_script.h"

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

/// Points of one line; where a value is missing, an empty line breaks it.
std::vector<std::string> line_of(const Sweep& sweep, const Column& column) {
  std::vector<std::string> lines;
  for (const Sweep::Point& point : sweep.points) {
    if (point.value)
      lines.push_back(fmt::format("{}\t{}\t{}\t{}", point.x, shown_value(point.value->value, column),
                                  shown_value(point.value->low, column), shown_value(point.value->high, column)));
    else if (!lines.empty() && !lines.back().empty())
      lines.emplace_back();
  }
  return lines;
}

/// "set xrange ..." for these x, with marks and tics apart from the ends: linear unless they span more than two decades.
std::string x_axis(const Extent& xs, std::vector<double> values, std::size_t columns) {
  if (xs.least > 0 && xs.greatest / xs.least > 100) {
    const double margin = std::pow(xs.greatest / xs.least, 0.04);
    const std::string at_values = value_tics(std::move(values), columns > 1 ? 0.12 : 0.06);
    return fmt::format("set logscale x; set xtics {}; set xrange [{}:{}]",
                       at_values.empty() ? log_tics(xs.least, xs.greatest, columns > 1 ? 5 : 8) : at_values, xs.least / margin,
                       xs.greatest * margin);
  }
  const double margin = (xs.greatest - xs.least) * 0.04;
  return fmt::format("set xrange [{}:{}]", xs.least - margin, xs.greatest + margin);
}

/// "set yrange ..." for what one panel shows. Shares, times and sizes are read against 0, but for costs of more than two
/// decades; ratios against 1.
std::string y_axis(Extent ys, const Column& column) {
  if (is_cost(column) && ys.least > 0 && ys.greatest / ys.least > 100)
    return fmt::format("set logscale y; set ytics {}; set yrange [{}:{}]", log_tics(ys.least / 1.3, ys.greatest * 1.3, 8),
                       ys.least / 1.3, ys.greatest * 1.3);
  const bool has_zero = column.shown_unit == "%" || is_cost(column);
  if (has_zero && ys.least >= 0)
    return fmt::format("unset logscale y; set ytics autofreq; set yrange [0:{}]", ys.greatest > 0 ? ys.greatest * 1.06 : 1);
  if (column.unit == "ratio") {
    ys.add(0.95);
    ys.add(1.05);
  }
  const double span = ys.greatest - ys.least;
  const double margin = span > 0 ? span * 0.06 : std::max(std::abs(ys.greatest) * 0.05, 0.05);
  return fmt::format("unset logscale y; set ytics autofreq; set yrange [{}:{}]", ys.least - margin, ys.greatest + margin);
}

/// The sweeps to draw and what they differ in: each place has a panel, each setting a color and mark.
struct DrawnSweeps {
  std::vector<const Sweep*> rows;
  std::vector<Place> places;
  std::vector<std::string> settings;
  std::vector<double> xs;
  Extent x;
};

DrawnSweeps choose(const Sweeps& sweeps, const Column& column) {
  DrawnSweeps drawn;
  for (const Sweep& sweep : sweeps.rows) {
    if (!is_drawn(sweep, column)) continue;
    drawn.rows.push_back(&sweep);
    add_once(drawn.places, sweep.place);
    add_once(drawn.settings, sweep.setting);
    for (const Sweep::Point& point : sweep.points) {
      drawn.x.add(point.x);
      drawn.xs.push_back(point.x);
    }
  }
  return drawn;
}

/// Color and mark of a setting, in every panel the same. Lines that coincide nest: the first is the widest, beneath.
std::string style_of(std::size_t setting, std::size_t count) {
  const double beneath = count > 1 ? 1 - static_cast<double>(setting) / static_cast<double>(count - 1) : 0;
  return fmt::format("pt {} ps {:.2f} lw {:.2f} lc rgb '{}'", series_mark(setting), 0.55 + 0.65 * beneath, 1.1 + 2.4 * beneath,
                     series_color(setting));
}

/// One place.
struct SweepPanel {
  PlotCommand plot;
  Extent y;
};

void add_sweep(const Sweep& sweep, const Column& column, const std::string& style, FigureScript& script, SweepPanel& panel) {
  bool has_interval = false;
  for (const Sweep::Point& point : sweep.points) {
    if (!point.value) continue;
    has_interval = has_interval || point.value->has_interval;
    panel.y.add(shown_value(point.value->low, column));
    panel.y.add(shown_value(point.value->high, column));
  }
  panel.plot.add("{} using {} {} notitle", script.data(line_of(sweep, column)),
                 has_interval ? "1:2:3:4 with yerrorlines" : "1:2 with linespoints", style);
}

}  // namespace

void draw_sweep(std::span<const Record> records, FigureScript& script) {
  const std::string& quantity = script.options.analysis.metric;
  const Sweeps sweeps = find_sweeps(records, script.options.analysis.x, quantity);
  const Column column = quantity_column(quantity);
  const DrawnSweeps drawn = choose(sweeps, column);
  const auto& [rows, places, settings, xs, x] = drawn;
  if (rows.empty())
    throw Error("there is nothing to draw: no contender of the sweep of {} has a {}", sweeps.parameter, quantity);
  require_panels(places.size(), "scenes, lights and views");

  for (std::size_t k = 0; k < settings.size(); ++k)
    script.legend.push_back({"with linespoints " + style_of(k, settings.size()), settings[k]});
  std::vector<SweepPanel> panels(places.size());
  for (const Sweep* sweep : rows)
    add_sweep(*sweep, column, style_of(index_of(settings, sweep->setting), settings.size()), script,
              panels[index_of(places, sweep->place)]);
  const std::size_t columns =
      open_panels(script, panels.size(), 2, script.options.width_cm * (panels.size() == 1 ? 0.5 : 0.36));
  script.add("{}", x_axis(x, xs, columns));
  script.add(
      "set xlabel {} offset 0,0.4",
      FigureScript::quoted(sweeps.unit.empty() ? sweeps.parameter : fmt::format("{} ({})", sweeps.parameter, sweeps.unit)));
  for (std::size_t k = 0; k < panels.size(); ++k) {
    open_panel(script, title(places[k], places), k % columns == 0 ? axis_label(column) : "");
    script.add("{}", y_axis(panels[k].y, column));
    panels[k].plot.into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
