#include <cmath>

#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

std::vector<Column> columns_of(const Growths& growths) {
  std::vector<Column> columns = place_columns();
  columns.insert(columns.end(),
                 {text_column("setting", "technique"), text_column("stage", "stage"), number_column("exponent", "", "exponent"),
                  for_people(text_column("exponent_interval", "interval")),
                  for_programs(number_column("exponent_low", "", "exponent_low")),
                  for_programs(number_column("exponent_high", "", "exponent_high")),
                  for_programs(number_column("coefficient", "ms", "coefficient")), number_column("r2", "", "R²"),
                  whole_column("points", "", "points"), whole_column("x_from", growths.unit, growths.axis + " from"),
                  whole_column("x_to", growths.unit, "to"), number_column("ms_from", "ms", "time from"),
                  number_column("ms_to", "ms", "to"), for_programs(text_column("why_not", "why not"))});
  return columns;
}

Cells cells_of(const Growth& growth) {
  Cells cells = place_cells(growth.place);
  const std::optional<ValueWithInterval>& e = growth.exponent;
  const auto fixed = [](double value) { return fmt::format("{:.2f}", std::abs(value) < 0.005 ? 0.0 : value); };  // never -0.00
  const Growth::Point &first = growth.points.front(), &last = growth.points.back();
  cells.insert(
      cells.end(),
      {text_cell(growth.setting), text_cell(growth.stage),
       e ? Cell{.value = e->value, .shown = fixed(e->value)} : Cell{.shown = growth.why_not},
       text_cell(e && e->has_interval ? fixed(e->low) + " .. " + fixed(e->high) : "-"), end(e, &ValueWithInterval::low),
       end(e, &ValueWithInterval::high), e ? Cell{.value = growth.coefficient} : Cell{},
       e ? Cell{.value = growth.r2, .shown = fmt::format("{:.3f}", growth.r2)} : Cell{},
       Cell{.value = static_cast<double>(growth.points.size())}, Cell{.value = first.x}, Cell{.value = last.x},
       Cell{.value = first.ms.value}, Cell{.value = last.ms.value}, text_cell(growth.why_not)});
  return cells;
}

}  // namespace

Tables growth_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const Growths growths = find_growth(records, options.x.empty() ? "triangles" : options.x);
  Layout table;
  table.title = fmt::format("Growth of cost with {}: time = coefficient * {}^exponent", growths.axis, growths.axis);
  table.columns = columns_of(growths);
  add_groups(table, growths.rows, &Growth::place, cells_of);
  table.notes = {fmt::format("exponent: slope of the least-squares line through log time and log {}", growths.axis),
                 interval_note,
                 fmt::format("too few points: below {} different {}; below the clock: faster than {} ms", least_points,
                             growths.axis, exact(clock_ms))};
  if (std::ranges::none_of(growths.rows, [](const Growth& growth) { return growth.exponent.has_value(); }))
    table.notes.push_back(
        fmt::format("no row has an exponent: {} or more different {} make a line", least_points, growths.axis));
  if (growths.axis == "lights") table.notes.emplace_back("total: build once, relight and resolve for every light");
  if (growths.single > 0)
    table.notes.push_back(fmt::format("{} series with a single value of {} are left out", growths.single, growths.axis));
  return {table};
}

}  // namespace gnomon::analysis
