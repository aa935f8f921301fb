// The two forms for programs: plain values in the columns' own units, nothing rounded, nothing marked.
#include <cmath>

#include "measure/json.h"
#include "report/table/digits.h"
#include "report/table/layout.h"

namespace gnomon {

namespace {

/// Whole numbers without ".0", which some readers would take for a measured quantity.
Json as_number(double value) {
  const bool is_whole = std::abs(value) < 0x1p53 && value == std::trunc(value);
  return is_whole ? Json(static_cast<std::int64_t>(value)) : Json(value);
}

Json column_json(const Column& column) {
  return {{"name", column.name},
          {"unit", column.unit},
          {"heading", column.heading},
          {"better", column.better},
          {"sentence", column.sentence}};
}

Json cell_json(const Cell& cell) {
  if (const double* number = cell.number()) return std::isfinite(*number) ? as_number(*number) : Json(nullptr);
  if (const auto* words = std::get_if<std::string>(&cell.value)) return *words;
  return nullptr;
}

}  // namespace

std::string csv_field(std::string_view text) {
  // A spreadsheet takes a field that opens so for a formula, unless an apostrophe precedes it.
  const bool is_formula = text.starts_with('=') || text.starts_with('@') ||
                          ((text.starts_with('+') || text.starts_with('-')) && text.find_first_of("=|(!@") != text.npos);
  if (!is_formula && text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = is_formula ? "\"'" : "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_heads(std::span<const Column> columns) {
  std::vector<std::string> fields;
  for (const Column& column : columns) fields.push_back(csv_field(column.name));
  return fmt::format("{}\r\n", joined(fields, ","));  // RFC 4180
}

std::string csv_line(std::span<const Cell> cells) {
  std::vector<std::string> fields;
  for (const Cell& cell : cells) {
    const auto* words = std::get_if<std::string>(&cell.value);
    fields.push_back(cell.number() ? exact(*cell.number()) : words ? csv_field(*words) : "");
  }
  return fmt::format("{}\r\n", joined(fields, ","));
}

std::string csv_table(const Layout& table) {
  std::string text = csv_heads(table.columns);
  for (const Layout::Group& group : table.groups)
    for (const Layout::Row& row : group.rows) text += csv_line(row.cells);
  return text;
}

std::string json_table(const Layout& table) {
  Json json = {{"schema", "gnomon-table-1"}};
  if (!table.title.empty()) json["title"] = table.title;
  Json& heads = json["columns"] = Json::array();
  for (const Column& column : table.columns) heads.push_back(column_json(column));
  Json& rows = json["rows"] = Json::array();
  for (const Layout::Group& group : table.groups)
    for (const Layout::Row& row : group.rows) {
      Json& line = rows.emplace_back(Json::object());
      for (std::size_t i = 0; i < row.cells.size(); ++i) line[table.columns[i].name] = cell_json(row.cells[i]);
    }
  if (!table.title.empty()) json["notes"] = table.notes;
  Json& made = json["provenance"] = Json::array();
  for (const auto& [topic, what] : table.provenance) made.push_back({{"topic", topic}, {"text", what}});
  return json_text(json, 1) + '\n';
}

}  // namespace gnomon
