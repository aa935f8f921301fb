#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon {

enum class Align { left, right };

/// Columns that UTF-8 text takes on a terminal. Every code point counts as one, combining marks as none: enough for the
/// signs and European names that our text holds.
std::size_t display_width(std::string_view text);

/// `text` broken into lines of at most `width` columns, at blanks and after commas and colons; a longer word is cut.
std::vector<std::string> wrap(std::string_view text, std::size_t width);

/// Takes from the widest of the columns above their `least` width until all with the `gaps` fit, or no more can be taken.
void shrink(std::vector<std::size_t>& widths, std::span<const std::size_t> least, std::size_t gaps, std::size_t room);

/// Aligned text for the terminal: the one writer behind every list and table that is printed there.
class TextTable {
 public:
  struct Column {
    std::string heading;
    std::string unit;  ///< printed below the heading; no line of units when none has one
    Align align = Align::left;
  };
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell per column. With fewer, `rest` runs on behind the last of them over the columns that are left.
  void add_row(std::vector<std::string> cells, std::string rest = "");
  /// A line of its own above the rows that follow, with a blank line before it.
  void add_heading(std::string text);

  /// Lines end in newlines and have no blanks before them. Unless `width` is 0, left-aligned columns are wrapped, the widest
  /// first, until lines fit or words would be cut; numbers never are.
  std::string text(std::size_t width = 0) const;

 private:
  struct HeadingOrRow {
    bool is_heading = false;
    std::vector<std::string> cells;  ///< of a row
    std::string rest;                ///< what runs on behind them; the text of a heading
  };
  std::vector<std::size_t> widths(std::size_t width) const;

  std::vector<Column> columns_;
  std::vector<HeadingOrRow> rows_;
};

/// The rows of a table's head: headings, wrapped, which end on the line above the units.
std::vector<std::vector<std::string>> heading_rows(const std::vector<TextTable::Column>& columns,
                                                   const std::vector<std::size_t>& widths);

}  // namespace gnomon
