#include "report/analysis/grid.h"

#include <algorithm>

#include "report/table/digits.h"
#include "report/table/layout.h"

namespace gnomon {

namespace {

/// Indices of the heads that this audience sees.
std::vector<std::size_t> seen_by(const Grid& grid, Grid::Audience audience) {
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < grid.heads.size(); ++i)
    if (grid.heads[i].audience == Grid::Audience::all || grid.heads[i].audience == audience) seen.push_back(i);
  return seen;
}

bool has_best(const Grid& grid) {
  for (const Grid::Group& group : grid.groups)
    for (const auto& row : group.rows)
      if (std::any_of(row.begin(), row.end(), [](const Grid::Entry& entry) { return entry.is_best; })) return true;
  return false;
}

std::string entry_text(const Grid& grid, std::size_t i, const Grid::Entry& entry) {
  return shown(grid.heads[i].column, entry.cell);
}

std::string terminal_form(const Grid& grid, std::size_t width) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::people);
  std::vector<TextTable::Column> columns;
  std::vector<bool> has_mark;
  for (const std::size_t i : seen) {
    const Column& column = grid.heads[i].column;
    columns.push_back({column.heading, column.shown_unit, column.alignment});
    has_mark.push_back(false);
    for (const Grid::Group& group : grid.groups)
      for (const auto& row : group.rows) has_mark.back() = has_mark.back() || row[i].is_best;
  }
  TextTable table(std::move(columns));
  for (const Grid::Group& group : grid.groups) {
    if (!group.heading.empty()) table.add_heading(group.heading);
    for (const auto& row : group.rows) {
      std::vector<std::string> cells;
      for (std::size_t k = 0; k < seen.size(); ++k)
        cells.push_back(entry_text(grid, seen[k], row[seen[k]]) + (row[seen[k]].is_best ? "*" : has_mark[k] ? " " : ""));
      table.add_row(std::move(cells));
    }
  }
  std::string text = (grid.title.empty() ? "" : grid.title + "\n\n") + table.text(width) + '\n';
  if (has_best(grid)) text += "*: best\n";
  for (const std::string& note : grid.notes) text += note + '\n';
  for (const auto& [topic, what] : grid.provenance) text += fmt::format("{}: {}\n", topic, what);
  return text;
}

std::string markdown_form(const Grid& grid) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::people);
  std::vector<Column> columns;
  for (const std::size_t i : seen) columns.push_back(grid.heads[i].column);
  std::string text = grid.title.empty() ? "" : fmt::format("{}\n\n", markdown_text(grid.title));
  for (const Grid::Group& group : grid.groups) {
    if (!group.heading.empty()) text += fmt::format("**{}**\n\n", markdown_text(group.heading));
    std::vector<std::vector<std::string>> rows;
    for (const auto& row : group.rows) {
      std::vector<std::string>& cells = rows.emplace_back();
      for (const std::size_t i : seen) {
        const std::string cell = markdown_text(entry_text(grid, i, row[i]));
        cells.push_back(row[i].is_best ? fmt::format("**{}**", cell) : cell);
      }
    }
    text += markdown_lines(columns, rows);
  }
  if (has_best(grid)) text += "- **bold**: best\n";
  for (const std::string& note : grid.notes) text += fmt::format("- {}\n", markdown_text(note));
  for (const auto& [topic, what] : grid.provenance) text += fmt::format("- {}: {}\n", topic, markdown_text(what));
  return text;
}

std::string latex_form(const Grid& grid, const TableOptions& options) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::people);
  LatexRows rows;
  for (const std::size_t i : seen) rows.columns.push_back(grid.heads[i].column);
  for (const Grid::Group& group : grid.groups) {
    LatexRows::Group& made = rows.groups.emplace_back();
    made.heading = group.heading;
    for (const auto& row : group.rows) {
      std::vector<LatexRows::Entry>& cells = made.rows.emplace_back();
      for (const std::size_t i : seen) cells.push_back({entry_text(grid, i, row[i]), row[i].is_best, ""});
    }
  }
  if (has_best(grid)) rows.notes.push_back("\\textbf{bold}: best");
  for (const std::string& note : grid.notes) rows.notes.push_back(latex_text(note));
  for (const auto& [topic, what] : grid.provenance)
    rows.notes.push_back(fmt::format("{}: {}", latex_text(topic), latex_text(what)));
  return latex_floats(rows, options.caption.empty() ? grid.title : options.caption, options.label);
}

TableForPrograms for_programs(const Grid& grid) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::programs);
  TableForPrograms table{.columns = {}, .rows = {}, .title = grid.title, .notes = grid.notes, .provenance = grid.provenance};
  for (const std::size_t i : seen) table.columns.push_back(grid.heads[i].column);
  for (const Grid::Group& group : grid.groups)
    for (const auto& row : group.rows) {
      std::vector<Cell>& cells = table.rows.emplace_back();
      for (const std::size_t i : seen) cells.push_back(row[i].cell);
    }
  return table;
}

}  // namespace

std::string render_grid(const Grid& grid, Format format, const TableOptions& options) {
  switch (format) {
    case Format::terminal:
      return terminal_form(grid, options.width);
    case Format::markdown:
      return markdown_form(grid);
    case Format::latex:
      return latex_form(grid, options);
    case Format::csv:
      return csv_table(for_programs(grid));
    case Format::json:
      break;
  }
  return json_table(for_programs(grid));
}

}  // namespace gnomon
