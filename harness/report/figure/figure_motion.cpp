// A metric at every frame of a path, one panel for each scene, light and path.
#include <algorithm>

#include "report/figure/figure_script.h"

namespace gnomon {

void draw_motion(std::span<const Record> records, const FigureOptions& options, FigureScript& script) {
  const std::string& metric = options.analysis.metric;
  const std::vector<Motion> motions = find_motion(records, metric);
  const Column column = quantity_column(metric);
  std::vector<Place> places;
  std::vector<std::string> settings;
  for (const Motion& motion : motions) {
    if (motion.record->role != Role::contender) continue;
    const Place place = place_of(*motion.record);
    if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    const std::string setting = setting_name(*motion.record);
    if (std::find(settings.begin(), settings.end(), setting) == settings.end()) settings.push_back(setting);
  }
  if (places.empty()) throw Error("there is nothing to draw: no contender follows a path");
  require_panels(places.size(), "scenes, lights and paths");
  Legend legend;
  const auto style = [](std::size_t k) {
    return fmt::format("with linespoints pt {} ps 0.5 lw 1.3 lc rgb '{}'", series_mark(k), series_color(k));
  };
  for (std::size_t k = 0; k < settings.size(); ++k) legend.entries.push_back({style(k), settings[k]});

  std::vector<std::string> plots(places.size());
  for (const Motion& motion : motions) {
    if (motion.record->role != Role::contender) continue;
    const auto panel =
        static_cast<std::size_t>(std::find(places.begin(), places.end(), place_of(*motion.record)) - places.begin());
    const auto k =
        static_cast<std::size_t>(std::find(settings.begin(), settings.end(), setting_name(*motion.record)) - settings.begin());
    const auto found = motion.record->frames.find(metric);
    if (found == motion.record->frames.end()) continue;
    std::vector<std::string> lines;
    for (std::size_t frame = 0; frame < found->second.size(); ++frame)
      if (const auto& value = found->second[frame]) lines.push_back(fmt::format("{}\t{}", frame, *value * column.shown_scale));
    if (lines.empty()) continue;
    std::string& plot = plots[panel];
    plot += fmt::format("{}{} using 1:2 {} notitle", plot.empty() ? "" : ", \\\n  ", script.data(lines), style(k));
  }
  const std::size_t columns =
      open_panels(script, places.size(), 2, options.width_cm * (places.size() == 1 ? 0.5 : 0.36), legend, options);
  std::size_t last = 1;
  for (const Motion& motion : motions) last = std::max(last, motion.frames - 1);
  script.add("set xrange [0:{}]; set yrange [0:*]; set xlabel 'frame' offset 0,0.4", last);
  for (std::size_t panel = 0; panel < places.size(); ++panel) {
    script.add("set title {} offset 0,-0.6", FigureScript::quoted(title(places[panel], places)));
    script.add("set ylabel {}", panel % columns == 0 ? FigureScript::quoted(axis_label(column)) : "''");
    script.add("plot {}", plots[panel].empty() ? "NaN notitle" : plots[panel]);
  }
  close_panels(script, legend, options);
}

}  // namespace gnomon
