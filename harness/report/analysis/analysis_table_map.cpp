#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

namespace {

std::string map_heading(const Map& map) {
  const std::string what = map.y.empty() ? map.x : fmt::format("{} (rows) against {} (columns)", map.y, map.x);
  return fmt::format("{}: {}{}{}", map.technique, what, map.facet.empty() ? "" : "; ", map.facet_text());
}

std::string map_title(const Map& map, const Column& quantity) {
  return fmt::format("{}, mean over {}", with_unit(quantity), places_text(map));
}

/// For programs: one row a cell.
Layout map_rows(const std::vector<Map>& maps, const Column& quantity) {
  Layout table;
  table.title = map_title(maps.front(), quantity);
  for (const Map& map : maps) table.notes.insert(table.notes.end(), map.notes.begin(), map.notes.end());
  std::vector<std::string> parameters;
  for (const Map& map : maps) {
    std::vector<std::string> here{map.x, map.y};
    for (const auto& [name, value] : map.facet) here.push_back(name);
    for (const std::string& name : here)
      if (!name.empty()) add_once(parameters, name);
  }
  table.columns.push_back(text_column("technique", "technique"));
  for (const std::string& parameter : parameters) table.columns.push_back(text_column("parameter." + parameter, parameter));
  table.columns.push_back(quantity);
  table.columns.push_back(number_column("places", "", "places"));
  table.columns.push_back(text_column("best", "best"));
  Layout::Group& group = table.groups.emplace_back();
  for (const Map& map : maps)
    for (std::size_t y = 0; y < map.ys.size(); ++y)
      for (std::size_t x = 0; x < map.xs.size(); ++x) {
        const Map::Cell& cell = map.at(x, y);
        if (!cell.value) continue;
        Cells& cells = group.rows.emplace_back().cells;
        cells.push_back(text_cell(map.technique));
        for (const std::string& parameter : parameters) {
          std::string value = parameter == map.x ? map.xs[x] : parameter == map.y ? map.ys[y] : "";
          for (const auto& [name, fixed] : map.facet)
            if (name == parameter) value = fixed;
          cells.push_back(text_cell(value));
        }
        cells.push_back({.value = *cell.value});
        cells.push_back({.value = static_cast<double>(map.places)});
        cells.push_back(text_cell(cell.is_best ? "true" : "false"));
      }
  return table;
}

}  // namespace

/// For people: a table of its own for every map, its columns the values of x.
Tables map_tables(std::span<const Record> records, const AnalysisOptions& options, Format format) {
  const std::vector<Map> maps =
      make_maps(records, {.metric = options.metric, .x = options.x, .y = options.y, .facet = options.facet});
  const Column quantity = quantity_column(options.metric);
  Tables tables;
  if (format == Format::csv || format == Format::json) return {map_rows(maps, quantity)};
  for (const Map& map : maps) {
    Layout& table = tables.emplace_back();
    if (&map == &maps.front() || format == Format::latex) table.title = map_title(map, quantity);
    table.notes = map.notes;
    table.columns.push_back(text_column(map.y, map.y));
    for (const std::string& x : map.xs) table.columns.push_back(at_value(quantity, x));
    // On a terminal a group's heading is below the head of its table, and each map has a head of its own.
    const std::string heading = map_heading(map);
    if (format == Format::terminal) table.title += (table.title.empty() ? "" : "\n\n") + heading;
    Layout::Group& group = table.groups.emplace_back(Layout::Group{.heading = format == Format::terminal ? "" : heading});
    for (std::size_t y = 0; y < map.ys.size(); ++y) {
      Cells& cells = group.rows.emplace_back().cells;
      cells.push_back({.value = map.ys[y]});
      for (std::size_t x = 0; x < map.xs.size(); ++x) {
        const Map::Cell& cell = map.at(x, y);
        cells.push_back(cell.value ? Cell{.value = *cell.value, .is_best = cell.is_best} : Cell{});
      }
    }
  }
  return tables;
}

}  // namespace gnomon::analysis
