#pragma once
#include <utility>

#include "report/table/columns.h"
#include "report/table/table.h"

namespace gnomon {

/// Lines below a table: topic or mark, and text.
using Remarks = std::vector<std::pair<std::string, std::string>>;

/// A table before it takes a form: groups of rows, marks of cells, lines below the rows.
struct Layout {
  struct Row {
    std::vector<Cell> cells = {};    ///< one per column
    const Record* record = nullptr;  ///< that it shows; rows of analyses show none
    std::size_t reason = 0;          ///< number of the record's reason, from 1; 0: nothing to say
  };
  struct Group {
    std::string heading = {};  ///< for people, a line above the rows; may be empty
    std::vector<Row> rows = {};
  };
  std::string title = {};  ///< in JSON a table with a title has notes, too
  std::vector<Column> columns = {};
  std::vector<Group> groups = {};
  std::vector<std::string> reasons = {};  ///< of records, each once
  std::string best = "best";              ///< what the mark of the best means
  Remarks shorthands = {};                ///< other signs that occur
  std::vector<std::string> notes = {};
  Remarks provenance = {};
};

/// Terminal, Markdown and LaTeX round, CSV and JSON do not. The audience decides on the columns.
std::string render_layout(Layout layout, Format format, const TableOptions& options = {});

/// The columns for people unless others are named. With `with_group` scene and light lead, and view, size and truth
/// where they vary; without, the group's heading says them.
std::vector<std::string> headline_columns(std::span<const Record> records, bool with_group);

/// Those of a table on paper, where a line above each group says scene, light and view: what fits across a page.
std::vector<std::string> paper_columns(std::span<const Record> records);

/// A row in these columns.
Layout::Row row_of(const Record& record, std::span<const Column> columns);

/// Records in groups by scene, light and view; groups and rows keep their order. `columns` by name.
Layout lay_out(std::span<const Record> records, std::span<const std::string> columns);

/// What the records say of where they were made, "-" where they do not say.
Remarks provenance(std::span<const Record> records);

/// How a form marks cells.
struct Marks {
  std::string_view best, floored, flagged;
};
/// The marks and shorthands that occur in this table, explained.
Remarks legend(const Layout& layout, const Marks& marks);

// The forms, of columns that their audience sees.
std::string terminal_table(const Layout& layout, std::size_t width);
std::string markdown_table(const Layout& layout);
/// As many floats as the rows need where the options put them, each with booktabs only; a group is cut between two of them only
/// when it is longer than a page. Long texts wrap into further lines. Throws Error when one or both columns of a page have no
/// room for the columns; a page in landscape takes them as they are.
std::string latex_table(const Layout& layout, const TableOptions& options);
std::string csv_table(const Layout& layout);
/// Its first line, and that of a row.
std::string csv_heads(std::span<const Column> columns);
std::string csv_line(std::span<const Cell> cells);
std::string json_table(const Layout& layout);

/// Names of the spare columns for which there is no room: in so many columns of a terminal, and where a table on paper goes.
std::vector<std::string> left_out_on_terminal(const Layout& layout, std::size_t width);
std::vector<std::string> left_out_on_paper(Layout layout, Paper paper);
/// Takes columns and their cells out.
void remove_columns(Layout& layout, const std::function<bool(const Column&)>& is_removed);

/// A field of RFC 4180: quoted when it contains a comma, a quote or a line break, quotes doubled.
std::string csv_field(std::string_view text);
/// Text with everything that LaTeX reads as a command made harmless.
std::string latex_text(std::string_view text);
/// Text that stays in one cell of a Markdown table.
std::string markdown_text(std::string_view text);

}  // namespace gnomon
