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

}  // namespace

Grid front_grid(std::span<const Record> records, const AnalysisOptions& options) {
  const std::vector<Field> fields = find_fields(records, {.error = options.metric, .cost = options.cost});
  const std::vector<Place> places = places_of(fields);
  const Column cost_column = quantity_column(options.cost == Cost::bytes ? "bytes" : "resolve_ms");
  Grid grid;
  grid.title = fmt::format("Front of {} against {}", with_unit(options.metric), sentence(options.cost));
  add_place_heads(grid);
  grid.heads.push_back(words("setting", "technique"));
  grid.heads.push_back(words("role", "role", Audience::programs));
  grid.heads.push_back(of_quantity(options.metric));
  Grid::Head cost{cost_column, Audience::all};
  cost.column.name = options.cost == Cost::bytes ? "bytes" : "cost_ms";
  cost.column.heading = std::string(sentence(options.cost));
  grid.heads.push_back(cost);
  grid.heads.push_back(words("cost_interval", "interval", Audience::people));
  for (const char* one : {"cost_low", "cost_high"})
    grid.heads.push_back(number(one, std::string(unit(options.cost)), one, Audience::programs));
  grid.heads.push_back(number("relative_cost", "", "relative"));
  grid.heads.push_back(words("standing", "standing"));
  grid.heads.push_back(words("beaten_by", "beaten by", Audience::programs));

  std::size_t hidden = 0;
  for (const Field& field : fields) {
    Grid::Group group{.heading = field_heading(field, places), .rows = {}};
    const std::vector<FrontEntry> stands = find_front(field, better(options.metric));
    std::vector<std::size_t> order(field.candidates.size());
    std::iota(order.begin(), order.end(), 0);
    const auto cost_of = [&](std::size_t i) { return field.candidates[i].cost ? field.candidates[i].cost->value : INFINITY; };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return cost_of(a) < cost_of(b); });
    for (const std::size_t i : order) {
      const Candidate& c = field.candidates[i];
      if (!options.all && stands[i].standing == Standing::beaten) {
        ++hidden;
        continue;
      }
      Row row;
      add_place(row, field.place);
      row.push_back({text(c.setting)});
      row.push_back({text(std::string(name(c.role)))});
      row.push_back({{.value = c.error}});
      row.push_back({c.cost ? Cell{.value = c.cost->value} : Cell{}});
      row.push_back({text(c.cost ? interval_text(cost.column, *c.cost) : "-")});
      row.push_back({c.cost ? end(*c.cost, &ValueWithInterval::low) : Cell{}});
      row.push_back({c.cost ? end(*c.cost, &ValueWithInterval::high) : Cell{}});
      row.push_back({c.cost && c.relative_cost.value > 0 ? Cell{.value = c.relative_cost.value} : Cell{}});
      const std::string standing(name(stands[i].standing));
      std::string said = stands[i].beaten_by.empty() ? standing : fmt::format("{} ({})", standing, stands[i].beaten_by);
      if (stands[i].standing == Standing::aside) said = c.role == Role::contender ? "no cost" : std::string(name(c.role));
      row.push_back({shown_text(standing, std::move(said))});
      row.push_back({text(stands[i].beaten_by)});
      group.rows.push_back(std::move(row));
    }
    for (const std::string& note : field.notes) grid.notes.push_back(note);
    grid.groups.push_back(std::move(group));
  }
  grid.notes.emplace_back("front: no contender is at least as good in both and better in one");
  grid.notes.emplace_back("unclear: beaten by value, but the intervals of the costs overlap");
  grid.notes.emplace_back("relative: cost over that of the cheapest contender of the group");
  if (options.cost != Cost::bytes) grid.notes.emplace_back(interval_note);
  if (hidden > 0) grid.notes.push_back(fmt::format("{} beaten settings are not shown; --all shows them", hidden));
  return grid;
}

Grid best_grid(std::span<const Record> records, const AnalysisOptions& options) {
  if (options.cost == Cost::bytes)
    throw Error("--cost bytes is for front; best takes resolve, light or geometry, and budgets of memory by --memories");
  const Cost cost = options.cost;
  const std::vector<Field> fields = find_fields(records, {.error = options.metric, .cost = cost});
  const std::vector<Place> places = places_of(fields);
  const Column error = quantity_column(options.metric), bytes = quantity_column("bytes"), time = quantity_column("resolve_ms");
  Budgets budgets{options.times, options.memories, options.errors};
  for (double& memory : budgets.memories) memory /= bytes.shown_scale;
  for (double& one : budgets.errors) one /= error.shown_scale;
  if (budgets.times.empty() && budgets.memories.empty() && budgets.errors.empty()) budgets = round_budgets(fields);
  if (budgets.times.empty() && budgets.memories.empty() && budgets.errors.empty())
    throw Error("there is nothing to rank: no contender has a time, a memory or a {} above 0", options.metric);

  Grid grid;
  grid.title = fmt::format("Best contender at equal time, equal memory and equal error: {} against {}",
                           with_unit(options.metric), sentence(cost));
  add_place_heads(grid);
  grid.heads.push_back(words("limited", "limited", Audience::programs));
  grid.heads.push_back(number("budget", "", "budget", Audience::programs));
  grid.heads.push_back(words("at", "at", Audience::people));
  grid.heads.push_back(words("setting", "best"));
  grid.heads.push_back(of_quantity(options.metric));
  grid.heads.push_back({time, Audience::all});
  grid.heads.back().column.name = "cost_ms";
  grid.heads.back().column.heading = std::string(sentence(cost));
  grid.heads.push_back({bytes, Audience::all});
  grid.heads.push_back(words("also", "as good"));
  for (const Field& field : fields) {
    Grid::Group group{.heading = field_heading(field, places), .rows = {}};
    for (const Best& best : find_best(field, budgets, better(options.metric))) {
      Row row;
      add_place(row, field.place);
      const Column& limited = best.what == "time" ? time : best.what == "memory" ? bytes : error;
      row.push_back({text(best.what)});
      row.push_back({{.value = best.budget}});
      row.push_back({text(fmt::format("{} {} {}{}{}", best.what == "error" ? error.heading : best.what,
                                      best.what == "error" && better(options.metric) == "higher" ? "≥" : "≤",
                                      exact(best.budget * limited.shown_scale), limited.shown_unit.empty() ? "" : " ",
                                      limited.shown_unit))});
      if (!best.winner) {
        row.push_back({Cell{.value = {}, .shown = "none"}});
        for (int k = 0; k < 4; ++k) row.push_back({});
      } else {
        const Candidate& winner = field.candidates[*best.winner];
        row.push_back({text(winner.setting)});
        row.push_back({{.value = winner.error}});
        row.push_back({winner.time ? Cell{.value = winner.time->value} : Cell{}});
        row.push_back({winner.bytes ? Cell{.value = *winner.bytes} : Cell{}});
        std::vector<std::string> also;
        for (const std::size_t i : best.also) also.push_back(field.candidates[i].setting);
        const std::string all = joined(also, "; ");
        const bool is_long = also.size() > 3;
        row.push_back({also.empty() ? Cell{} : shown_text(all, is_long ? fmt::format("{} others", also.size()) : all)});
      }
      group.rows.push_back(std::move(row));
    }
    for (const std::string& note : field.notes) grid.notes.push_back(note);
    grid.groups.push_back(std::move(group));
  }
  grid.notes.emplace_back(
      "at equal time and memory the lowest error within the budget, at equal error the lowest time; as good: the same error, "
      "or "
      "a time whose interval overlaps");
  return grid;
}

}  // namespace gnomon::analysis
