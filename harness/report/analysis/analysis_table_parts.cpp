#include "report/analysis/analysis_table_parts.h"

namespace gnomon::analysis {

Grid::Head words(std::string name, std::string heading, Audience audience) {
  Column column{.name = std::move(name),
                .unit = "",
                .heading = std::move(heading),
                .shown_unit = "",
                .alignment = Align::left,
                .cell = {}};
  return {std::move(column), audience};
}

Grid::Head number(std::string name, std::string unit, std::string heading, Audience audience, bool is_exact) {
  Column column{.name = std::move(name),
                .unit = unit,
                .heading = std::move(heading),
                .shown_unit = unit,
                .is_exact = is_exact,
                .cell = {}};
  return {std::move(column), audience};
}

Grid::Head of_quantity(const std::string& quantity, const std::string& suffix, const std::string& heading) {
  Column column = quantity_column(quantity);
  column.name += suffix;
  if (!heading.empty()) column.heading += ' ' + heading;
  return {std::move(column), Audience::all};
}

void add_place_heads(Grid& grid) {
  for (const char* name : {"scene", "light", "view", "path"}) grid.heads.push_back(words(name, name, Audience::programs));
  for (const char* name : {"width", "height"}) grid.heads.push_back(number(name, "px", name, Audience::programs, true));
  grid.heads.push_back(words("truth", "truth", Audience::programs));
}

Cell text(const std::string& value) { return value.empty() ? Cell{} : Cell{.value = value}; }
Cell shown_text(const std::string& value, std::string shown) { return {.value = value, .shown = std::move(shown)}; }

Cell value_of(const std::optional<ValueWithInterval>& measured) { return measured ? Cell{.value = measured->value} : Cell{}; }

Cell end(const std::optional<ValueWithInterval>& measured, double ValueWithInterval::*which) {
  return measured && measured->has_interval ? Cell{.value = (*measured).*which} : Cell{};
}

void add_place(Entries& row, const std::optional<Place>& place) {
  const Place at = place.value_or(Place{});
  for (const std::string& part : {at.scene, at.light, at.view, at.path}) row.push_back({text(part)});
  for (const int size : {at.width, at.height}) row.push_back({size > 0 ? Cell{.value = double(size)} : Cell{}});
  row.push_back({place ? text(std::string(name(at.truth))) : Cell{}});
}

std::string interval_text(const Column& column, const ValueWithInterval& m) {
  if (!m.has_interval) return "-";
  return fmt::format("{} .. {}", shown(column, {.value = m.low}), shown(column, {.value = m.high}));
}

std::string with_unit(const std::string& quantity) {
  const Column column = quantity_column(quantity);
  const bool is_said = column.heading.ends_with(column.shown_unit);  // "umbra area ratio" needs no "in ratio"
  return is_said ? column.heading : fmt::format("{} in {}", column.heading, column.shown_unit);
}

std::string render_grids(std::span<const Grid> grids, Format format, const TableOptions& table) {
  std::string all;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    TableOptions here = table;
    if (format == Format::latex && grids.size() > 1) here.label += fmt::format(":{}", k + 1);
    all += render_grid(grids[k], format, here);
    if (k + 1 < grids.size() && format != Format::terminal) all += '\n';
  }
  return all;
}

}  // namespace gnomon::analysis
