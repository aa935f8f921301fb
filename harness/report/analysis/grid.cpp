#include "report/analysis/grid.h"

#include <algorithm>

#include "measure/json.h"
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
  std::string head = "|", rule = "|";
  for (const std::size_t i : seen) {
    const Column& column = grid.heads[i].column;
    head += fmt::format(" {}{} |", markdown_text(column.heading),
                        column.shown_unit.empty() ? "" : fmt::format(" ({})", markdown_text(column.shown_unit)));
    rule += column.alignment == Align::right ? " ---: |" : " --- |";
  }
  std::string text = grid.title.empty() ? "" : fmt::format("{}\n\n", markdown_text(grid.title));
  for (const Grid::Group& group : grid.groups) {
    if (!group.heading.empty()) text += fmt::format("**{}**\n\n", markdown_text(group.heading));
    text += head + '\n' + rule + '\n';
    for (const auto& row : group.rows) {
      text += '|';
      for (const std::size_t i : seen) {
        const std::string cell = markdown_text(entry_text(grid, i, row[i]));
        text += row[i].is_best ? fmt::format(" **{}** |", cell) : fmt::format(" {} |", cell);
      }
      text += '\n';
    }
    text += '\n';
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

std::string csv_form(const Grid& grid) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::programs);
  std::vector<std::string> fields;
  for (const std::size_t i : seen) fields.push_back(csv_field(grid.heads[i].column.name));
  std::string text = fmt::format("{}\r\n", joined(fields, ","));
  for (const Grid::Group& group : grid.groups)
    for (const auto& row : group.rows) {
      fields.clear();
      for (const std::size_t i : seen) {
        const Cell& cell = row[i].cell;
        const auto* words = std::get_if<std::string>(&cell.value);
        fields.push_back(cell.number() ? exact(*cell.number()) : words ? csv_field(*words) : "");
      }
      text += fmt::format("{}\r\n", joined(fields, ","));
    }
  return text;
}

std::string json_form(const Grid& grid) {
  const std::vector<std::size_t> seen = seen_by(grid, Grid::Audience::programs);
  Json table;
  table["schema"] = table_schema;
  table["title"] = grid.title;
  Json& heads = table["columns"] = Json::array();
  for (const std::size_t i : seen) heads.push_back(column_json(grid.heads[i].column));
  Json& rows = table["rows"] = Json::array();
  for (const Grid::Group& group : grid.groups)
    for (const auto& row : group.rows) {
      Json& object = rows.emplace_back(Json::object());
      for (const std::size_t i : seen) object[grid.heads[i].column.name] = cell_json(row[i].cell);
    }
  table["notes"] = grid.notes;
  Json& made = table["provenance"] = Json::array();
  for (const auto& [topic, what] : grid.provenance) made.push_back({{"topic", topic}, {"text", what}});
  return json_text(table, 1) + '\n';
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
      return csv_form(grid);
    case Format::json:
      break;
  }
  return json_form(grid);
}

}  // namespace gnomon
