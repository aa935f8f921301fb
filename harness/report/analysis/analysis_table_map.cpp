#include "report/analysis/analysis_table_parts.h"
#include "report/table/layout.h"

namespace gnomon::analysis {

namespace {

std::string map_heading(const Map& map) {
  const std::string what = map.y.empty() ? map.x : fmt::format("{} (rows) against {} (columns)", map.y, map.x);
  return fmt::format("{}: {}{}{}", map.technique, what, map.facet.empty() ? "" : "; ", map.facet_text());
}

std::string map_title(const Map& map, const std::string& metric) {
  return fmt::format("{}, mean over {} place{}", with_unit(metric), map.places, map.places == 1 ? "" : "s");
}

/// For programs: one row a cell.
Grid map_rows(const std::vector<Map>& maps, const AnalysisOptions& options) {
  Grid grid;
  grid.title = map_title(maps.front(), options.metric);
  std::vector<std::string> parameters;
  for (const Map& map : maps) {
    std::vector<std::string> here{map.x, map.y};
    for (const auto& [name, value] : map.facet) here.push_back(name);
    for (const std::string& name : here)
      if (!name.empty()) add_once(parameters, name);
  }
  grid.heads.push_back(words("technique", "technique"));
  for (const std::string& parameter : parameters) grid.heads.push_back(words("parameter." + parameter, parameter));
  grid.heads.push_back(of_quantity(options.metric));
  grid.heads.push_back(number("places", "", "places"));
  grid.heads.push_back(words("best", "best"));
  Grid::Group& group = grid.groups.emplace_back();
  for (const Map& map : maps)
    for (std::size_t y = 0; y < map.ys.size(); ++y)
      for (std::size_t x = 0; x < map.xs.size(); ++x) {
        const Map::Cell& cell = map.at(x, y);
        if (!cell.value) continue;
        Entries row{{text(map.technique)}};
        for (const std::string& parameter : parameters) {
          std::string value = parameter == map.x ? map.xs[x] : parameter == map.y ? map.ys[y] : "";
          for (const auto& [name, fixed] : map.facet)
            if (name == parameter) value = fixed;
          row.push_back({text(value)});
        }
        row.push_back({{.value = *cell.value}});
        row.push_back({{.value = static_cast<double>(map.places)}});
        row.push_back({text(cell.is_best ? "true" : "false")});
        group.rows.push_back(std::move(row));
      }
  return grid;
}

}  // namespace

/// For people: a grid of its own for every map, its columns the values of x.
std::string map_text(std::span<const Record> records, const AnalysisOptions& options, Format format,
                     const TableOptions& table) {
  const std::vector<Map> maps =
      make_maps(records, {.metric = options.metric, .x = options.x, .y = options.y, .facet = options.facet});
  if (format == Format::csv || format == Format::json) {
    Grid grid = map_rows(maps, options);
    grid.provenance = provenance(records);
    return render_grid(grid, format, table);
  }
  std::vector<Grid> grids;
  for (const Map& map : maps) {
    Grid& grid = grids.emplace_back();
    if (&map == &maps.front() || format == Format::latex) grid.title = map_title(map, options.metric);
    grid.heads.push_back(words(map.y, map.y));
    for (const std::string& x : map.xs) {
      Column column = quantity_column(options.metric);
      column.heading = x;
      column.shown_unit = "";  // the title says it
      grid.heads.push_back({std::move(column), Audience::all});
    }
    Grid::Group& group = grid.groups.emplace_back();
    group.heading = map_heading(map);
    for (std::size_t y = 0; y < map.ys.size(); ++y) {
      Entries row{{{.value = map.ys[y]}}};
      for (std::size_t x = 0; x < map.xs.size(); ++x) {
        const Map::Cell& cell = map.at(x, y);
        row.push_back({cell.value ? Cell{.value = *cell.value} : Cell{}, cell.is_best});
      }
      group.rows.push_back(std::move(row));
    }
  }
  grids.back().provenance = provenance(records);
  return render_grids(grids, format, table);
}

}  // namespace gnomon::analysis
