#include <cmath>

#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

/// Of the first and the last point: times, or the quantity.
std::vector<Column> value_columns(const Growths& growths) {
  if (growths.quantity.empty()) return {number_column("ms_from", "ms", "time from"), number_column("ms_to", "ms", "to")};
  Column from = quantity_column(growths.quantity), to = from;
  from.name += "_from";
  from.heading += " from";
  to.name += "_to";
  to.heading = "to";
  return {from, to};
}

std::vector<Column> columns_of(const Growths& growths) {
  const bool is_time = growths.quantity.empty();
  std::vector<Column> columns = place_columns();
  const Column stage = text_column(is_time ? "stage" : "quantity", is_time ? "stage" : "quantity");
  columns.insert(columns.end(),
                 {text_column("setting", "technique"), is_time ? stage : for_programs(stage),
                  number_column("exponent", "", "exponent"), spare(for_people(text_column("exponent_interval", "interval")), 1),
                  for_programs(number_column("exponent_low", "", "exponent_low")),
                  for_programs(number_column("exponent_high", "", "exponent_high")),
                  spare(for_people(text_column("local_slopes", "from point to point")), 5),
                  for_programs(number_column("slope_least", "", "slope_least")),
                  for_programs(number_column("slope_greatest", "", "slope_greatest")),
                  spare(number_column("slope_upper", "", "upper half"), 4),
                  for_programs(number_column("coefficient", is_time ? "ms" : "", "coefficient")),
                  for_programs(number_column("r2", "", "R²")), spare(whole_column("points", "", "points"), 6)});
  if (!is_time) columns.push_back(spare(whole_column("rows", "", "rows"), 7));
  columns.insert(columns.end(), {spare(whole_column("x_from", growths.unit, growths.axis + " from"), 3),
                                 spare(whole_column("x_to", growths.unit, "to"), 3)});
  for (Column& column : value_columns(growths)) columns.push_back(spare(std::move(column), 2));
  columns.push_back(for_programs(text_column("why_not", "why not")));
  return columns;
}

Cells cells_of(const Growth& growth, bool with_rows) {
  Cells cells = place_cells(growth.place);
  const std::optional<ValueWithInterval>& e = growth.exponent;
  const auto fixed = [](double value) { return fmt::format("{:.2f}", std::abs(value) < 0.005 ? 0.0 : value); };  // never -0.00
  const Growth::Point &first = growth.points.front(), &last = growth.points.back();
  cells.insert(cells.end(), {text_cell(growth.setting), text_cell(growth.stage),
                             e ? Cell{.value = e->value, .shown = fixed(e->value)} : Cell{.shown = growth.why_not},
                             text_cell(e && e->has_interval ? fixed(e->low) + " .. " + fixed(e->high) : "-"),
                             end(e, &ValueWithInterval::low), end(e, &ValueWithInterval::high),
                             text_cell(e ? fixed(growth.least_slope) + " .. " + fixed(growth.greatest_slope) : "-"),
                             e ? Cell{.value = growth.least_slope} : Cell{}, e ? Cell{.value = growth.greatest_slope} : Cell{},
                             e ? Cell{.value = growth.upper_slope, .shown = fixed(growth.upper_slope)} : Cell{},
                             e ? Cell{.value = growth.coefficient} : Cell{},
                             e ? Cell{.value = growth.r2, .shown = fmt::format("{:.3f}", growth.r2)} : Cell{},
                             Cell{.value = static_cast<double>(growth.points.size())}});
  if (with_rows) {
    std::size_t rows = 0;
    for (const Growth::Point& point : growth.points) rows += point.rows;
    cells.push_back(Cell{.value = static_cast<double>(rows)});
  }
  cells.insert(cells.end(), {Cell{.value = first.x}, Cell{.value = last.x}, Cell{.value = first.value.value},
                             Cell{.value = last.value.value}, text_cell(growth.why_not)});
  return cells;
}

/// What the words of a table mean.
std::vector<std::string> notes_of(const Growths& growths) {
  const char* what = growths.quantity.empty() ? "time" : growths.quantity.c_str();
  std::vector<std::string> notes = {
      fmt::format("exponent: slope of the least-squares line through log {} and log {}", what, growths.axis)};
  notes.emplace_back("interval: 95 %, of the spread of processes and of how far the points lie from the line");
  notes.emplace_back("from point to point: the least and the greatest slope between neighbors");
  notes.emplace_back("upper half: the slope of the line through the upper half of the points");
  const std::string too_few = fmt::format("too few points: below {} different {}", least_points, growths.axis);
  if (growths.quantity.empty()) {
    notes.push_back(fmt::format("{}; below the clock: faster than {} ms", too_few, exact(clock_ms)));
    return notes;
  }
  notes.emplace_back("a point is the median of rows that differ in their seed alone, which are what the bootstrap draws");
  notes.push_back(too_few);
  const bool has_least = std::ranges::any_of(growths.rows, [](const Growth& growth) {
    return std::ranges::any_of(growth.points, [](const Growth::Point& point) { return point.least > 0; });
  });
  if (has_least)
    notes.back() += fmt::format("; below the reference: less than {} times what its noise makes, left out of the line",
                                exact(least_reference_errors));
  return notes;
}

}  // namespace

Tables growth_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const Growths growths = find_growth(records, options.x.empty() ? "triangles" : options.x, options.growing);
  const bool is_time = growths.quantity.empty();
  Layout table;
  table.title = fmt::format("Growth of {} with {}: {} = coefficient * {}^exponent", is_time ? "cost" : growths.quantity,
                            growths.axis, is_time ? "time" : growths.quantity, growths.axis);
  table.columns = columns_of(growths);
  add_groups(table, growths.rows, &Growth::place, [&](const Growth& growth) { return cells_of(growth, !is_time); });
  table.notes = notes_of(growths);
  if (std::ranges::none_of(growths.rows, [](const Growth& growth) { return growth.exponent.has_value(); }))
    table.notes.push_back(
        fmt::format("no row has an exponent: {} or more different {} make a line", least_points, growths.axis));
  if (growths.axis == "lights") table.notes.emplace_back("total: build once, relight and resolve for every light");
  if (growths.single > 0)
    table.notes.push_back(fmt::format("{} series with a single value of {} are left out", growths.single, growths.axis));
  return {table};
}

}  // namespace gnomon::analysis
