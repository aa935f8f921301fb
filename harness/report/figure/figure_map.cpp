// A metric over two parameters as a heat map, one panel for each map; over one parameter as lines.
#include "report/figure/figure_axis.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

/// Curves over one parameter, all in one panel.
void draw_lines(const std::vector<Map>& maps, const Column& column, FigureScript& script) {
  require_series(maps.size(), "settings");
  PlotCommand plot;
  double least = 0;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    std::vector<std::string> lines;
    for (std::size_t x = 0; x < maps[k].xs.size(); ++x)
      if (const auto& cell = maps[k].at(x, 0); cell.value) {
        lines.push_back(fmt::format("{}\t{}", x, *cell.value * column.shown_scale));
        least = std::min(least, *cell.value);
      }
    const auto [color, mark, dashes] = series_style(k);
    const std::string style = fmt::format("with linespoints pt {} ps 0.8 lw 1.4 dt {} lc rgb '{}'", mark, dashes, color);
    const std::string facet = maps[k].facet_text(), name = maps[k].technique + (facet.empty() ? "" : " " + facet);
    plot.add(name, "{} using 1:2 {} notitle", script.data(lines), style);
    script.legend.push_back({style, name});
  }
  const Map& first = maps.front();
  const std::string y_label = fmt::format("{}, mean over {}", axis_label(column), places_text(first));
  script.shows = fmt::format("{} against {}", y_label, first.x);
  const PanelGrid grid = open_panels(script, {.titles = {""}, .x_label = first.x, .y_label = y_label, .x_names = {first.xs}});
  script.add("set xtics {}; set xrange [-0.3:{}]; set yrange [{}:*]", word_tics(first.xs, grid.is_turned(0)),
             static_cast<double>(first.xs.size()) - 0.7, least < 0 ? "*" : "0");
  open_panel(script, grid, 0, "", y_label);
  plot.into(script);
  close_panels(script);
}

constexpr std::string_view viridis[] = {"#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"};

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
  /// The value at a share of the palette.
  double at(double share) const {
    const auto [least, greatest] = values;
    return is_log ? least * std::pow(greatest / least, share) : least + share * (greatest - least);
  }
  /// Where a value lies, 0 .. 1: dark below the middle, where its number must be white.
  double share(double value) const {
    if (values.greatest <= values.least) return 1;
    return is_log ? std::log(value / values.least) / std::log(values.greatest / values.least)
                  : (value - values.least) / (values.greatest - values.least);
  }
};

/// The block of a map's cells.
std::string cell_data(const Map& map, double scale, FigureScript& script) {
  std::vector<std::string> lines;
  for (std::size_t row = 0; row < map.ys.size(); ++row)
    for (std::size_t column = 0; column < map.xs.size(); ++column) {
      const Map::Cell& cell = map.at(column, row);
      if (!cell.value) continue;
      const auto x = static_cast<double>(column), y = static_cast<double>(row);
      lines.push_back(fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}", x, y, x - 0.5, x + 0.5, y - 0.5, y + 0.5, *cell.value * scale));
    }
  return script.data(lines);
}

/// Numbers and frames on the cells of the next panel.
void mark_cells(const Map& map, double scale, const Palette& palette, bool with_numbers, FigureScript& script) {
  for (std::size_t row = 0; row < map.ys.size(); ++row)
    for (std::size_t column = 0; column < map.xs.size(); ++column) {
      const Map::Cell& cell = map.at(column, row);
      if (!cell.value) continue;
      const double value = *cell.value * scale;
      const auto x = static_cast<double>(column), y = static_cast<double>(row);
      if (with_numbers)
        script.add("set label {} at {},{} center front textcolor rgb '{}'", FigureScript::quoted(measured(value)), x, y,
                   palette.share(value) < 0.55 ? "#ffffff" : "#111111");
      if (cell.is_best)
        script.add("set object rectangle from {},{} to {},{} front fillstyle empty border lc rgb '{}' lw 2.5", x - 0.47,
                   y - 0.47, x + 0.47, y + 0.47, figure_colors[1]);
    }
}

/// Whether the number of every cell is narrower than its cell.
bool do_numbers_fit(std::span<const Map> maps, double scale, const PanelGrid& grid) {
  return std::ranges::all_of(maps, [&](const Map& map) {
    const double cell_cm = grid.width_cm / static_cast<double>(map.xs.size()) - 0.1;
    return std::ranges::all_of(map.cells, [&](const Map::Cell& cell) {
      return !cell.value || FigureScript::text_cm(measured(*cell.value * scale)) < cell_cm;
    });
  });
}

