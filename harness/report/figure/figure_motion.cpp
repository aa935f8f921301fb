// A metric at every frame of a path, one panel for each scene, light and path; where the camera stands still a second panel has
// the flicker by its lag.
#include "measure/score/over_time.h"
#include "report/figure/figure_axis.h"
#include "report/figure/figure_names.h"

namespace gnomon {

namespace {

struct Panel {
  std::string title;
  PlotCommand plot = {};
  double least = 0;  ///< of its values, if it is below 0
};

/// The rows of a figure, and what their curves look like.
struct Motions {
  std::vector<PathErrors> rows;  ///< of contenders
  std::vector<Place> places;
  std::vector<std::string> settings;

  std::string style(std::size_t setting) const {
    const auto [color, mark, dashes] = series_style(setting);
    return fmt::format("with linespoints pt {} ps 0.5 lw 1.3 dt {} lc rgb '{}'", mark, dashes, color);
  }
  std::string style(const PathErrors& row) const { return style(index_of(settings, setting_name(*row.record))); }
  std::size_t place(const PathErrors& row) const { return index_of(places, place_of(*row.record)); }
};

Motions motions_of(std::span<const Record> records, const std::string& metric) {
  Motions motions;
  for (PathErrors& motion : find_motion(records, metric)) {
    if (motion.record->role != Role::contender) continue;
    add_once(motions.places, place_of(*motion.record));
    add_once(motions.settings, setting_name(*motion.record));
    motions.rows.push_back(std::move(motion));
  }
  return motions;
}

std::vector<Panel> panels_of(const Motions& motions) {
  std::vector<Panel> panels;
  for (const Place& place : motions.places) panels.push_back({title(place, motions.places)});
  return panels;
}

/// The metric by frame, one panel for each place.
std::vector<Panel> frame_panels(const Motions& motions, const Column& column, FigureScript& script) {
  std::vector<Panel> panels = panels_of(motions);
  for (const PathErrors& motion : motions.rows) {
    const auto found = motion.record->frames.find(column.name);
    if (found == motion.record->frames.end()) continue;
    std::vector<std::string> lines;
    Panel& panel = panels[motions.place(motion)];
    for (std::size_t frame = 0; frame < found->second.size(); ++frame)
      if (const auto& value = found->second[frame]) {
        lines.push_back(fmt::format("{}\t{}", frame, shown_number(*value, column)));
        panel.least = std::min(panel.least, *value);
      }
    if (lines.empty()) continue;
    panel.plot.add(setting_name(*motion.record), "{} using 1:2 {} notitle", script.data(lines), motions.style(motion));
  }
  return panels;
}

/// Flicker by lag, one panel for each place where a row has it.
std::vector<Panel> flicker_panels(const Motions& motions, const Column& column, FigureScript& script) {
  std::vector<Panel> panels = panels_of(motions);
  for (const PathErrors& motion : motions.rows) {
    std::vector<std::string> lines;
    for (const FlickerMetric& flicker : flicker_metrics)
      if (const std::optional<double> value = motion.record->metric(flicker.name))
        lines.push_back(fmt::format("{}\t{}", flicker.sixtieths / 60.0, shown_number(*value, column)));
    if (lines.empty()) continue;
    panels[motions.place(motion)].plot.add(setting_name(*motion.record), "{} using 1:2 {} notitle", script.data(lines),
                                           motions.style(motion));
  }
  std::erase_if(panels, [](const Panel& panel) { return panel.plot.is_empty(); });
  return panels;
}

/// The legend. Of many settings it has values alone, several beside one another, and their parameters are above the panels.
void name_settings(const Motions& motions, FigureScript& script) {
  constexpr std::size_t most_full_names = 8;
  ShortNames names{"", motions.settings};
  if (motions.settings.size() > most_full_names) names = values_alone(motions.settings);
  script.heading = names.heading;
  for (std::size_t k = 0; k < names.names.size(); ++k) script.legend.push_back({motions.style(k), names.names[k]});
}

std::string flicker_tics() {
  std::vector<std::string> tics;
  for (const FlickerMetric& flicker : flicker_metrics)
    tics.push_back(fmt::format("'{}' {}", flicker.lag, flicker.sixtieths / 60.0));
  return joined(tics, ", ");
}

}  // namespace

void draw_motion(std::span<const Record> records, FigureScript& script) {
  const std::string& metric = script.options.analysis.metric;
  const Motions motions = motions_of(records, metric);
  if (motions.places.empty()) throw Error("there is nothing to draw: no contender follows a path");
  const Column column = quantity_column(metric), flicker = quantity_column(std::string(flicker_metrics[0].name));
  const std::vector<Panel> by_frame = frame_panels(motions, column, script);
  const std::vector<Panel> by_lag = flicker_panels(motions, flicker, script);
  const std::size_t count = by_frame.size() + by_lag.size();
  require_panels(count, by_lag.empty() ? "scenes, lights and paths" : "scenes, lights and paths, two of each");
  require_series(motions.settings.size(), "settings");
  name_settings(motions, script);

  std::size_t last = 1;
  for (const PathErrors& motion : motions.rows) last = std::max(last, motion.frames - 1);
  script.shows = fmt::format("{} by frame", axis_label(column));
  PanelFrame frame{.titles = {}, .x_label = "frame", .y_label = axis_label(column)};
  if (count > 4) frame.height_cm = 3.4;  // the least, so that the figure stays below a page's height
  for (const auto* panels : {&by_frame, &by_lag})
    for (const Panel& panel : *panels) frame.titles.push_back(panel.title);
  const PanelGrid grid = open_panels(script, frame);
  script.add("set xrange [0:{}]; set xtics {}", last,
             std::max(1.0, linear_step(0, static_cast<double>(last), grid.x_labels(4))));
  std::size_t panel = 0;
  const auto draw = [&](const std::vector<Panel>& panels, const std::string& label) {
    for (const Panel& one : panels) {
      open_panel(script, grid, panel, one.title, panel % grid.columns == 0 || &one == &panels.front() ? label : "");
      script.add("set yrange [{}:*]", one.least < 0 ? "*" : "0");
      one.plot.into(script);
      ++panel;
    }
  };
  draw(by_frame, axis_label(column));
  if (!by_lag.empty()) {
    script.add("set logscale x; set xrange [{}:{}]; set xtics ({}); set xlabel 'lag (s)' offset 0,0.4",
               std::begin(flicker_metrics)->sixtieths / 60.0 / 1.4, std::end(flicker_metrics)[-1].sixtieths / 60.0 * 1.4,
               flicker_tics());
    draw(by_lag, fmt::format("flicker ({})", flicker.shown_unit));
  }
  close_panels(script);
}

}  // namespace gnomon
