// Time of each stage, or a quantity, against an axis, both logarithmic, with the fitted lines and their exponents.
#include "report/figure/figure_axis.h"

namespace gnomon {

namespace {

/// The series to draw and what they differ in. Of times each stage has a panel, each setting a color, each place a mark; of a
/// quantity each place has a panel.
struct DrawnGrowths {
  std::vector<const Growth*> rows = {};
  std::vector<Place> places = {};
  std::vector<std::string> settings = {}, stages = {}, series = {};
  Extent x = {}, y = {};  ///< of the points that are fitted
  std::string axis = {};
  double scale = 1;  ///< of values as people see them
  bool is_time = true;

  bool has_places() const { return is_time && places.size() > 1; }  ///< in one panel
  std::size_t panel_count() const { return is_time ? stages.size() : places.size(); }
  std::size_t panel_of(const Growth& growth) const {
    return is_time ? index_of(stages, growth.stage) : index_of(places, growth.place);
  }
  std::string panel_title(std::size_t k) const { return is_time ? stages[k] : title(places[k], places); }
};

/// The exponent of a fitted line, written at the line's end.
struct ExponentLabel {
  double y;
  std::string text, color;
};

struct GrowthPanel {
  PlotCommand plot;
  std::vector<ExponentLabel> exponents;
};

bool is_drawn(const Growth& growth) { return growth.points.size() >= 2 && (growth.exponent || growth.left_out == 0); }

DrawnGrowths choose(const Growths& growths, const std::string& axis, double scale) {
  DrawnGrowths drawn{.axis = axis, .scale = scale, .is_time = growths.quantity.empty()};
  for (const Growth& growth : growths.rows) {
    if (growth.role == Role::baseline) continue;
    for (const Growth::Point& point : growth.points) require_not_negative(point.value.value, growths.quantity);
    if (!is_drawn(growth)) continue;
    drawn.rows.push_back(&growth);
    add_once(drawn.places, growth.place);
    add_once(drawn.settings, growth.setting);
    add_once(drawn.stages, growth.stage);
    for (const Growth::Point& point : growth.points) {
      if (!point.is_fitted()) continue;
      drawn.x.add(point.x);
      drawn.y.add(scale * point.value.low);
      drawn.y.add(scale * point.value.high);
    }
  }
  const auto rank = [](const std::string& stage) {  // total last
    const auto is_it = [&](TimedPart part) { return name(part) == stage; };
    return std::ranges::find_if(all_parts, is_it) - std::begin(all_parts);
  };
  std::ranges::sort(drawn.stages, {}, rank);
  return drawn;
}

/// What is called the same in every panel.
std::string series_name(const Growth& growth, const DrawnGrowths& drawn) {
  return growth.setting + (drawn.has_places() ? fmt::format(" ({})", title(growth.place, drawn.places)) : "");
}

/// Color shows the setting, mark the place where a panel holds several. Where there are too few of them every series has its
/// own.
SeriesStyle style_of(const Growth& growth, const DrawnGrowths& drawn) {
  const bool do_marks_suffice = drawn.settings.size() > 1 && drawn.settings.size() <= figure_colors.size() &&
                                drawn.places.size() <= most_marks && drawn.has_places();
  if (!do_marks_suffice) return series_style(index_of(drawn.series, series_name(growth, drawn)));
  return {figure_colors[index_of(drawn.settings, growth.setting)], series_mark(index_of(drawn.places, growth.place)), 1};
}

void add_legend(DrawnGrowths& drawn, FigureScript& script) {
  for (const Growth* growth : drawn.rows) add_once(drawn.series, series_name(*growth, drawn));
  require_series(drawn.series.size(), drawn.has_places() ? "settings and places" : "settings");
  for (const Growth* growth : drawn.rows) {
    const auto [color, mark, dashes] = style_of(*growth, drawn);
    const std::string text = series_name(*growth, drawn);
    if (std::ranges::find(script.legend, text, &FigureScript::LegendEntry::text) == script.legend.end())
      script.legend.push_back({fmt::format("with linespoints pt {} dt {} lc rgb '{}'", mark, dashes, color), text});
  }
}

/// Marks with their intervals, and the fitted line where there is one.
void add_series(const Growth& growth, const DrawnGrowths& drawn, FigureScript& script, GrowthPanel& panel) {
  const auto [color, mark, dashes] = style_of(growth, drawn);
  const std::string name = series_name(growth, drawn);
  std::vector<std::string> lines;
  for (const Growth::Point& point : growth.points)
    if (point.is_fitted())
      lines.push_back(fmt::format("{}\t{}\t{}\t{}", point.x, drawn.scale * point.value.value, drawn.scale * point.value.low,
                                  drawn.scale * point.value.high));
  panel.plot.add(name, "{} using 1:2:3:4 with yerrorbars pt {} ps 0.7 lc rgb '{}' notitle", script.data(lines), mark, color);
  if (!growth.exponent) return;
  // The line spans what it was fitted to.
  Extent xs;
  for (const Growth::Point& point : growth.points)
    if (point.is_fitted()) xs.add(point.x);
  const auto [from, to] = xs;
  const double exponent = growth.exponent->value;
  const auto at = [&](double x) { return drawn.scale * growth.coefficient * std::pow(x, exponent); };
  panel.plot.add(fmt::format("{}, {} to the power {:.2f}", name, drawn.axis, exponent),
                 "{} using 1:2 with lines lw 1.2 dt {} lc rgb '{}' notitle",
                 script.data({fmt::format("{}\t{}", from, at(from)), fmt::format("{}\t{}", to, at(to))}), dashes, color);
  // Never "-0.00".
  panel.exponents.push_back({at(to), fmt::format("{:.2f}", std::abs(exponent) < 0.005 ? 0.0 : exponent), std::string(color)});
}

/// Exponents are written at the height where their lines end, within the panel, pushed apart upward where they would cover one
/// another. More than a few would be far from their lines and are left out; the table has them all.
void label_exponents(std::vector<ExponentLabel> labels, double x, double bottom, double top, double height_cm,
                     FigureScript& script) {
  if (labels.size() > 8) return;
  std::sort(labels.begin(), labels.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  const double step = std::pow(top / bottom, 0.34 / height_cm);
  double highest = top / std::pow(step, static_cast<double>(labels.size()));  // leaves room for those above
  for (std::size_t k = 0; k < labels.size(); ++k, highest *= step) {
    labels[k].y = std::max(labels[k].y, k > 0 ? labels[k - 1].y * step : bottom * std::sqrt(step));
    script.add("set label {} at {},{} left offset 0.8,0 textcolor rgb '{}'", FigureScript::quoted(labels[k].text), x,
               std::min(labels[k].y, highest), labels[k].color);
  }
}

}  // namespace

void draw_growth(std::span<const Record> records, FigureScript& script) {
  const std::string& wanted = script.options.analysis.x;
  const std::string axis = wanted.empty() ? "triangles" : wanted;
  const std::string& quantity = script.options.analysis.growing;
  const Growths growths = find_growth(records, axis, quantity);
  const bool is_time = quantity.empty();
  const Column column = is_time ? Column{} : quantity_column(quantity);
  if (is_time)
    require_drawable_times(records);
  else
    require_drawable(records, column);
  DrawnGrowths drawn = choose(growths, axis, is_time ? 1 : column.shown_scale);
  if (drawn.rows.empty())
    throw Error("there is nothing to draw: no setting has {} at two values of {}", is_time ? "times" : quantity, axis);
  require_panels(drawn.panel_count(), "scenes, lights and views");
  std::vector<GrowthPanel> panels(drawn.panel_count());
  std::vector<double> xs;
  add_legend(drawn, script);
  for (const Growth* growth : drawn.rows) {
    add_series(*growth, drawn, script, panels[drawn.panel_of(*growth)]);
    for (const Growth::Point& point : growth->points)
      if (point.is_fitted()) xs.push_back(point.x);
  }

  const std::string y_label = is_time ? "time (ms)" : axis_label(column);
  script.shows = fmt::format("{} against {}", y_label, axis);
  PanelFrame frame{.titles = {}, .x_label = axis, .y_label = y_label, .most_columns = 3, .height_per_width = 1.1};
  for (std::size_t k = 0; k < panels.size(); ++k) frame.titles.push_back(drawn.panel_title(k));
  const PanelGrid grid = open_panels(script, frame);
  const double bottom = drawn.y.least / 1.6, top = drawn.y.greatest * 1.6;
  // The right margin holds the exponents.
  const double span = drawn.x.greatest / drawn.x.least, margin = 1.1 / grid.width_cm;
  const double left = drawn.x.least / std::pow(span, 0.06),
               right = drawn.x.greatest * std::pow(span, 1.06 * margin / (1 - margin));
  const std::size_t labels = grid.x_labels() * 2 / 3 + 1;
  const std::string at_values = value_tics(std::move(xs), 1 / static_cast<double>(labels));
  script.add("set logscale xy; set xtics {}; set ytics {}",
             at_values.empty() ? log_tics(left, drawn.x.greatest, labels) : at_values, log_tics(bottom, top, grid.y_labels()));
  script.add("set xrange [{}:{}]", left, right);
  script.add("set yrange [{}:{}]", bottom, top);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    open_panel(script, grid, k, drawn.panel_title(k), k % grid.columns > 0 ? "" : y_label);
    script.add("unset label");
    label_exponents(panels[k].exponents, drawn.x.greatest, bottom, top, grid.height_cm, script);
    panels[k].plot.into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