/// "size=1024, pcf=3", with the technique where maps are of several or nothing else is to be said.
std::string heading_of(const Map& map, bool with_technique) {
  const std::string facet = map.facet_text();
  if (facet.empty()) return map.technique;
  return with_technique ? map.technique + ": " + facet : facet;
}

/// The best cell, and values of colors where cells hold no numbers.
void add_legend(const Palette& palette, std::string text, bool with_numbers, FigureScript& script) {
  script.legend.push_back({fmt::format("with points pt 4 ps 1.4 lw 2 lc rgb '{}'", figure_colors[1]), std::move(text)});
  if (with_numbers) return;
  for (std::size_t k = 0; k < std::size(viridis); ++k)
    script.legend.push_back({fmt::format("with points pt 5 ps 1.4 lc rgb '{}'", viridis[k]),
                             measured(palette.at(static_cast<double>(k) / (std::size(viridis) - 1)))});
}

void draw_heat_maps(const std::vector<Map>& maps, const Column& column, FigureScript& script) {
  const Palette palette(maps, column.shown_scale);
  PanelFrame frame{.titles = {}, .x_label = "parameter", .y_label = "parameter"};
  std::size_t most_columns = 0, most_rows = 2;
  for (const Map& map : maps) {
    frame.titles.push_back(heading_of(map, maps.front().technique != maps.back().technique));
    if (map.xs.size() > most_columns) frame.x_names = {map.xs};
    for (const std::string& name : map.ys) add_once(frame.y_names, name);
    most_columns = std::max(most_columns, map.xs.size());
    most_rows = std::max(most_rows, map.ys.size());
  }
  frame.most_columns = maps.size() == 1 ? 1 : most_columns > 6 ? 2 : 3;
  frame.height_cm = 0.7 + 0.75 * static_cast<double>(most_rows);
  PanelGrid grid = panel_grid(frame, script.options.width_cm);
  const bool with_numbers = do_numbers_fit(maps, column.shown_scale, grid);
  std::vector<std::string> cells;
  for (const Map& map : maps) cells.push_back(cell_data(map, column.shown_scale, script));
  const std::string shown = fmt::format("{}, mean over {}", axis_label(column), places_text(maps.front()));
  script.shows = shown + " over parameters";
  add_legend(palette, "best; " + shown, with_numbers, script);
  grid = open_panels(script, frame);
  const auto [least, greatest] = palette.values;
  std::vector<std::string> stops;
  for (std::size_t k = 0; k < std::size(viridis); ++k) stops.push_back(fmt::format("{} '{}'", k, viridis[k]));
  script.add("set palette defined ({})", joined(stops, ", "));
  script.add("unset colorbox; unset grid; set border 0; set tics scale 0{}", palette.is_log ? "; set logscale cb" : "");
  script.add("set cbrange [{}:{}]; set style fill solid 1 noborder", least, greatest > least ? greatest : least + 1);
  for (std::size_t k = 0; k < maps.size(); ++k) {
    const Map& map = maps[k];
    script.add("unset label; unset object");
    open_panel(script, grid, k, frame.titles[k], map.y);
    script.add("set xlabel {} offset 0,0.4", FigureScript::quoted(map.x));
    script.add("set xtics {}; set ytics {}", word_tics(map.xs, grid.is_turned(k)), word_tics(map.ys, false));
    script.add("set xrange [-0.5:{}]; set yrange [-0.5:{}]", static_cast<double>(map.xs.size()) - 0.5,
               static_cast<double>(map.ys.size()) - 0.5);
    mark_cells(map, column.shown_scale, palette, with_numbers, script);
    PlotCommand plot;
    plot.add(frame.titles[k], "{} using 1:2:3:4:5:6:7 with boxxyerror lc palette notitle", cells[k]);
    plot.into(script);
  }
  close_panels(script);
}

}  // namespace

void draw_map(std::span<const Record> records, FigureScript& script) {
  const AnalysisOptions& wanted = script.options.analysis;
  require_drawable(records, quantity_column(wanted.metric));
  const std::vector<Map> maps =
      make_maps(records, {.metric = wanted.metric, .x = wanted.x, .y = wanted.y, .facet = wanted.facet});
  require_panels(maps.size(), "maps");
  const Map& first = maps.front();
  const bool are_lines =
      std::ranges::all_of(maps, [&](const Map& map) { return map.y.empty() && map.x == first.x && map.xs == first.xs; });
  (are_lines ? draw_lines : draw_heat_maps)(maps, quantity_column(wanted.metric), script);
}

}  // namespace gnomon
