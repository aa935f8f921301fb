#include <algorithm>
#include <cmath>
#include <numeric>

#include "measure/counted.h"
#include "report/analysis/analysis_table_fields.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

/// `is_mixed`: there are fields of both kinds of lights.
std::string field_heading(const Field& field, std::span<const Place> places, bool is_mixed) {
  const std::string constant = field.constant ? fmt::format("; {}", constant_text(*field.constant)) : "";
  if (field.place) return title(*field.place, places) + constant;
  const std::string which = field.places == field.all_places ? fmt::format("all {}", field.places)
                                                             : fmt::format("those {} of {}", field.places, field.all_places);
  return fmt::format("over {} places{} that these settings finished: mean error, geometric mean cost{}", which,
                     is_mixed ? fmt::format(" under {}", lights_text(field.answer)) : "", constant);
}

}  // namespace

Column cost_column(Cost cost) {
  Column column = quantity_column(cost == Cost::bytes ? "bytes" : "resolve_ms");
  column.name = cost == Cost::bytes ? "bytes" : "cost_ms";
  column.heading = std::string(sentence(cost));
  return column;
}

bool has_floor(std::span<const Field> fields) {
  const auto is_floored = [](const Candidate& c) { return c.floor.has_value(); };
  return std::ranges::any_of(fields, [&](const Field& field) { return std::ranges::any_of(field.candidates, is_floored); });
}

void add_error_columns(std::vector<Column>& columns, const Column& error, std::span<const Field> fields) {
  columns.push_back(error);
  if (has_floor(fields)) columns.push_back(spare(quantity_column(error.name + "_floor"), 4));
  columns.push_back(for_programs(quantity_column(std::string(constant_metric(error.name)))));
}

void add_error_cells(Cells& cells, const Field& field, const Candidate* candidate, bool with_floor) {
  cells.push_back(candidate ? Cell{.value = candidate->error} : Cell{});
  if (with_floor) cells.push_back(candidate && candidate->floor ? Cell{.value = *candidate->floor} : Cell{});
  cells.push_back(field.constant ? Cell{.value = *field.constant} : Cell{});
}

void add_error_notes(Layout& table, const Column& error, std::span<const Field> fields) {
  if (has_floor(fields))
    table.notes.push_back(fmt::format("{}: {}", quantity_column(error.name + "_floor").heading, floor_note));
  if (std::ranges::any_of(fields, [](const Field& field) { return field.constant.has_value(); }))
    table.notes.push_back(fmt::format("best constant mask: {}", constant_note));
}

Layout table_of(std::span<const Field> fields, std::string title, std::vector<Column> columns) {
  Layout table{.title = std::move(title), .columns = std::move(columns)};
  std::vector<Place> places;
  for (const Field& field : fields)
    if (field.place) places.push_back(*field.place);
  const bool is_mixed = std::ranges::any_of(fields, [&](const Field& field) { return field.answer != fields.front().answer; });
  for (const Field& field : fields) {
    table.groups.push_back({.heading = field_heading(field, places, is_mixed)});
    table.notes.insert(table.notes.end(), field.notes.begin(), field.notes.end());
  }
  return table;
}

std::vector<Field> fields_of(std::span<const Record> records, const AnalysisOptions& options) {
  std::vector<Field> fields = find_fields(records, {.error = options.metric, .cost = options.cost});
  if (!options.over_all) return fields;
  std::vector<Field> chosen;
  for (const Field* field : overall_fields(fields)) chosen.push_back(*field);
  return chosen;
}

std::string error_budget_text(const Column& error, double budget, std::string_view direction) {
  return fmt::format("{} {} {}{}{}", error.heading, direction == "higher" ? "≥" : "≤", exact(budget * error.shown_scale),
                     error.shown_unit.empty() ? "" : " ", error.shown_unit);
}

namespace {

/// Candidates by cost, those without one last.
std::vector<std::size_t> order_by_cost(const Field& field) {
  std::vector<std::size_t> order(field.candidates.size());
  std::iota(order.begin(), order.end(), 0);
  const auto cost_of = [&](std::size_t i) { return field.candidates[i].cost ? field.candidates[i].cost->value : INFINITY; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost_of(a) < cost_of(b); });
  return order;
}

