#include "report/table/layout.h"

namespace gnomon {

std::string markdown_text(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (std::string_view("|\\`*_[]<>").find(c) != std::string_view::npos) safe += '\\';
    safe += c == '\n' || c == '\r' ? ' ' : c;
  }
  return safe;
}

std::string markdown_table(const Layout& layout) {
  std::string head = "|", rule = "|";
  for (const Column& column : layout.columns) {
    head += fmt::format(" {}{} |", markdown_text(column.heading),
                        column.shown_unit.empty() ? "" : fmt::format(" ({})", markdown_text(column.shown_unit)));
    rule += column.alignment == Align::right ? " ---: |" : " --- |";
  }
  std::string text = layout.title.empty() ? "" : markdown_text(layout.title) + "\n\n";
  for (const Layout::Group& group : layout.groups) {
    if (!group.heading.empty()) text += fmt::format("**{}**\n\n", markdown_text(group.heading));
    text += fmt::format("{}\n{}\n", head, rule);
    for (const Layout::Row& row : group.rows) {
      text += '|';
      for (std::size_t i = 0; i < row.cells.size(); ++i) {
        const std::string cell = markdown_text(shown(layout.columns[i], row.cells[i]));
        text += row.cells[i].is_best ? fmt::format(" **{}**", cell) : " " + cell;
        if (row.cells[i].is_floored) text += "\u00b0";
        if (row.cells[i].is_flagged) text += " (!)";
        if (row.reason > 0 && layout.columns[i].name == "support") text += fmt::format(" ({})", row.reason);
        text += " |";
      }
      text += '\n';
    }
    text += '\n';
  }
  for (std::size_t i = 0; i < layout.reasons.size(); ++i)
    text += fmt::format("- ({}) {}\n", i + 1, markdown_text(layout.reasons[i]));
  // A bare dash would open a list in the list.
  for (const auto& [mark, meaning] : legend(layout, {"**bold**", "\u00b0", "(!)"}))
    text += fmt::format("- {}: {}\n", mark == "-" ? "\\-" : mark, meaning);
  for (const std::string& note : layout.notes) text += fmt::format("- {}\n", markdown_text(note));
  for (const auto& [topic, what] : layout.provenance) text += fmt::format("- {}: {}\n", topic, markdown_text(what));
  return text;
}

}  // namespace gnomon
