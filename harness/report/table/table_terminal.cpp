#include <algorithm>

#include "report/table/layout.h"

namespace gnomon {

namespace {

/// How many leading columns a row without results fills: up to the first number, when nothing but nulls follows there.
std::size_t filled_columns(const Layout& layout, const Layout::Row& row) {
  std::size_t first = 0;
  while (first < layout.columns.size() && layout.columns[first].alignment == Align::left) ++first;
  for (std::size_t i = first; i < row.entries.size(); ++i)
    if (row.entries[i].text != "-") return row.entries.size();
  return first;
}

}  // namespace

std::string terminal_table(const Layout& layout, std::size_t width) {
  std::vector<TextTable::Column> columns;
  for (const Column& column : layout.columns) columns.push_back({column.heading, column.shown_unit, column.alignment});
  // Marks have a column of their own width behind the number, so that digits stay under digits.
  std::vector<bool> has_mark(columns.size(), false);
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows)
      for (std::size_t i = 0; i < row.entries.size(); ++i)
        has_mark[i] = has_mark[i] || row.entries[i].is_best || row.entries[i].is_flagged;

  TextTable table(std::move(columns));
  std::vector<std::size_t> noted;  // notes that did not fit into their row, numbered by first use
  for (const Layout::Group& group : layout.groups) {
    table.add_heading(group.heading);
    for (const Layout::Row& row : group.rows) {
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < row.entries.size(); ++i) {
        const Layout::Entry& entry = row.entries[i];
        const char* mark = entry.is_flagged ? "!" : entry.is_best ? "*" : has_mark[i] ? " " : "";
        cells.push_back(entry.text + mark);
      }
      const std::size_t filled = row.record->status == Status::ok ? cells.size() : filled_columns(layout, row);
      const bool has_room = filled < cells.size() && row.note > 0;
      if (has_room) {
        cells.resize(filled);
        table.add_row(std::move(cells), row.record->reason);
        continue;
      }
      if (row.note > 0) {
        const auto place = std::find(noted.begin(), noted.end(), row.note);
        const auto number = place - noted.begin() + 1;
        if (place == noted.end()) noted.push_back(row.note);
        for (std::size_t i = 0; i < cells.size(); ++i)
          if (layout.columns[i].name == "support") cells[i] += fmt::format(" [{}]", number);
      }
      table.add_row(std::move(cells));
    }
  }

  std::string text = table.text(width) + '\n';
  for (std::size_t i = 0; i < noted.size(); ++i) text += fmt::format("[{}] {}\n", i + 1, layout.notes[noted[i] - 1]);
  for (const auto& [mark, meaning] : legend(layout, "*", "!")) text += fmt::format("{}: {}\n", mark, meaning);
  for (const auto& [topic, what] : layout.provenance) text += fmt::format("{}: {}\n", topic, what);
  return text;
}

}  // namespace gnomon
