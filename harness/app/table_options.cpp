#include "app/table_options.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <charconv>
#include <cstdlib>

namespace gnomon::app {

namespace {

/// COLUMNS in the environment; 0 where it is no whole number above 0.
std::size_t columns_of_environment() {
  const char* const value = std::getenv("COLUMNS");
  const std::string_view text(value ? value : "");
  std::size_t columns = 0;
  const auto [rest, code] = std::from_chars(text.data(), text.data() + text.size(), columns);
  return code == std::errc{} && rest == text.data() + text.size() ? columns : 0;
}

}  // namespace

std::size_t TableWidth::columns() const {
  if (is_wide) return 0;
  if (given > 0) return static_cast<std::size_t>(given);
  winsize window{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) != 0) return 0;
  const std::size_t columns = columns_of_environment();
  return columns > 0 ? columns : window.ws_col;
}

void add_width_options(Command& command, TableWidth& width) {
  CLI::Option* const wide =
      command.flag("--wide", &width.is_wide, "Lines of any length: no column is left out or goes on below");
  command.option("--width", &width.given, "Columns that a line takes at most; those of the terminal, else no limit",
                 {.check = whole_in(20, 10000), .excludes = wide});
}

void add_paper_options(Command& command, TableOptions& table, std::string& paper) {
  command.option("--fit", &paper,
                 "LaTeX: a page in landscape, or both columns of a page (table*), or one column: landscape | page | column");
  command.option("--caption", &table.caption, "LaTeX: caption of the table");
  command.option("--label", &table.label, "LaTeX: label of the table", {.check = not_empty()});
}

}  // namespace gnomon::app
