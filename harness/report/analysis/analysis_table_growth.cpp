#include <algorithm>
#include <cmath>

#include "report/analysis/analysis_table_parts.h"
#include "report/table/digits.h"

namespace gnomon::analysis {

namespace {

void add_heads(Grid& grid, const Growths& growths) {
  add_place_heads(grid);
  grid.heads.push_back(words("setting", "technique"));
  grid.heads.push_back(words("stage", "stage"));
  grid.heads.push_back(number("exponent", "", "exponent"));
  grid.heads.push_back(words("exponent_interval", "interval", Audience::people));
  for (const char* one : {"exponent_low", "exponent_high"}) grid.heads.push_back(number(one, "", one, Audience::programs));
  grid.heads.push_back(number("coefficient", "ms", "coefficient", Audience::programs));
  grid.heads.push_back(number("r2", "", "R²"));
  grid.heads.push_back(number("points", "", "points", Audience::all, true));
  grid.heads.push_back(number("x_from", growths.unit, growths.axis + " from", Audience::all, true));
  grid.heads.push_back(number("x_to", growths.unit, "to", Audience::all, true));
  grid.heads.push_back(number("ms_from", "ms", "time from"));
  grid.heads.push_back(number("ms_to", "ms", "to"));
  grid.heads.push_back(words("why_not", "why not", Audience::programs));
}

Entries growth_row(const Growth& growth) {
  Entries row;
  add_place(row, growth.place);
  row.push_back({text(growth.setting)});
  row.push_back({text(growth.stage)});
  const std::optional<ValueWithInterval>& e = growth.exponent;
  const auto fixed = [](double value) { return fmt::format("{:.2f}", std::abs(value) < 0.005 ? 0.0 : value); };  // never -0.00
  row.push_back({e ? Cell{.value = e->value, .shown = fixed(e->value)} : Cell{.value = {}, .shown = growth.why_not}});
  row.push_back({text(e && e->has_interval ? fixed(e->low) + " .. " + fixed(e->high) : "-")});
  for (const auto which : {&ValueWithInterval::low, &ValueWithInterval::high}) row.push_back({end(e, which)});
  row.push_back({e ? Cell{.value = growth.coefficient} : Cell{}});
  row.push_back({e ? Cell{.value = growth.r2, .shown = fmt::format("{:.3f}", growth.r2)} : Cell{}});
  row.push_back({{.value = static_cast<double>(growth.points.size())}});
  const Growth::Point &first = growth.points.front(), &last = growth.points.back();
  for (const double value : {first.x, last.x, first.ms.value, last.ms.value}) row.push_back({{.value = value}});
  row.push_back({text(growth.why_not)});
  return row;
}

}  // namespace

Grid growth_grid(std::span<const Record> records, const AnalysisOptions& options) {
  const Growths growths = find_growth(records, options.x.empty() ? "triangles" : options.x);
  Grid grid;
  grid.title = fmt::format("Growth of cost with {}: time = coefficient * {}^exponent", growths.axis, growths.axis);
  add_heads(grid, growths);
  add_groups(grid, growths.rows, &Growth::place, growth_row);
  grid.notes.push_back(fmt::format("exponent: slope of the least-squares line through log time and log {}", growths.axis));
  grid.notes.emplace_back(interval_note);
  grid.notes.push_back(fmt::format("too few points: below {} different {}; below the clock: faster than {} ms", least_points,
                                   growths.axis, exact(clock_ms)));
  if (std::ranges::none_of(growths.rows, [](const Growth& growth) { return growth.exponent.has_value(); }))
    grid.notes.push_back(
        fmt::format("no row has an exponent: {} or more different {} make a line", least_points, growths.axis));
  if (growths.axis == "lights") grid.notes.emplace_back("total: build once, relight and resolve for every light");
  if (growths.single > 0)
    grid.notes.push_back(fmt::format("{} series with a single value of {} are left out", growths.single, growths.axis));
  return grid;
}

}  // namespace gnomon::analysis
