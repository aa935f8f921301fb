#include "report/analysis/analysis_table.h"

#include "report/analysis/analysis_table_parts.h"

namespace gnomon {

namespace {

struct Kind {
  std::string_view name;
  analysis::Tables (*tables)(std::span<const Record>, const AnalysisOptions&, Format);
};
constexpr Kind kinds[] = {
    {"growth", analysis::growth_tables}, {"forecast", analysis::forecast_tables}, {"front", analysis::front_tables},
    {"best", analysis::best_tables},     {"enough", analysis::enough_tables},     {"rank", analysis::rank_tables},
    {"map", analysis::map_tables},       {"motion", analysis::motion_tables},     {"sweep", analysis::sweep_tables},
    {"seams", analysis::seams_tables},   {"masks", analysis::masks_tables}};

}  // namespace

std::vector<std::string> analysis_kinds() { return names_in(kinds); }

Column quantity_column(const std::string& quantity) {
  for (Column& column : all_columns({}))
    if (column.name == quantity) return column;
  return number_column(quantity, "", quantity);  // a metric that another version measured
}

std::string quantity_named(std::span<const Record> records, const std::string& word) {
  const auto is_quantity = [&](const std::string& name) {
    return std::ranges::any_of(records, [&](const Record& r) { return quantity(r, name).has_value(); });
  };
  if (is_quantity(word)) return word;
  std::vector<std::string> names = names_with_heading(all_columns(records), word);
  std::erase_if(names, std::not_fn(is_quantity));
  if (names.size() > 1) throw Error("{} is the heading of several quantities; name one of them: {}", word, joined(names));
  return names.empty() ? word : names.front();
}

std::string analyze(std::span<const Record> records, const std::string& kind, const AnalysisOptions& options, Format format,
                    const TableOptions& table) {
  require_word("there is no analysis", kind, analysis_kinds());
  AnalysisOptions wanted = options;
  // Programs choose among the rows by themselves.
  wanted.all = wanted.all || format == Format::csv || format == Format::json;
  analysis::Tables tables = std::ranges::find(kinds, kind, &Kind::name)->tables(records, wanted, format);
  tables.back().provenance = provenance(records);
  std::string text;
  for (std::size_t k = 0; k < tables.size(); ++k) {
    TableOptions here = table;
    if (format == Format::latex && tables.size() > 1) here.label += fmt::format(":{}", k + 1);
    text += render_layout(std::move(tables[k]), format, here);
    if (k + 1 < tables.size() && format != Format::terminal) text += '\n';
  }
  return text;
}

namespace analysis {

Column lengthened(Column column, const std::string& suffix, const std::string& heading) {
  column.name += suffix;
  column.heading += ' ' + heading;
  return column;
}

Column at_value(Column column, const std::string& value) {
  column.heading = value;
  column.shown_unit = "";
  return column;
}

std::string with_unit(const Column& column) {
  const bool is_said = column.heading.ends_with(column.shown_unit);  // "umbra area ratio" needs no "in ratio"
  return is_said ? column.heading : fmt::format("{} in {}", column.heading, column.shown_unit);
}

Cell shown_text(std::string_view value, std::string shown) { return {.value = std::string(value), .shown = std::move(shown)}; }

Cell value_of(const std::optional<ValueWithInterval>& measured) { return measured ? Cell{.value = measured->value} : Cell{}; }

Cell end(const std::optional<ValueWithInterval>& measured, double ValueWithInterval::*which) {
  return measured && measured->has_interval ? Cell{.value = (*measured).*which} : Cell{};
}

std::string interval_text(const Column& column, const ValueWithInterval& m) {
  if (!m.has_interval) return "-";
  return fmt::format("{} .. {}", shown(column, {.value = m.low}), shown(column, {.value = m.high}));
}

std::vector<Column> place_columns() {
  std::vector<Column> columns;
  for (const char* name : {"scene", "light", "view", "path"}) columns.push_back(for_programs(text_column(name, name)));
  for (const char* name : {"width", "height"}) columns.push_back(for_programs(whole_column(name, "px", name)));
  columns.push_back(for_programs(text_column("truth", "truth")));
  return columns;
}

Cells place_cells(const std::optional<Place>& place) {
  const Place at = place.value_or(Place{});
  Cells cells;
  for (const std::string* part : {&at.scene, &at.light, &at.view, &at.path}) cells.push_back(text_cell(*part));
  for (const int size : {at.width, at.height}) cells.push_back(size > 0 ? Cell{.value = double(size)} : Cell{});
  cells.push_back(place ? text_cell(name(at.truth)) : Cell{});
  return cells;
}

}  // namespace analysis

}  // namespace gnomon
