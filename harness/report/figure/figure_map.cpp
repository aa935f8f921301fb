// A metric over two parameters as a heat map, one panel for each map; over one parameter as lines.
#include "report/figure/figure_script.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

/// "name value at place" for tics.
std::string tics(const std::vector<std::string>& values) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < values.size(); ++i) all.push_back(fmt::format("{} {}", FigureScript::quoted_tic(values[i]), i));
  return fmt::format("({})", joined(all, ", "));
}

/// Curves over one parameter, all in one panel.
void draw_lines(const std::vector<Map>& maps, const Column& column, FigureScript& script) {
  PlotCommand plot;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    std::vector<std::string> lines;
    for (std::size_t x = 0; x < maps[k].xs.size(); ++x)
      if (const auto& cell = maps[k].at(x, 0); cell.value)
        lines.push_back(fmt::format("{}\t{}", x, *cell.value * column.shown_scale));
    const std::string style = fmt::format("with linespoints pt {} ps 0.8 lw 1.4 lc rgb '{}'", series_mark(k), series_color(k));
    plot.add("{} using 1:2 {} notitle", script.data(lines), style);
    const std::string facet = maps[k].facet_text();
    script.legend.push_back({style, maps[k].technique + (facet.empty() ? "" : " " + facet)});
  }
  open_panels(script, 1, 1, script.options.width_cm * 0.5);
  script.add("set xtics {}; set xrange [-0.3:{}]; set yrange [0:*]", tics(maps.front().xs),
             static_cast<double>(maps.front().xs.size()) - 0.7);
  script.add("set xlabel {}", FigureScript::quoted(maps.front().x));
  script.add("set ylabel {}",
             FigureScript::quoted(fmt::format("{}, mean over {}", axis_label(column), places_text(maps.front()))));
  plot.into(script);
  close_panels(script);
}

/// The values of all maps, which share one palette.
struct Palette {
  Extent values;
  bool is_log = false;

  Palette(std::span<const Map> maps, double scale) {
    for (const Map& map : maps)
      for (const Map::Cell& cell : map.cells)
        if (cell.value) values.add(*cell.value * scale);
    is_log = values.least > 0 && values.greatest / values.least > 20;
  }
  /// Where a value lies, 0 .. 1: dark below the middle, where its number must be white.
  double share(double value) const {
    if (values.greatest <= values.least) return 1;
    return is_log ? std::log(value / values.least) / std::log(values.greatest / values.least)
                  : (value - values.least) / (values.greatest - values.least);
  }
};

/// One map in the script: the name of its block of cells, and the commands that write numbers and frames on them.
struct DrawnMap {
  std::string data, marks;
};

DrawnMap draw_cells(const Map& map, double scale, const Palette& palette, bool with_numbers, FigureScript& script) {
  std::vector<std::string> lines;
  std::string marks;
  for (std::size_t row = 0; row < map.ys.size(); ++row)
    for (std::size_t column = 0; column < map.xs.size(); ++column) {
      const Map::Cell& cell = map.at(column, row);
      if (!cell.value) continue;
      const double value = *cell.value * scale;
      const auto x = static_cast<double>(column), y = static_cast<double>(row);
      lines.push_back(fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}", x, y, x - 0.5, x + 0.5, y - 0.5, y + 0.5, value));
      if (with_numbers)
        marks += fmt::format("set label {} at {},{} center front textcolor rgb '{}'\n", FigureScript::quoted(measured(value)),
                             x, y, palette.share(value) < 0.55 ? "#ffffff" : "#111111");
      if (cell.is_best)
        marks += fmt::format("set object rectangle from {},{} to {},{} front fillstyle empty border lc rgb '#d55e00' lw 2.5\n",
                             x - 0.47, y - 0.47, x + 0.47, y + 0.47);
    }
  return {script.data(lines), std::move(marks)};
}

/// "size=1024, pcf=3", with the technique where maps are of several or nothing else is to be said.
std::string heading_of(const Map& map, bool with_technique) {
  const std::string facet = map.facet_text();
  if (facet.empty()) return map.technique;
  return with_technique ? map.technique + ": " + facet : facet;
}

void draw_heat_maps(const std::vector<Map>& maps, const Column& column, FigureScript& script) {
  const Palette palette(maps, column.shown_scale);
  std::size_t most_columns = 0, most_rows = 2;
  for (const Map& map : maps) {
    most_columns = std::max(most_columns, map.xs.size());
    most_rows = std::max(most_rows, map.ys.size());
  }
  std::vector<DrawnMap> drawn;
  for (const Map& map : maps) drawn.push_back(draw_cells(map, column.shown_scale, palette, most_columns <= 12, script));
  script.legend.push_back({"with points pt 4 ps 1.4 lw 2 lc rgb '#d55e00'",
                           fmt::format("best; {}, mean over {}", axis_label(column), places_text(maps.front()))});
  const std::size_t panel_columns = maps.size() == 1 ? 1 : most_columns > 6 ? 2 : 3;
  open_panels(script, maps.size(), panel_columns, 2.6 + 0.75 * static_cast<double>(most_rows));
  const auto [least, greatest] = palette.values;
  script.add("set palette defined (0 '#440154', 0.25 '#3b528b', 0.5 '#21918c', 0.75 '#5ec962', 1 '#fde725')");
  script.add("unset colorbox; unset grid; set border 0; set tics scale 0{}", palette.is_log ? "; set logscale cb" : "");
  script.add("set cbrange [{}:{}]; set style fill solid 1 noborder", least, greatest > least ? greatest : least + 1);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const Map& map = maps[k];
    script.add("unset label; unset object");
    script.add("set title {} offset 0,-0.7",
               FigureScript::quoted(heading_of(map, maps.front().technique != maps.back().technique)));
    script.add("set xlabel {} offset 0,0.4; set ylabel {}", FigureScript::quoted(map.x), FigureScript::quoted(map.y));
    script.add("set xtics {}; set ytics {}", tics(map.xs), tics(map.ys));
    script.add("set xrange [-0.5:{}]; set yrange [-0.5:{}]", static_cast<double>(map.xs.size()) - 0.5,
               static_cast<double>(map.ys.size()) - 0.5);
    script.add("{}plot {} using 1:2:3:4:5:6:7 with boxxyerror lc palette notitle", drawn[k].marks, drawn[k].data);
  }
  close_panels(script);
}

}  // namespace

void draw_map(std::span<const Record> records, FigureScript& script) {
  const AnalysisOptions& wanted = script.options.analysis;
  const std::vector<Map> maps =
      make_maps(records, {.metric = wanted.metric, .x = wanted.x, .y = wanted.y, .facet = wanted.facet});
  require_panels(maps.size(), "maps");
  const Map& first = maps.front();
  const bool are_lines =
      std::ranges::all_of(maps, [&](const Map& map) { return map.y.empty() && map.x == first.x && map.xs == first.xs; });
  (are_lines ? draw_lines : draw_heat_maps)(maps, quantity_column(wanted.metric), script);
}

}  // namespace gnomon
