#pragma once
#include "report/table/columns.h"
#include "report/table/table.h"

namespace gnomon {

/// A table whose rows are not records: what analyses print. People and programs may get different columns.
struct Grid {
  enum class Audience { all, people, programs };
  struct Head {
    Column column;  ///< its `cell` is not used
    Audience audience = Audience::all;
  };
  struct Entry {
    Cell cell = {};
    bool is_best = false;
  };
  struct Group {
    std::string heading;                   ///< for people, above the rows; may be empty
    std::vector<std::vector<Entry>> rows;  ///< one entry per head
  };
  std::string title;
  std::vector<Head> heads;
  std::vector<Group> groups;
  std::vector<std::string> notes;                               ///< stand below the rows
  std::vector<std::pair<std::string, std::string>> provenance;  ///< the same, topic and text
};

/// Terminal, Markdown and LaTeX round, CSV and JSON do not; the JSON is of the same schema as the comparison table's.
std::string render_grid(const Grid& grid, Format format, const TableOptions& options = {});

}  // namespace gnomon
