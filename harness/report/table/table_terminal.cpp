#include "analysis/in_order.h"
#include "measure/printable.h"
#include "report/table/layout.h"

namespace gnomon {

namespace {

/// How many leading columns a row fills: of one without results those up to the first number, when nothing but nulls follows
/// there.
std::size_t filled_columns(const Layout& layout, const Layout::Row& row) {
  const std::size_t all = row.cells.size();
  if (!row.record || row.record->status == Status::ok) return all;
  std::size_t first = 0;
  while (first < all && layout.columns[first].alignment == Align::left) ++first;
  for (std::size_t i = first; i < all; ++i)
    if (shown(layout.columns[i], row.cells[i]) != "-") return all;
  return first;
}

std::string marks_of(const Cell& cell) {
  return std::string(cell.is_flagged ? "!" : cell.is_best ? "*" : "") + (cell.is_floored ? "\u00b0" : "");
}

}  // namespace

std::string terminal_table(const Layout& layout, std::size_t width) {
  std::vector<TextTable::Column> columns;
  for (const Column& column : layout.columns) columns.push_back({column.heading, column.shown_unit, column.alignment});
  // Marks have a column of their own width behind the number, so that digits stay under digits.
  std::vector<std::size_t> room(columns.size(), 0);
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows)
      for (std::size_t i = 0; i < row.cells.size(); ++i) room[i] = std::max(room[i], display_width(marks_of(row.cells[i])));

  TextTable table(std::move(columns));
  std::vector<std::size_t> noted;  // reasons that did not fit into their row, numbered by first use
  for (const Layout::Group& group : layout.groups) {
    if (!group.heading.empty()) table.add_heading(group.heading);
    for (const Layout::Row& row : group.rows) {
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string marks = marks_of(row.cells[i]);
        cells.push_back(shown(layout.columns[i], row.cells[i]) + marks + std::string(room[i] - display_width(marks), ' '));
      }
      const std::size_t filled = filled_columns(layout, row);
      if (row.reason > 0 && filled < cells.size()) {
        cells.resize(filled);
        table.add_row(std::move(cells), printable(row.record->reason, true));
        continue;
      }
      if (row.reason > 0) {
        add_once(noted, row.reason);
        for (std::size_t i = 0; i < cells.size(); ++i)
          if (layout.columns[i].name == "support") cells[i] += fmt::format(" [{}]", index_of(noted, row.reason) + 1);
      }
      table.add_row(std::move(cells));
    }
  }

  std::string text = (layout.title.empty() ? "" : layout.title + "\n\n") + table.text(width) + '\n';
  for (std::size_t i = 0; i < noted.size(); ++i)
    text += fmt::format("[{}] {}\n", i + 1, printable(layout.reasons[noted[i] - 1], true));
  for (const auto& [mark, meaning] : legend(layout, {"*", "\u00b0", "!"})) text += fmt::format("{}: {}\n", mark, meaning);
  for (const std::string& note : layout.notes) text += note + '\n';
  for (const auto& [topic, what] : layout.provenance) text += fmt::format("{}: {}\n", topic, what);
  return text;
}

std::size_t terminal_width_of(const std::string& text) {
  const std::size_t rule = text.find("\n---");
  return rule == std::string::npos ? 0 : text.find('\n', rule + 1) - rule - 1;
}

}  // namespace gnomon
