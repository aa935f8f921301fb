// A metric at every frame of a path, one panel for each scene, light and path.
#include "report/figure/figure_script.h"

namespace gnomon {

void draw_motion(std::span<const Record> records, FigureScript& script) {
  const std::string& metric = script.options.analysis.metric;
  const std::vector<PathErrors> motions = find_motion(records, metric);
  const Column column = quantity_column(metric);
  std::vector<Place> places;
  std::vector<std::string> settings;
  for (const PathErrors& motion : motions) {
    if (motion.record->role != Role::contender) continue;
    add_once(places, place_of(*motion.record));
    add_once(settings, setting_name(*motion.record));
  }
  if (places.empty()) throw Error("there is nothing to draw: no contender follows a path");
  require_panels(places.size(), "scenes, lights and paths");
  const auto style = [](std::size_t k) {
    return fmt::format("with linespoints pt {} ps 0.5 lw 1.3 lc rgb '{}'", series_mark(k), series_color(k));
  };
  for (std::size_t k = 0; k < settings.size(); ++k) script.legend.push_back({style(k), settings[k]});

  std::vector<PlotCommand> plots(places.size());
  std::size_t last = 1;
  for (const PathErrors& motion : motions) {
    last = std::max(last, motion.frames - 1);
    const auto found = motion.record->frames.find(metric);
    if (motion.record->role != Role::contender || found == motion.record->frames.end()) continue;
    std::vector<std::string> lines;
    for (std::size_t frame = 0; frame < found->second.size(); ++frame)
      if (const auto& value = found->second[frame]) lines.push_back(fmt::format("{}\t{}", frame, *value * column.shown_scale));
    if (lines.empty()) continue;
    plots[index_of(places, place_of(*motion.record))].add("{} using 1:2 {} notitle", script.data(lines),
                                                          style(index_of(settings, setting_name(*motion.record))));
  }
  const std::size_t columns =
      open_panels(script, places.size(), 2, script.options.width_cm * (places.size() == 1 ? 0.5 : 0.36));
  script.add("set xrange [0:{}]; set yrange [0:*]; set xlabel 'frame' offset 0,0.4", last);
  for (std::size_t panel = 0; panel < places.size(); ++panel) {
    open_panel(script, title(places[panel], places), panel % columns == 0 ? axis_label(column) : "");
    plots[panel].into(script);
  }
  close_panels(script);
}

}  // namespace gnomon
