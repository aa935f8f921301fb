#include "analysis/forecast.h"
#include "analysis/growth.h"
#include "report/analysis/analysis_table_fields.h"

namespace gnomon::analysis {

namespace {

/// The column of the cost under another name.
Column cost_named_as(const Column& cost, std::string name, std::string heading) {
  Column column = cost;
  column.name = std::move(name);
  column.heading = std::move(heading);
  return column;
}

std::vector<Column> forecast_columns(const Forecasts& found, const Column& cost) {
  const std::string at = fmt::format("at {}", found.to);
  std::vector<Column> columns = place_columns();
  columns.insert(
      columns.end(),
      {text_column("setting", "technique"), for_programs(text_column("role", "role")),
       spare(whole_column("points", "", "points"), 5), spare(whole_column("x_from", found.unit, found.axis + " from"), 4),
       whole_column("x_to", found.unit, "to"), cost_named_as(cost, "last", "measured there"),
       spare(cost_named_as(cost, "fixed", "fixed"), 3), spare(cost_named_as(cost, "each", "each"), 2),
       for_programs(number_column("x_forecast", found.unit, "x_forecast")),
       cost_named_as(cost, "forecast", at + ", extrapolated"),
       spare(for_people(text_column("forecast_interval", "interval")), 1),
       for_programs(cost_named_as(cost, "forecast_low", "low")), for_programs(cost_named_as(cost, "forecast_high", "high")),
       spare(for_people(text_column("foretold_interval", "measured, foretold")), 6),
       for_programs(cost_named_as(cost, "foretold", "foretold")),
       for_programs(cost_named_as(cost, "foretold_low", "foretold_low")),
       for_programs(cost_named_as(cost, "foretold_high", "foretold_high")),
       for_programs(text_column("is_foretold", "is_foretold")), for_programs(text_column("why_not", "why not"))});
  return columns;
}

Cells forecast_cells(const Forecast& one, double to, const Column& cost) {
  Cells cells = place_cells(one.place);
  const auto& value = one.value;
  const std::string foretold =
      one.foretold ? fmt::format("{}{}", interval_text(cost, *one.foretold), one.is_foretold() ? "" : ", missed") : "-";
  cells.insert(
      cells.end(),
      {text_cell(one.setting), text_cell(name(one.role)), Cell{.value = static_cast<double>(one.xs.size())},
       Cell{.value = one.xs.front()}, Cell{.value = one.xs.back()}, Cell{.value = one.last.value},
       value ? Cell{.value = one.fixed} : Cell{}, value ? Cell{.value = one.each} : Cell{}, Cell{.value = to},
       value ? Cell{.value = value->value} : Cell{.shown = one.why_not}, text_cell(value ? interval_text(cost, *value) : "-"),
       end(value, &ValueWithInterval::low), end(value, &ValueWithInterval::high), text_cell(foretold), value_of(one.foretold),
       end(one.foretold, &ValueWithInterval::low), end(one.foretold, &ValueWithInterval::high),
       text_cell(!one.foretold       ? ""
                 : one.is_foretold() ? "yes"
                                     : "no"),
       text_cell(one.why_not)});
  return cells;
}

}  // namespace

Tables forecast_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const std::string axis = options.x.empty() ? "lights" : options.x;
  const Forecasts found =
      find_forecasts(records, axis, options.cost, options.to > 0 ? std::optional(options.to) : std::nullopt);
  const Column cost = cost_column(options.cost);
  Layout table;
  table.title = fmt::format("Forecast of {} with {}: fixed + each * {}, extrapolated to {}", sentence(options.cost), axis, axis,
                            found.to);
  table.columns = forecast_columns(found, cost);
  add_groups(table, found.rows, &Forecast::place, [&](const Forecast& one) { return forecast_cells(one, found.to, cost); });
  std::size_t tried = 0, held = 0;
  for (const Forecast& one : found.rows) {
    tried += one.foretold.has_value();
    held += one.is_foretold();
  }
  table.notes = {"extrapolated: nothing was measured there; by the line of least relative squares through what was",
                 "interval: 95 %, of one more row; it holds the spread of processes, and how far rows lie from a line",
                 "measured, foretold: the interval that the rows before the last one foretell the last one by"};
  if (tried > 0)
    table.notes.push_back(fmt::format("{} of {} forecasts of what was measured hold it in their intervals", held, tried));
  table.notes.push_back(fmt::format("too few points: below {} different {}{}", least_points, axis,
                                    options.cost == Cost::bytes
                                        ? "; no cost: a row without bytes"
                                        : fmt::format("; below the clock: faster than {} ms", clock_ms)));
  if (found.single > 0)
    table.notes.push_back(fmt::format("{} series with a single value of {} are left out", found.single, axis));
  return {std::move(table)};
}

}  // namespace gnomon::analysis
