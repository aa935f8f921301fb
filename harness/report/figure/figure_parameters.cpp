// What each parameter of a technique did to a quantity: all settings as points, the best one of each value joined by lines.
#include "report/figure/figure_axis.h"

namespace gnomon {

namespace {

/// A setting over the places that all drawn settings have.
struct DrawnSetting {
  const Record* first;  ///< for its parameters
  double value = 0;     ///< the mean over the places, in the unit that people see
};

std::string value_text(const Record& record, const std::string& parameter) {
  const auto found = record.parameters.find(parameter);
  return found == record.parameters.end() || found->is_null() ? "" : plain_text(*found);
}

/// The settings of one technique that were measured at as many places as any.
std::vector<DrawnSetting> drawn_settings(std::span<const Record> records, const std::string& technique, const Column& column) {
  const std::string& wanted = column.name;
  const RowsBySetting all = rows_by_setting(records, [&](const Record& r) {
    return r.technique == technique && r.role == Role::contender && quantity(r, wanted).has_value();
  });
  std::size_t most = 0;
  for (const auto& [setting, rows] : all) most = std::max(most, rows.size());
  std::vector<DrawnSetting> drawn;
  for (const auto& [setting, rows] : all) {
    if (rows.size() < most) continue;
    DrawnSetting one{rows.begin()->second};
    for (const auto& [place, row] : rows)
      one.value += *quantity(*row, wanted) * column.shown_scale / static_cast<double>(rows.size());
    drawn.push_back(one);
  }
  return drawn;
}

/// The values of a parameter: numbers rising, words in the order of the records.
std::vector<std::string> values_of(const std::vector<DrawnSetting>& settings, const std::string& parameter) {
  std::vector<std::string> values;
  for (const DrawnSetting& setting : settings)
    if (const std::string text = value_text(*setting.first, parameter); !text.empty()) add_once(values, text);
  if (std::ranges::all_of(values, [](const std::string& text) { return number_from(text).has_value(); }))
    std::ranges::sort(values, {}, [](const std::string& text) { return *number_from(text); });
  return values;
}

constexpr std::string_view best_setting = "best setting with this value", every_setting = "every setting";
std::string best_style() {
  const SeriesStyle style = series_style(0);
  return fmt::format("with linespoints pt {} ps 0.8 lw 1.4 lc rgb '{}'", style.mark, style.color);
}
std::string cloud_style() { return fmt::format("with points pt 6 ps 0.35 lc rgb '{}'", faint_color); }

/// One parameter of one technique.
struct ParameterPanel {
  std::string title;
  std::vector<std::string> values;
  PlotCommand plot;
  Extent best;  ///< of the best settings of its values
};

ParameterPanel panel_of(const std::vector<DrawnSetting>& settings, const std::string& title, const std::string& parameter,
                        const std::string& direction, FigureScript& script) {
  ParameterPanel panel{title, values_of(settings, parameter), {}, {}};
  std::vector<std::string> points, line;
  for (std::size_t at = 0; at < panel.values.size(); ++at) {
    std::optional<double> best;
    for (const DrawnSetting& setting : settings) {
      if (value_text(*setting.first, parameter) != panel.values[at]) continue;
      points.push_back(fmt::format("{}\t{}", at, setting.value));
      if (!best || is_better(direction, setting.value, *best)) best = setting.value;
    }
    panel.best.add(*best);
    line.push_back(fmt::format("{}\t{}", at, *best));
  }
  panel.plot.add(every_setting, "{} using 1:2 {} notitle", script.data(points), cloud_style());
  panel.plot.add(best_setting, "{} using 1:2 {} notitle", script.data(line), best_style());
  return panel;
}

}  // namespace

void draw_parameters(std::span<const Record> records, FigureScript& script) {
  const std::string& wanted = script.options.analysis.metric;
  require_quantity(records, wanted);
  const Column column = quantity_column(wanted);
  require_drawable(records, column);
  std::vector<std::string> techniques;
  for (const Record& r : records) add_once(techniques, r.technique);
  std::vector<ParameterPanel> panels;
  Extent ys;
  for (const std::string& technique : techniques) {
    const std::vector<DrawnSetting> settings = drawn_settings(records, technique, column);
    if (settings.empty()) continue;
    for (const auto& [parameter, ignored] : settings.front().first->parameters.items()) {
      if (values_of(settings, parameter).size() < 2) continue;
      panels.push_back(panel_of(settings, techniques.size() > 1 ? technique + ": " + parameter : parameter, parameter,
                                std::string(better(wanted)), script));
      for (const DrawnSetting& setting : settings) ys.add(setting.value);
    }
  }
  if (panels.empty())
    throw Error(
        "there is nothing to draw: no parameter has two values among the settings that were measured at every place; {}",
        how_to_sweep("PARAMETER"));
  const auto did = [](const ParameterPanel& panel) { return panel.best.greatest - panel.best.least; };
  while (panels.size() > most_panels) panels.erase(std::ranges::min_element(panels, {}, did));
  script.legend.push_back({best_style(), std::string(best_setting)});
  script.legend.push_back({cloud_style(), std::string(every_setting)});
  script.shows = fmt::format("{} against each parameter", axis_label(column));
  PanelFrame frame{.titles = {}, .y_label = axis_label(column), .most_columns = 3, .height_per_width = 0.7};
  for (const ParameterPanel& panel : panels) {
    frame.titles.push_back(panel.title);
    frame.x_names.push_back(panel.values);
  }
  const PanelGrid grid = open_panels(script, frame);
  if (ys.least > 0 && ys.greatest / ys.least > 20)
    script.add("set logscale y; set ytics {}; set yrange [{}:{}]", log_tics(ys.least / 1.3, ys.greatest * 1.3, grid.y_labels()),
               ys.least / 1.3, ys.greatest * 1.3);
  else
    script.add("set yrange [{}:{}]", std::min(0.0, ys.least * 1.06), ys.greatest > 0 ? ys.greatest * 1.06 : 1);
  for (std::size_t k = 0; k < panels.size(); ++k) {
    open_panel(script, grid, k, panels[k].title, k % grid.columns == 0 ? axis_label(column) : "");
    script.add("set xtics {}; set xrange [-0.4:{}]", word_tics(panels[k].values, grid.is_turned(k)),
               static_cast<double>(panels[k].values.size()) - 0.6);
    panels[k].plot.into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
