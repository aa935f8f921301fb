#include <algorithm>
#include <cmath>
#include <numeric>

#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

std::string field_heading(const Field& field, std::span<const Place> places) {
  if (field.place) return title(*field.place, places);
  return fmt::format("over all {} places that these settings finished: mean error, geometric mean cost", field.places);
}

std::vector<Place> places_of(std::span<const Field> fields) {
  std::vector<Place> places;
  for (const Field& field : fields)
    if (field.place) places.push_back(*field.place);
  return places;
}

/// The column of a cost in milliseconds or bytes.
Column cost_column(Cost cost) {
  Column column = quantity_column(cost == Cost::bytes ? "bytes" : "resolve_ms");
  column.name = cost == Cost::bytes ? "bytes" : "cost_ms";
  column.heading = std::string(sentence(cost));
  return column;
}

/// Candidates by cost, those without one last.
std::vector<std::size_t> order_by_cost(const Field& field) {
  std::vector<std::size_t> order(field.candidates.size());
  std::iota(order.begin(), order.end(), 0);
  const auto cost_of = [&](std::size_t i) { return field.candidates[i].cost ? field.candidates[i].cost->value : INFINITY; };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost_of(a) < cost_of(b); });
  return order;
}

void add_front_heads(Grid& grid, const AnalysisOptions& options, const Column& cost) {
  add_place_heads(grid);
  grid.heads.push_back(words("setting", "technique"));
  grid.heads.push_back(words("role", "role", Audience::programs));
  grid.heads.push_back(of_quantity(options.metric));
  grid.heads.push_back({cost, Audience::all});
  grid.heads.push_back(words("cost_interval", "interval", Audience::people));
  for (const char* one : {"cost_low", "cost_high"})
    grid.heads.push_back(number(one, std::string(unit(options.cost)), one, Audience::programs));
  grid.heads.push_back(number("relative_cost", "", "relative"));
  grid.heads.push_back(words("standing", "standing"));
  grid.heads.push_back(words("beaten_by", "beaten by", Audience::programs));
}

/// "front", "beaten (SETTING)"; of those that do not compete why: "reference", "baseline", "no cost".
std::string standing_text(const Candidate& candidate, const FrontEntry& stand) {
  if (stand.standing == Standing::aside)
    return candidate.role == Role::contender ? "no cost" : std::string(name(candidate.role));
  const std::string_view standing = name(stand.standing);
  return stand.beaten_by.empty() ? std::string(standing) : fmt::format("{} ({})", standing, stand.beaten_by);
}

Entries front_row(const Field& field, const Candidate& c, const FrontEntry& stand, const Column& cost) {
  Entries row;
  add_place(row, field.place);
  row.push_back({text(c.setting)});
  row.push_back({text(std::string(name(c.role)))});
  row.push_back({{.value = c.error}});
  row.push_back({value_of(c.cost)});
  row.push_back({text(c.cost ? interval_text(cost, *c.cost) : "-")});
  for (const auto which : {&ValueWithInterval::low, &ValueWithInterval::high}) row.push_back({end(c.cost, which)});
  row.push_back({c.cost && c.relative_cost.value > 0 ? Cell{.value = c.relative_cost.value} : Cell{}});
  row.push_back({shown_text(std::string(name(stand.standing)), standing_text(c, stand))});
  row.push_back({text(stand.beaten_by)});
  return row;
}

}  // namespace

Grid front_grid(std::span<const Record> records, const AnalysisOptions& options) {
  const std::vector<Field> fields = find_fields(records, {.error = options.metric, .cost = options.cost});
  const std::vector<Place> places = places_of(fields);
  const Column cost = cost_column(options.cost);
  Grid grid;
  grid.title = fmt::format("Front of {} against {}", with_unit(options.metric), sentence(options.cost));
  add_front_heads(grid, options, cost);
  std::size_t hidden = 0;
  for (const Field& field : fields) {
    Grid::Group group{.heading = field_heading(field, places), .rows = {}};
    const std::vector<FrontEntry> stands = find_front(field, better(options.metric));
    for (const std::size_t i : order_by_cost(field)) {
      if (options.all || stands[i].standing != Standing::beaten)
        group.rows.push_back(front_row(field, field.candidates[i], stands[i], cost));
      else
        ++hidden;
    }
    grid.notes.insert(grid.notes.end(), field.notes.begin(), field.notes.end());
    grid.groups.push_back(std::move(group));
  }
  grid.notes.emplace_back("front: no contender is at least as good in both and better in one");
  grid.notes.emplace_back("unclear: beaten by value, but the intervals of the costs overlap");
  grid.notes.emplace_back("relative: cost over that of the cheapest contender of the group");
  if (options.cost != Cost::bytes) grid.notes.emplace_back(interval_note);
  if (hidden > 0) grid.notes.push_back(fmt::format("{} beaten settings are not shown; --all shows them", hidden));
  return grid;
}

