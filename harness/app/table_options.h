#pragma once
#include "app/command_line.h"
#include "report/table/table.h"

namespace gnomon::app {

/// How wide the tables are that a command prints for people.
struct TableWidth {
  int given = 0;         ///< --width; 0: not given
  bool is_wide = false;  ///< --wide

  /// Columns that a line may take: those that are given, else those of the terminal on stdout. 0, no limit, for wide tables and
  /// where there is no terminal. COLUMNS in the environment replaces what a terminal says of itself.
  std::size_t columns() const;
};

/// Adds --width and --wide.
void add_width_options(Command& command, TableWidth& width);

/// Adds the options of tables in LaTeX; `paper` gets the word for a Paper.
void add_paper_options(Command& command, TableOptions& table, std::string& paper);

}  // namespace gnomon::app
