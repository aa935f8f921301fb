#include "report/table.h"

#include "report/layout.h"

namespace gnomon {

Format format_named(std::string_view name) {
  if (name == "terminal") return Format::terminal;
  if (name == "md") return Format::markdown;
  if (name == "csv") return Format::csv;
  if (name == "tex") return Format::latex;
  if (name == "json") return Format::json;
  const std::vector<std::string> names = {"terminal", "md", "csv", "tex", "json"};
  throw Error("there is no format {}; did you mean {}? There are: {}", name, nearest_word(name, names), fmt::join(names, ", "));
}

std::vector<std::string> column_names(std::span<const Record> records) {
  std::vector<std::string> names;
  for (const Column& column : all_columns(records)) names.push_back(column.name);
  return names;
}

std::string render_table(std::span<const Record> records, Format format, const TableOptions& options) {
  if (format == Format::csv || format == Format::json) {
    std::vector<Column> columns = all_columns(records);
    if (!options.columns.empty()) columns = select(columns, options.columns);
    return format == Format::csv ? csv_table(records, columns) : json_table(records, columns);
  }
  const std::vector<std::string> names =
      options.columns.empty() ? headline_columns(records, format != Format::terminal) : options.columns;
  const Layout layout = lay_out(records, names);
  if (format == Format::terminal) return terminal_table(layout, options.width);
  return format == Format::markdown ? markdown_table(layout) : latex_table(layout, options);
}

}  // namespace gnomon
