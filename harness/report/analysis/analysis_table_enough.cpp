#include <cmath>

#include "analysis/enough.h"
#include "report/analysis/analysis_table_fields.h"

namespace gnomon::analysis {

namespace {

/// What people ask for where they name no error: 1 %, 0.5 % and 0.1 %, and of what is no share round numbers.
std::vector<double> asked_errors(const AnalysisOptions& options, const Column& error, std::span<const Field> fields) {
  std::vector<double> budgets = options.errors;
  if (budgets.empty() && error.shown_unit == "%") budgets = {1, 0.5, 0.1};
  if (budgets.empty()) budgets = round_budgets(fields).errors;
  if (budgets.empty()) throw Error("there is nothing to ask for: no contender has a {} above 0; name --errors", options.metric);
  if (options.errors.empty() && error.shown_unit != "%") return budgets;
  for (double& budget : budgets) budget /= error.shown_scale;
  return budgets;
}

/// What is paid with, and whether errors have a floor.
struct PaidColumns {
  Column time, bytes;
  bool with_floor;  ///< whether errors have one
};

std::vector<Column> enough_columns(const Column& error, const PaidColumns& paid, std::span<const Field> fields) {
  std::vector<Column> columns = place_columns();
  columns.insert(columns.end(), {for_programs(number_column("budget", "", "budget")), for_people(text_column("at", "at")),
                                 text_column("technique", "technique"), for_programs(text_column("role", "role")),
                                 spare(text_column("setting", "cheapest setting"), 3)});
  add_error_columns(columns, error, fields);
  columns.insert(columns.end(), {paid.time, spare(for_people(text_column("cost_interval", "interval")), 2),
                                 for_programs(number_column("cost_low", paid.time.unit, "cost_low")),
                                 for_programs(number_column("cost_high", paid.time.unit, "cost_high")), spare(paid.bytes, 4),
                                 spare(number_column("relative_cost", "", "relative"), 1)});
  return columns;
}

Cells enough_cells(const Field& field, const Enough& enough, const Column& error, const PaidColumns& paid,
                   std::string_view direction, double least_cost) {
  const Candidate& shown_one = field.candidates[enough.setting.value_or(enough.least)];
  Cells cells = place_cells(field.place);
  cells.insert(cells.end(), {Cell{.value = enough.budget}, text_cell(error_budget_text(error, enough.budget, direction)),
                             text_cell(enough.technique), text_cell(name(shown_one.role)),
                             enough.setting ? text_cell(shown_one.setting) : Cell{.shown = "none"}});
  add_error_cells(cells, field, &shown_one, paid.with_floor);
  if (!enough.setting) {
    cells.resize(cells.size() + 6);
    return cells;
  }
  const auto& time = shown_one.time;
  cells.insert(cells.end(),
               {value_of(time), text_cell(time ? interval_text(paid.time, *time) : "-"), end(time, &ValueWithInterval::low),
                end(time, &ValueWithInterval::high), shown_one.bytes ? Cell{.value = *shown_one.bytes} : Cell{},
                least_cost > 0 ? Cell{.value = shown_one.cost->value / least_cost} : Cell{}});
  return cells;
}

}  // namespace

Tables enough_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const std::vector<Field> fields = fields_of(records, options);
  const Column error = quantity_column(options.metric);
  const bool is_by_bytes = options.cost == Cost::bytes;
  const Cost timed = is_by_bytes ? Cost::light : options.cost;
  const PaidColumns paid{cost_column(timed), quantity_column("bytes"), has_floor(fields)};
  const std::vector<double> budgets = asked_errors(options, error, fields);
  Layout table = table_of(fields,
                          fmt::format("What each technique pays for an error: {} against {}", with_unit(error),
                                      is_by_bytes ? "memory" : sentence(timed)),
                          enough_columns(error, paid, fields));
  for (std::size_t k = 0; k < fields.size(); ++k) {
    double budget = NAN, least_cost = 0;
    for (const Enough& enough : find_enough(fields[k], budgets, better(options.metric))) {
      if (enough.budget != budget) {  // the first of a budget is the cheapest
        budget = enough.budget;
        least_cost = enough.setting ? fields[k].candidates[*enough.setting].cost->value : 0;
      }
      table.groups[k].rows.push_back(
          {.cells = enough_cells(fields[k], enough, error, paid, better(options.metric), least_cost)});
    }
  }
  table.notes.push_back(
      fmt::format("cheapest setting: of the technique's settings here that err no more, the one with the least {}; "
                  "none: none errs so little, and the error is its least",
                  is_by_bytes ? "memory" : sentence(timed)));
  table.notes.emplace_back("relative: over what the cheapest technique pays");
  table.notes.emplace_back(interval_note);
  add_error_notes(table, error, fields);
  return {std::move(table)};
}

}  // namespace gnomon::analysis
