#include "report/table/layout.h"

namespace gnomon {

std::string markdown_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      safe += ' ';
      continue;
    }
    if (std::string_view("|\\`*_[]<>").find(c) != std::string_view::npos) safe += '\\';
    safe += c;
  }
  return safe;
}

std::string markdown_lines(std::span<const Column> columns, std::span<const std::vector<std::string>> rows) {
  std::string text = "|", rule = "|";
  for (const Column& column : columns) {
    text += fmt::format(" {}{} |", markdown_text(column.heading),
                        column.shown_unit.empty() ? "" : fmt::format(" ({})", markdown_text(column.shown_unit)));
    rule += column.alignment == Align::right ? " ---: |" : " --- |";
  }
  text += '\n' + rule + '\n';
  for (const std::vector<std::string>& row : rows) text += fmt::format("| {} |\n", joined(row, " | "));
  return text + '\n';
}

std::string markdown_table(const Layout& layout) {
  std::vector<std::vector<std::string>> rows;
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& row : group.rows) {
      std::vector<std::string>& cells = rows.emplace_back();
      for (std::size_t i = 0; i < row.entries.size(); ++i) {
        const Layout::Entry& entry = row.entries[i];
        std::string cell = markdown_text(entry.text);
        if (entry.is_best) cell = "**" + cell + "**";
        if (entry.is_flagged) cell += " (!)";
        if (row.note > 0 && layout.columns[i].name == "support") cell += fmt::format(" ({})", row.note);
        cells.push_back(std::move(cell));
      }
    }
  std::string text = markdown_lines(layout.columns, rows);
  for (std::size_t i = 0; i < layout.notes.size(); ++i)
    text += fmt::format("- ({}) {}\n", i + 1, markdown_text(layout.notes[i]));
  // A bare dash would open a list in the list.
  for (const auto& [mark, meaning] : legend(layout, "**bold**", "(!)"))
    text += fmt::format("- {}: {}\n", mark == "-" ? "\\-" : mark, meaning);
  for (const auto& [topic, what] : layout.provenance) text += fmt::format("- {}: {}\n", topic, markdown_text(what));
  return text;
}

}  // namespace gnomon
