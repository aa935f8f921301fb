// A metric over two parameters as a heat map, one panel for each map; over one parameter as lines.
#include <algorithm>
#include <cmath>

#include "report/figure/figure_script.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

std::string facet_text(const Map& map) {
  std::vector<std::string> parts;
  for (const auto& [name, value] : map.facet) parts.push_back(fmt::format("{}={}", name, value));
  return joined(parts, ", ");
}

/// "name value at place" for tics.
std::string tics(const std::vector<std::string>& values) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < values.size(); ++i) all.push_back(fmt::format("{} {}", FigureScript::quoted(values[i]), i));
  return fmt::format("({})", joined(all, ", "));
}

void draw_lines(const std::vector<Map>& maps, const Column& column, const FigureOptions& options, FigureScript& script) {
  Legend legend;
  std::string plot;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    std::vector<std::string> lines;
    for (std::size_t x = 0; x < maps[k].xs.size(); ++x)
      if (const auto& cell = maps[k].at(x, 0); cell.value)
        lines.push_back(fmt::format("{}\t{}", x, *cell.value * column.shown_scale));
    const std::string style = fmt::format("with linespoints pt {} ps 0.8 lw 1.4 lc rgb '{}'", series_mark(k), series_color(k));
    plot += fmt::format("{}{} using 1:2 {} notitle", k == 0 ? "" : ", ", script.data(lines), style);
    const std::string facet = facet_text(maps[k]);
    legend.entries.push_back({style, maps[k].technique + (facet.empty() ? "" : " " + facet)});
  }
  open_panels(script, 1, 1, options.width_cm * 0.5, legend, options);
  script.add("set xtics {}; set xrange [-0.3:{}]; set yrange [0:*]", tics(maps.front().xs),
             static_cast<double>(maps.front().xs.size()) - 0.7);
  script.add("set xlabel {}", FigureScript::quoted(maps.front().x));
  script.add("set ylabel {}", FigureScript::quoted(fmt::format("{}, mean over {}", axis_label(column), maps.front().places)));
  script.add("plot {}", plot);
  close_panels(script, legend, options);
}

}  // namespace

void draw_map(std::span<const Record> records, const FigureOptions& options, FigureScript& script) {
  const AnalysisOptions& wanted = options.analysis;
  const std::vector<Map> maps =
      make_maps(records, {.metric = wanted.metric, .x = wanted.x, .y = wanted.y, .facet = wanted.facet});
  const Column column = quantity_column(wanted.metric);
  require_panels(maps.size(), "maps");
  const bool same_axis =
      std::all_of(maps.begin(), maps.end(), [&](const Map& m) { return m.x == maps[0].x && m.xs == maps[0].xs; });
  const bool are_lines = std::all_of(maps.begin(), maps.end(), [](const Map& map) { return map.y.empty(); });
  if (are_lines && same_axis) return draw_lines(maps, column, options, script);

  double least = INFINITY, greatest = -INFINITY;
  std::size_t most_cells = 0, most_rows = 0;
  for (const Map& map : maps) {
    most_cells = std::max(most_cells, map.xs.size());
    most_rows = std::max(most_rows, map.ys.size());
    for (const Map::Cell& cell : map.cells) {
      if (!cell.value) continue;
      least = std::min(least, *cell.value * column.shown_scale);
      greatest = std::max(greatest, *cell.value * column.shown_scale);
    }
  }
  const bool is_log = least > 0 && greatest / least > 20;
  // Where in the palette a value lies: dark below the middle, where its number must be white.
  const auto share = [&](double value) {
    if (greatest <= least) return 1.0;
    return is_log ? std::log(value / least) / std::log(greatest / least) : (value - least) / (greatest - least);
  };
  std::vector<std::string> blocks, labels;
  for (const Map& map : maps) {
    std::vector<std::string> lines;
    std::string marks;
    for (std::size_t y = 0; y < map.ys.size(); ++y)
      for (std::size_t x = 0; x < map.xs.size(); ++x) {
        const Map::Cell& cell = map.at(x, y);
        if (!cell.value) continue;
        const double value = *cell.value * column.shown_scale;
        lines.push_back(fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}", x, y, static_cast<double>(x) - 0.5,
                                    static_cast<double>(x) + 0.5, static_cast<double>(y) - 0.5, static_cast<double>(y) + 0.5,
                                    value));
        if (most_cells <= 12)
          marks += fmt::format("set label {} at {},{} center front textcolor rgb '{}'\n", FigureScript::quoted(measured(value)),
                               x, y, share(value) < 0.55 ? "#ffffff" : "#111111");
        if (cell.is_best)
          marks +=
              fmt::format("set object rectangle from {},{} to {},{} front fillstyle empty border lc rgb '#d55e00' lw 2.5\n",
                          static_cast<double>(x) - 0.47, static_cast<double>(y) - 0.47, static_cast<double>(x) + 0.47,
                          static_cast<double>(y) + 0.47);
      }
    blocks.push_back(script.data(lines));
    labels.push_back(std::move(marks));
  }

  Legend legend;
  legend.entries.push_back({"with points pt 4 ps 1.4 lw 2 lc rgb '#d55e00'",
                            fmt::format("best; {}, mean over {} places", axis_label(column), maps.front().places)});
  const std::size_t columns = maps.size() == 1 ? 1 : most_cells > 6 ? 2 : 3;
  open_panels(script, maps.size(), columns, 2.6 + 0.75 * static_cast<double>(std::max<std::size_t>(most_rows, 2)), legend,
              options);
  script.add("set palette defined (0 '#440154', 0.25 '#3b528b', 0.5 '#21918c', 0.75 '#5ec962', 1 '#fde725')");
  script.add("unset colorbox; unset grid; set border 0; set tics scale 0{}", is_log ? "; set logscale cb" : "");
  script.add("set cbrange [{}:{}]; set style fill solid 1 noborder", least, greatest > least ? greatest : least + 1);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const Map& map = maps[k];
    std::string heading = facet_text(map);
    const bool many_techniques = maps.front().technique != maps.back().technique;
    if (many_techniques || heading.empty()) heading = map.technique + (heading.empty() ? "" : ": " + heading);
    script.add("unset label; unset object");
    script.add("set title {} offset 0,-0.7", FigureScript::quoted(heading));
    script.add("set xlabel {} offset 0,0.4; set ylabel {}", FigureScript::quoted(map.x), FigureScript::quoted(map.y));
    script.add("set xtics {}; set ytics {}", tics(map.xs), tics(map.ys));
    script.add("set xrange [-0.5:{}]; set yrange [-0.5:{}]", static_cast<double>(map.xs.size()) - 0.5,
               static_cast<double>(map.ys.size()) - 0.5);
    script.add("{}plot {} using 1:2:3:4:5:6:7 with boxxyerror lc palette notitle", labels[k], blocks[k]);
  }
  close_panels(script, legend, options);
}

}  // namespace gnomon
