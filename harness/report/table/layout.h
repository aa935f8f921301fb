#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "report/table/columns.h"
#include "report/table/table.h"

namespace gnomon {

/// A table for people before it takes a form: which rows stand together, which cells are marked, what stands below.
struct Layout {
  struct Entry {
    std::string text;
    bool is_best = false, is_flagged = false;
  };
  struct Row {
    const Record* record = nullptr;
    std::vector<Entry> entries;  ///< one per column
    std::size_t note = 0;        ///< number of the note that gives the reason, from 1; 0: nothing to say
  };
  struct Group {
    std::string heading;  ///< scene, light, view, size
    std::vector<Row> rows;
  };
  std::vector<Column> columns;
  std::vector<Group> groups;
  std::vector<std::string> notes;                               ///< reasons, each once
  std::vector<std::pair<std::string, std::string>> provenance;  ///< stands below the table: topic, text
};

/// The columns for people unless others are named. With `with_group` scene and light lead, and view, size and truth
/// where they vary; without, the group's heading says them.
std::vector<std::string> headline_columns(std::span<const Record> records, bool with_group);

/// Those of a table on paper, where a line above each group says scene, light and view: what fits across a page.
std::vector<std::string> paper_columns(std::span<const Record> records);

/// Groups and rows keep the order of the records. `columns` by name.
Layout lay_out(std::span<const Record> records, std::span<const std::string> columns);

/// What the records say of where they were made: topic and text, "-" where they do not say.
std::vector<std::pair<std::string, std::string>> provenance(std::span<const Record> records);

/// The marks and shorthands that occur in this table, explained: mark and text.
std::vector<std::pair<std::string, std::string>> legend(const Layout& layout, std::string_view best, std::string_view flag);

std::string terminal_table(const Layout& layout, std::size_t width);
std::string markdown_table(const Layout& layout);
std::string latex_table(const Layout& layout, const TableOptions& options);

/// A table in the two forms for programs. In JSON a table with a title has notes too.
struct TableForPrograms {
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows;
  std::optional<std::string> title = {};
  std::vector<std::string> notes = {};
  std::vector<std::pair<std::string, std::string>> provenance = {};  ///< topic and text
};
std::string csv_table(const TableForPrograms& table);
std::string json_table(const TableForPrograms& table);

/// Rows on their way into LaTeX floats.
struct LatexRows {
  struct Entry {
    std::string text;  ///< plain
    bool is_best = false;
    std::string mark;  ///< LaTeX, behind the text
  };
  struct Group {
    std::string heading;  ///< plain; a line of its own above the rows
    std::vector<std::vector<Entry>> rows;
  };
  std::vector<Column> columns;
  std::vector<Group> groups;
  std::vector<std::string> notes;  ///< LaTeX, below the last float
};
/// As many `table` floats as the rows need on pages in landscape, each with booktabs only; a group is cut between two of them
/// only when it is longer than a page. Long texts wrap into further lines.
std::string latex_floats(const LatexRows& rows, const std::string& caption, const std::string& label);

/// A field of RFC 4180: quoted when it holds a comma, a quote or a line break, quotes doubled.
std::string csv_field(std::string_view text);
/// Text with everything that LaTeX reads as a command made harmless.
std::string latex_text(std::string_view text);
/// Text that stays in one cell of a Markdown table.
std::string markdown_text(std::string_view text);
/// The lines of a Markdown table whose cells are Markdown already.
std::string markdown_lines(std::span<const Column> columns, std::span<const std::vector<std::string>> rows);

}  // namespace gnomon
