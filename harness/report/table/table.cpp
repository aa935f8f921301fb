#include "report/table/table.h"

#include <algorithm>

#include "analysis/analysis.h"
#include "report/table/layout.h"

namespace gnomon {

Format format_named(std::string_view name) {
  static const std::vector<std::string> names = {"terminal", "md", "csv", "tex", "json"};  // in the order of Format
  require_word("there is no format", name, names);
  return static_cast<Format>(std::ranges::find(names, name) - names.begin());
}

std::vector<std::string> column_names(std::span<const Record> records) {
  std::vector<std::string> names;
  for (const Column& column : all_columns(records)) names.push_back(column.name);
  return names;
}

namespace {

/// Headline columns that a narrow terminal can do without, the least missed first.
constexpr std::string_view dispensable[] = {"displacement_p95", "displacement_mean", "wrong_rate_all",
                                            "snapping_floor",   "peak_bytes",        "setup_ms",
                                            "causes",           "build_ms",          "bytes"};

/// Width of a terminal table: that of the rule below its headings.
std::size_t width_of(const std::string& text) {
  const std::size_t rule = text.find("\n---");
  return rule == std::string::npos ? 0 : text.find('\n', rule + 1) - rule - 1;
}

/// The headline table, without some columns where the terminal is too narrow for all; says which.
std::string fitted_table(std::span<const Record> records, std::size_t width) {
  std::vector<std::string> names = headline_columns(records, false), left_out;
  std::string text = terminal_table(lay_out(records, names), width);
  for (const std::string_view name : dispensable) {
    if (width == 0 || width_of(text) <= width) break;
    if (std::erase(names, name) == 0) continue;
    left_out.emplace_back(name);
    text = terminal_table(lay_out(records, names), width);
  }
  if (!left_out.empty()) text += fmt::format("left out for want of room: {}\n", joined(left_out, ", "));
  return text;
}

}  // namespace

std::string render_table(std::span<const Record> records, Format format, const TableOptions& options) {
  if (format == Format::csv || format == Format::json) {
    std::vector<Column> columns = all_columns(records);
    if (!options.columns.empty()) columns = select(columns, options.columns);
    TableForPrograms table{.columns = std::move(columns), .rows = {}, .provenance = provenance(records)};
    for (const Record& record : records) {
      std::vector<Cell>& row = table.rows.emplace_back();
      for (const Column& column : table.columns) row.push_back(column.cell(record));
    }
    return format == Format::csv ? csv_table(table) : json_table(table);
  }
  if (format == Format::terminal && options.columns.empty()) return fitted_table(records, options.width);
  std::vector<std::string> names = options.columns;
  if (names.empty()) names = format == Format::latex ? paper_columns(records) : headline_columns(records, true);
  const Layout layout = lay_out(records, names);
  if (format == Format::terminal) return terminal_table(layout, options.width);
  return format == Format::markdown ? markdown_table(layout) : latex_table(layout, options);
}

}  // namespace gnomon