std::vector<Column> front_columns(const Column& error, const Column& cost, std::span<const Field> fields) {
  std::vector<Column> columns = place_columns();
  columns.insert(columns.end(), {text_column("setting", "technique"), for_programs(text_column("role", "role"))});
  add_error_columns(columns, error, fields);
  columns.insert(columns.end(),
                 {cost, spare(for_people(text_column("cost_interval", "interval")), 3),
                  for_programs(number_column("cost_low", cost.unit, "cost_low")),
                  for_programs(number_column("cost_high", cost.unit, "cost_high")),
                  spare(number_column("relative_cost", "", "relative"), 2), spare(text_column("standing", "standing"), 1),
                  for_programs(text_column("beaten_by", "beaten by"))});
  return columns;
}

/// "front", "beaten (SETTING)"; of those that do not compete why: "constant", "reference", "baseline", "no cost".
std::string standing_text(const Candidate& candidate, const FrontEntry& stand) {
  if (stand.standing == Standing::aside)
    return candidate.role == Role::contender ? "no cost" : std::string(name(candidate.role));
  const std::string_view standing = name(stand.standing);
  return stand.beaten_by.empty() ? std::string(standing) : fmt::format("{} ({})", standing, stand.beaten_by);
}

Cells front_cells(const Field& field, const Candidate& c, const FrontEntry& stand, const Column& cost, bool with_floor) {
  Cells cells = place_cells(field.place);
  cells.insert(cells.end(), {text_cell(c.setting), text_cell(name(c.role))});
  add_error_cells(cells, field, &c, with_floor);
  cells.insert(cells.end(), {value_of(c.cost), text_cell(c.cost ? interval_text(cost, *c.cost) : "-"),
                             end(c.cost, &ValueWithInterval::low), end(c.cost, &ValueWithInterval::high),
                             c.cost && c.relative_cost.value > 0 ? Cell{.value = c.relative_cost.value} : Cell{},
                             shown_text(name(stand.standing), standing_text(c, stand)), text_cell(stand.beaten_by)});
  return cells;
}

/// What `best` limits and shows: the columns of its quantities.
struct BestColumns {
  Column error, time, bytes;
};

/// The budgets of the options, in the units of records; round ones where there are none. Throws Error where there is no budget
/// at all.
Budgets budgets_of(const AnalysisOptions& options, const BestColumns& columns, std::span<const Field> fields) {
  const auto is_empty = [](const Budgets& b) { return b.times.empty() && b.memories.empty() && b.errors.empty(); };
  Budgets budgets{options.times, options.memories, options.errors};
  for (double& memory : budgets.memories) memory /= columns.bytes.shown_scale;
  for (double& error : budgets.errors) error /= columns.error.shown_scale;
  if (is_empty(budgets)) budgets = round_budgets(fields);
  const auto may_be_best = [](const Field& field) { return std::ranges::any_of(field.candidates, &Candidate::may_be_best); };
  if (is_empty(budgets) && std::ranges::none_of(fields, may_be_best))
    throw Error("there is nothing to rank: no contender beats the best constant mask");
  if (is_empty(budgets))
    throw Error("there is nothing to rank: no contender has a time, a memory or a {} above 0", options.metric);
  return budgets;
}

std::vector<Column> best_columns(const AnalysisOptions& options, const BestColumns& of, std::span<const Field> fields) {
  std::vector<Column> columns = place_columns();
  columns.insert(columns.end(),
                 {for_programs(text_column("limited", "limited")), for_programs(number_column("budget", "", "budget")),
                  for_people(text_column("at", "at")), text_column("setting", "best")});
  add_error_columns(columns, of.error, fields);
  columns.insert(columns.end(),
                 {spare(cost_column(options.cost), 1), spare(of.bytes, 2), spare(text_column("also", "as good"), 3)});
  return columns;
}

/// "error ≤ 0.5 %", "time ≤ 2 ms".
std::string budget_text(const Best& best, const BestColumns& columns, std::string_view direction) {
  if (best.what == "error") return error_budget_text(columns.error, best.budget, direction);
  const Column& limited = best.what == "time" ? columns.time : columns.bytes;
  return fmt::format("{} ≤ {} {}", best.what, exact(best.budget * limited.shown_scale), limited.shown_unit);
}

