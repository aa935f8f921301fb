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

}  // namespace

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

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_table(std::span<const Record> records, std::span<const Column> columns) {
  std::string text;
  const auto end_line = [&] {
    if (!columns.empty()) text.pop_back();
    text += "\r\n";  // RFC 4180
  };
  for (const Column& column : columns) text += csv_field(column.name) + ',';
  end_line();
  for (const Record& record : records) {
    for (const Column& column : columns) {
      const Cell cell = column.cell(record);
      if (const double* value = cell.number()) text += exact(*value);
      if (const auto* words = std::get_if<std::string>(&cell.value)) text += csv_field(*words);
      text += ',';
    }
    end_line();
  }
  return text;
}

std::string json_table(std::span<const Record> records, std::span<const Column> columns) {
  Json table;
  table["schema"] = table_schema;
  Json& heads = table["columns"] = Json::array();
  for (const Column& column : columns) heads.push_back(column_json(column));
  Json& rows = table["rows"] = Json::array();
  for (const Record& record : records) {
    Json& row = rows.emplace_back(Json::object());
    for (const Column& column : columns) row[column.name] = cell_json(column.cell(record));
  }
  Json& made = table["provenance"] = Json::array();
  for (const auto& [topic, what] : provenance(records)) made.push_back({{"topic", topic}, {"text", what}});
  return json_text(table, 1) + '\n';
}

}  // namespace gnomon
