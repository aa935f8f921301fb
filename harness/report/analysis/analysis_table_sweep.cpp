#include "analysis/sweep.h"
#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

constexpr std::size_t most_columns = 12;  // values of x beside one another, on a terminal and on paper

std::string against(const Sweeps& sweeps, const Column& quantity) {
  return fmt::format("{} against {}{}", with_unit(quantity), sweeps.parameter, sweeps.unit.empty() ? "" : " in " + sweeps.unit);
}

/// For programs: one row a point.
Layout sweep_rows(const Sweeps& sweeps, const Column& quantity) {
  Layout table;
  table.title = against(sweeps, quantity);
  const bool is_time = sweeps.quantity.ends_with("_ms");
  table.columns = place_columns();
  table.columns.insert(table.columns.end(),
                       {text_column("setting", "technique"), text_column("role", "role"),
                        whole_column("parameter." + sweeps.parameter, sweeps.unit, sweeps.parameter), quantity});
  if (is_time)
    for (const std::string end : {"low", "high"}) table.columns.push_back(lengthened(quantity, "_" + end, end));
  table.columns.push_back(text_column("status", "status"));
  Layout::Group& group = table.groups.emplace_back();
  for (const Sweep& sweep : sweeps.rows)
    for (const Sweep::Point& point : sweep.points) {
      Cells cells = place_cells(sweep.place);
      cells.insert(cells.end(),
                   {text_cell(sweep.setting), text_cell(name(sweep.role)), Cell{.value = point.x}, value_of(point.value)});
      if (is_time)
        for (const auto which : {&ValueWithInterval::low, &ValueWithInterval::high}) cells.push_back(end(point.value, which));
      cells.push_back(text_cell(name(point.status)));
      group.rows.push_back({.cells = std::move(cells)});
    }
  return table;
}

/// For people: one row a setting, one column a value of x, for the places that were swept over the same values.
Layout sweep_table(const Sweeps& sweeps, const Column& quantity, std::span<const double> xs, std::span<const Place> places) {
  Layout table;
  const bool is_ratio = quantity.unit == "ratio";
  table.columns.push_back(text_column("setting", "technique"));
  for (const double x : xs) table.columns.push_back(at_value(quantity, exact(x)));
  for (const Place& place : places) {
    Layout::Group& group = table.groups.emplace_back(Layout::Group{.heading = title(place, sweeps.places)});
    for (const Sweep& sweep : sweeps.rows) {
      if (sweep.place != place) continue;
      Cells& cells = group.rows.emplace_back().cells;
      cells.push_back(text_cell(sweep.setting));
      for (const double x : xs) {
        const auto point = std::ranges::find(sweep.points, x, &Sweep::Point::x);
        cells.push_back(point != sweep.points.end() ? value_of(point->value) : Cell{});
        // What is near 1 is read by its distance to 1.
        if (const double* value = cells.back().number(); value && is_ratio) cells.back().shown = fmt::format("{:.3f}", *value);
      }
    }
  }
  return table;
}

/// Why cells have no value, and what is left out.
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

Tables sweep_tables(std::span<const Record> records, const AnalysisOptions& options, Format format) {
  const Sweeps sweeps = find_sweeps(records, options.x, options.metric);
  const Column quantity = quantity_column(options.metric);
  Tables tables;
  if (format == Format::csv || format == Format::json) {
    tables.push_back(sweep_rows(sweeps, quantity));
  } else {
    // Places that were swept over the same values share columns.
    std::vector<std::pair<std::vector<double>, std::vector<Place>>> alike;
    for (const Place& place : sweeps.places) value_of_key(alike, sweeps.xs(place)).push_back(place);
    for (const auto& [xs, places] : alike) {
      const std::size_t parts = format == Format::markdown ? 1 : (xs.size() + most_columns - 1) / most_columns;
      const std::size_t size = (xs.size() + parts - 1) / parts;
      for (std::size_t from = 0; from < xs.size(); from += size)
        tables.push_back(sweep_table(sweeps, quantity, std::span(xs).subspan(from, std::min(size, xs.size() - from)), places));
    }
    for (Layout& table : tables)
      if (&table == &tables.front() || format == Format::latex) table.title = against(sweeps, quantity);
  }
  tables.back().notes = sweep_notes(sweeps);
  return tables;
}

}  // namespace gnomon::analysis
