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

/// The rows of a table as text, and the reasons that did not fit into their row, numbered by first use.
struct Body {
  TextTable table;
  std::vector<std::size_t> noted = {};
};

Body body_of(const Layout& layout) {
  std::vector<TextTable::Column> columns;
  for (const Column& column : layout.columns)
    columns.push_back({column.heading, column.shown_unit, column.alignment, column.spare});
  // Marks have a column of their own width behind the number, so that digits stay under digits.
  std::vector<std::size_t> room(columns.size(), 0);
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows)
      for (std::size_t i = 0; i < row.cells.size(); ++i) room[i] = std::max(room[i], display_width(marks_of(row.cells[i])));

  Body body{TextTable(std::move(columns))};
  for (const Layout::Group& group : layout.groups) {
    if (!group.heading.empty()) body.table.add_heading(group.heading);
    for (const Layout::Row& row : group.rows) {
      std::vector<std::string> cells;
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string marks = marks_of(row.cells[i]);
        cells.push_back(shown(layout.columns[i], row.cells[i]) + marks + std::string(room[i] - display_width(marks), ' '));
      }
      const std::size_t filled = filled_columns(layout, row);
      if (row.reason > 0 && filled < cells.size()) {
        cells.resize(filled);
        body.table.add_row(std::move(cells), printable(row.record->reason, true));
        continue;
      }
      if (row.reason > 0) {
        add_once(body.noted, row.reason);
        for (std::size_t i = 0; i < cells.size(); ++i)
          if (layout.columns[i].name == "support") cells[i] += fmt::format(" [{}]", index_of(body.noted, row.reason) + 1);
      }
      body.table.add_row(std::move(cells));
    }
  }
  return body;
}

}  // namespace

std::vector<std::string> left_out_on_terminal(const Layout& layout, std::size_t width) {
  std::vector<std::string> names;
  for (const std::size_t i : body_of(layout).table.left_out(width)) names.push_back(layout.columns[i].name);
  return names;
}

std::string terminal_table(const Layout& layout, std::size_t width) {
  const Body body = body_of(layout);
  std::string text = layout.title.empty() ? "" : wrapped_line(layout.title, width) + '\n';
  text += body.table.text(width) + '\n';
  const auto add = [&](const std::string& line) { text += wrapped_line(line, width); };
  for (std::size_t i = 0; i < body.noted.size(); ++i)
    add(fmt::format("[{}] {}", i + 1, printable(layout.reasons[body.noted[i] - 1], true)));
  for (const auto& [mark, meaning] : legend(layout, {"*", "\u00b0", "!"})) add(fmt::format("{}: {}", mark, meaning));
  for (const std::string& note : layout.notes) add(note);
  for (const auto& [topic, what] : layout.provenance) add(fmt::format("{}: {}", topic, what));
  return text;
}

}  // namespace gnomon
