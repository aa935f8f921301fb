#include <algorithm>

#include "analysis/sweep.h"
#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"
#include "report/table/layout.h"

namespace gnomon::analysis {

namespace {

constexpr std::size_t most_columns = 12;  // values of x beside one another, on a terminal and on paper

std::string against(const Sweeps& sweeps) {
  return fmt::format("{} against {}{}", with_unit(sweeps.quantity), sweeps.parameter,
                     sweeps.unit.empty() ? "" : " in " + sweeps.unit);
}

/// For programs: one row a point.
Grid sweep_rows(const Sweeps& sweeps) {
  Grid grid;
  grid.title = against(sweeps);
  const bool is_time = sweeps.quantity.ends_with("_ms");
  add_place_heads(grid);
  grid.heads.push_back(words("setting", "technique"));
  grid.heads.push_back(words("role", "role"));
  grid.heads.push_back(number("parameter." + sweeps.parameter, sweeps.unit, sweeps.parameter, Audience::all, true));
  grid.heads.push_back(of_quantity(sweeps.quantity));
  if (is_time)
    for (const char* one : {"low", "high"}) grid.heads.push_back(of_quantity(sweeps.quantity, fmt::format("_{}", one), one));
  grid.heads.push_back(words("status", "status"));
  Grid::Group& group = grid.groups.emplace_back();
  for (const Sweep& sweep : sweeps.rows)
    for (const Sweep::Point& point : sweep.points) {
      Entries row;
      add_place(row, sweep.place);
      row.push_back({text(sweep.setting)});
      row.push_back({text(std::string(name(sweep.role)))});
      row.push_back({{.value = point.x}});
      row.push_back({value_of(point.value)});
      if (is_time)
        for (const auto which : {&ValueWithInterval::low, &ValueWithInterval::high}) row.push_back({end(point.value, which)});
      row.push_back({text(std::string(name(point.status)))});
      group.rows.push_back(std::move(row));
    }
  return grid;
}

/// For people: one row a setting, one column a value of x, for the places that were swept over the same values.
Grid sweep_grid(const Sweeps& sweeps, std::span<const double> xs, std::span<const Place> places) {
  Grid grid;
  const bool is_ratio = quantity_column(sweeps.quantity).unit == "ratio";
  grid.heads.push_back(words("setting", "technique"));
  for (const double x : xs) {
    Column column = quantity_column(sweeps.quantity);
    column.heading = exact(x);
    column.shown_unit = "";  // the title says it
    grid.heads.push_back({std::move(column), Audience::all});
  }
  for (const Place& place : places) {
    Grid::Group& group = grid.groups.emplace_back();
    group.heading = title(place, sweeps.places);
    for (const Sweep& sweep : sweeps.rows) {
      if (sweep.place != place) continue;
      Entries row{{text(sweep.setting)}};
      for (const double x : xs) {
        const auto point = std::find_if(sweep.points.begin(), sweep.points.end(), [&](const auto& p) { return p.x == x; });
        const bool has_value = point != sweep.points.end() && point->value;
        Cell cell;
        if (has_value) cell.value = point->value->value;
        // What is near 1 is read by its distance to 1.
        if (has_value && is_ratio) cell.shown = fmt::format("{:.3f}", point->value->value);
        row.push_back({std::move(cell)});
      }
      group.rows.push_back(std::move(row));
    }
  }
  return grid;
}

/// What stands behind the cells without a value, and what is left out.
std::vector<std::string> sweep_notes(const Sweeps& sweeps) {
  std::size_t unsupported = 0, failed = 0, undefined = 0, absent = 0;
  for (const Sweep& sweep : sweeps.rows) {
    absent += sweeps.xs(sweep.place).size() - sweep.points.size();
    for (const Sweep::Point& point : sweep.points) {
      unsupported += point.status == Status::unsupported;
      failed += point.status == Status::failed;
      undefined += point.status == Status::ok && !point.value;
    }
  }
  std::vector<std::string> why, notes;
  for (const auto& [count, what] :
       {std::pair(unsupported, "not supported"), {failed, "failed"}, {undefined, "not defined"}, {absent, "not run"}})
    if (count > 0) why.push_back(fmt::format("{} {}", count, what));
  if (!why.empty()) notes.push_back(fmt::format("-: no value; {}", joined(why, ", ")));
  if (sweeps.single > 0)
    notes.push_back(fmt::format("{} setting{} with a single value of {} {} left out", sweeps.single,
                                sweeps.single == 1 ? "" : "s", sweeps.parameter, sweeps.single == 1 ? "is" : "are"));
  if (sweeps.repeated > 0)
    notes.push_back(fmt::format("{} row{} at a value of {} that an earlier one has {} left out", sweeps.repeated,
                                sweeps.repeated == 1 ? "" : "s", sweeps.parameter, sweeps.repeated == 1 ? "is" : "are"));
  return notes;
}

}  // namespace

std::string sweep_text(std::span<const Record> records, const AnalysisOptions& options, Format format,
                       const TableOptions& table) {
  const Sweeps sweeps = find_sweeps(records, options.x, options.metric);
  std::vector<Grid> grids;
  if (format == Format::csv || format == Format::json) {
    grids.push_back(sweep_rows(sweeps));
  } else {
    // Places that were swept over the same values share columns.
    std::vector<std::pair<std::vector<double>, std::vector<Place>>> alike;
    for (const Place& place : sweeps.places) value_of_key(alike, sweeps.xs(place)).push_back(place);
    for (const auto& [xs, places] : alike) {
      const bool is_cut = format != Format::markdown;
      const std::size_t parts = is_cut ? (xs.size() + most_columns - 1) / most_columns : 1;
      const std::size_t size = (xs.size() + parts - 1) / parts;
      for (std::size_t from = 0; from < xs.size(); from += size)
        grids.push_back(sweep_grid(sweeps, std::span(xs).subspan(from, std::min(size, xs.size() - from)), places));
    }
    for (Grid& grid : grids)
      if (&grid == &grids.front() || format == Format::latex) grid.title = against(sweeps);
  }
  grids.back().notes = sweep_notes(sweeps);
  grids.back().provenance = provenance(records);
  return render_grids(grids, format, table);
}

}  // namespace gnomon::analysis