namespace {

/// What `best` limits and shows: the columns of its quantities.
struct BestColumns {
  Column error, time, bytes;
};

/// The budgets that were asked for, in the units of records; round ones where none was. Throws Error where there is none at
/// all.
Budgets budgets_of(const AnalysisOptions& options, const BestColumns& columns, std::span<const Field> fields) {
  const auto is_empty = [](const Budgets& b) { return b.times.empty() && b.memories.empty() && b.errors.empty(); };
  Budgets budgets{options.times, options.memories, options.errors};
  for (double& memory : budgets.memories) memory /= columns.bytes.shown_scale;
  for (double& error : budgets.errors) error /= columns.error.shown_scale;
  if (is_empty(budgets)) budgets = round_budgets(fields);
  if (is_empty(budgets))
    throw Error("there is nothing to rank: no contender has a time, a memory or a {} above 0", options.metric);
  return budgets;
}

void add_best_heads(Grid& grid, const AnalysisOptions& options, const BestColumns& columns) {
  add_place_heads(grid);
  grid.heads.push_back(words("limited", "limited", Audience::programs));
  grid.heads.push_back(number("budget", "", "budget", Audience::programs));
  grid.heads.push_back(words("at", "at", Audience::people));
  grid.heads.push_back(words("setting", "best"));
  grid.heads.push_back({columns.error, Audience::all});
  grid.heads.push_back({cost_column(options.cost), Audience::all});
  grid.heads.push_back({columns.bytes, Audience::all});
  grid.heads.push_back(words("also", "as good"));
}

/// "wrong ≤ 0.5 %", "time ≤ 2 ms".
std::string budget_text(const Best& best, const BestColumns& columns, std::string_view direction) {
  const bool is_error = best.what == "error";
  const Column& limited = is_error ? columns.error : best.what == "time" ? columns.time : columns.bytes;
  return fmt::format("{} {} {}{}{}", is_error ? limited.heading : best.what, is_error && direction == "higher" ? "≥" : "≤",
                     exact(best.budget * limited.shown_scale), limited.shown_unit.empty() ? "" : " ", limited.shown_unit);
}

Entries best_row(const Field& field, const Best& best, const BestColumns& columns, std::string_view direction) {
  Entries row;
  add_place(row, field.place);
  row.push_back({text(best.what)});
  row.push_back({{.value = best.budget}});
  row.push_back({text(budget_text(best, columns, direction))});
  if (!best.winner) {
    row.push_back({Cell{.value = {}, .shown = "none"}});
    row.resize(row.size() + 4);
    return row;
  }
  const Candidate& winner = field.candidates[*best.winner];
  row.push_back({text(winner.setting)});
  row.push_back({{.value = winner.error}});
  row.push_back({value_of(winner.time)});
  row.push_back({winner.bytes ? Cell{.value = *winner.bytes} : Cell{}});
  std::vector<std::string> also;
  for (const std::size_t i : best.also) also.push_back(field.candidates[i].setting);
  const std::string all = joined(also, "; ");
  const bool is_long = also.size() > 3;
  row.push_back({also.empty() ? Cell{} : shown_text(all, is_long ? fmt::format("{} others", also.size()) : all)});
  return row;
}

}  // namespace

Grid best_grid(std::span<const Record> records, const AnalysisOptions& options) {
  if (options.cost == Cost::bytes)
    throw Error("--cost bytes is for front; best takes resolve, light or geometry, and budgets of memory by --memories");
  const std::vector<Field> fields = find_fields(records, {.error = options.metric, .cost = options.cost});
  const std::vector<Place> places = places_of(fields);
  const BestColumns columns{quantity_column(options.metric), quantity_column("resolve_ms"), quantity_column("bytes")};
  const Budgets budgets = budgets_of(options, columns, fields);
  const std::string_view direction = better(options.metric);
  Grid grid;
  grid.title = fmt::format("Best contender at equal time, equal memory and equal error: {} against {}",
                           with_unit(options.metric), sentence(options.cost));
  add_best_heads(grid, options, columns);
  for (const Field& field : fields) {
    Grid::Group group{.heading = field_heading(field, places), .rows = {}};
    for (const Best& best : find_best(field, budgets, direction))
      group.rows.push_back(best_row(field, best, columns, direction));
    grid.notes.insert(grid.notes.end(), field.notes.begin(), field.notes.end());
    grid.groups.push_back(std::move(group));
  }
  grid.notes.emplace_back(
      "at equal time and memory the lowest error within the budget, at equal error the lowest time; as good: the same error, "
      "or a time whose interval overlaps");
  return grid;
}

}  // namespace gnomon::analysis
