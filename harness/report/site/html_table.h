#pragma once
#include <string>
#include <vector>

#include "report/table/layout.h"

namespace gnomon::site {

/// A table in a page, which the page's script sorts by any column.
struct HtmlTable {
  struct Head {
    std::string text, unit = {};
    bool is_left = false;
  };
  struct Cell {
    std::string html;
    std::string sort =
        {};  ///< what it is sorted by: a number with a point, or a text; empty: a cell without a value, at the end
    bool is_left = false;
  };
  std::string caption;  ///< text, read out only
  std::vector<Head> heads;
  std::vector<std::vector<Cell>> rows;
  bool has_filter = false;  ///< a field above it for words that rows must have
  std::string name = {};    ///< in the address of the page, where it has several tables: letters

  std::string html() const;
};

HtmlTable::Cell text_html_cell(std::string_view text);
/// HTML sorted by a text.
HtmlTable::Cell linked_cell(std::string html, std::string_view sort);
/// As tables for people round it; a dash where there is none.
HtmlTable::Cell number_html_cell(const Column& column, const std::optional<double>& value, const std::string& title = "");

/// The table for people: group headings as lines, notes below.
std::string layout_html(const Layout& layout);

}  // namespace gnomon::site