Cells best_cells(const Field& field, const Best& best, const BestColumns& columns, std::string_view direction,
                 bool with_floor) {
  Cells cells = place_cells(field.place);
  cells.insert(cells.end(),
               {text_cell(best.what), Cell{.value = best.budget}, text_cell(budget_text(best, columns, direction))});
  if (!best.winner) {
    cells.push_back({.shown = "none"});
    add_error_cells(cells, field, nullptr, with_floor);
    cells.resize(cells.size() + 3);
    return cells;
  }
  const Candidate& winner = field.candidates[*best.winner];
  std::vector<std::string> also;
  for (const std::size_t i : best.also) also.push_back(field.candidates[i].setting);
  const std::string all = joined(also, "; ");
  cells.push_back(text_cell(winner.setting));
  add_error_cells(cells, field, &winner, with_floor);
  cells.insert(cells.end(),
               {value_of(winner.time), winner.bytes ? Cell{.value = *winner.bytes} : Cell{},
                also.empty() ? Cell{} : shown_text(all, also.size() > 3 ? fmt::format("{} others", also.size()) : all)});
  return cells;
}

}  // namespace

Tables front_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  const std::vector<Field> fields = fields_of(records, options);
  const Column cost = cost_column(options.cost), error = quantity_column(options.metric);
  const bool with_floor = has_floor(fields);
  Layout table = table_of(fields, fmt::format("Front of {} against {}", with_unit(error), sentence(options.cost)),
                          front_columns(error, cost, fields));
  std::size_t hidden = 0;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    const std::vector<FrontEntry> stands = find_front(fields[k], better(options.metric));
    for (const std::size_t i : order_by_cost(fields[k])) {
      const bool is_behind = stands[i].standing == Standing::beaten || stands[i].standing == Standing::constant;
      if (options.all || !is_behind)
        table.groups[k].rows.push_back({.cells = front_cells(fields[k], fields[k].candidates[i], stands[i], cost, with_floor)});
      else
        ++hidden;
    }
  }
  table.notes.insert(table.notes.end(), {"front: no contender is at least as good in both and better in one",
                                         "unclear: beaten by value, but the costs are not told apart",
                                         "constant: errs as much as the best constant mask, or more",
                                         "relative: cost over that of the cheapest contender of the group"});
  if (options.cost != Cost::bytes) table.notes.emplace_back(interval_note);
  add_error_notes(table, error, fields);
  if (hidden > 0)
    table.notes.push_back(
        counted(hidden, "setting{s} that {is|are} beaten or constant {is|are} not shown; --all shows {it|them}"));
  return {table};
}

Tables best_tables(std::span<const Record> records, const AnalysisOptions& options, Format) {
  if (options.cost == Cost::bytes)
    throw Error(
        "--cost bytes is for front; best takes resolve, light, geometry or motion, and budgets of memory by --memories");
  const std::vector<Field> fields = fields_of(records, options);
  const BestColumns columns{quantity_column(options.metric), quantity_column("resolve_ms"), quantity_column("bytes")};
  const bool with_floor = has_floor(fields);
  const Budgets budgets = budgets_of(options, columns, fields);
  const std::string_view direction = better(options.metric);
  Layout table = table_of(fields,
                          fmt::format("Best contender at equal time, equal memory and equal error: {} against {}",
                                      with_unit(columns.error), sentence(options.cost)),
                          best_columns(options, columns, fields));
  for (std::size_t k = 0; k < fields.size(); ++k)
    for (const Best& best : find_best(fields[k], budgets, direction))
      table.groups[k].rows.push_back({.cells = best_cells(fields[k], best, columns, direction, with_floor)});
  table.notes.emplace_back(
      "at equal time and memory the lowest error within the budget, at equal error the lowest time; as good: the same error, "
      "or a time that is not told apart from the winner's");
  add_error_notes(table, columns.error, fields);
  return {table};
}

}  // namespace gnomon::analysis
