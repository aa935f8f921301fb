#pragma once
#include <cstddef>
#include <set>
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

/// One line of text with a newline behind it; where it is longer than `width` it is wrapped, and indented from the second line
/// on. 0: no limit.
std::string wrapped_line(std::string_view text, std::size_t width);

/// Takes from the widest of the columns above their `least` width until all with the `gaps` fit, or no more can be taken.
void shrink(std::span<std::size_t> widths, std::span<const std::size_t> least, std::size_t gaps, std::size_t room);

/// Aligned text for the terminal: the one writer behind every list and table that is printed there.
class TextTable {
 public:
  struct Column {
    std::string heading;
    std::string unit;  ///< printed below the heading; no line of units when none has one
    Align align = Align::left;
    int spare = 0;  ///< where there is no room the columns with the highest go first; those with 0 stay
  };
  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// One cell per column. With fewer, `rest` runs on behind the last of them over the columns that are left.
  void add_row(std::vector<std::string> cells, std::string rest = "");
  /// A line of its own above the rows that follow, with a blank line before it.
  void add_heading(std::string text);

  /// Lines end in newlines and have no blanks before them. Unless `width` is 0, they fit, for which left-aligned columns are
  /// wrapped, the widest first; then spare columns are left out, which a line below names; then the columns that are left go on
  /// in further tables below, each with the first column. Numbers and words are never cut: lines are longer where two columns
  /// alone do not fit.
  std::string text(std::size_t width = 0) const;
  /// Numbers of the columns that a text of this width leaves out.
  std::vector<std::size_t> left_out(std::size_t width) const;

 private:
  struct HeadingOrRow {
    bool is_heading = false;
    std::vector<std::string> cells;  ///< of a row
    std::string rest;                ///< what runs on behind them; the text of a heading
  };
  /// By column: its width unwrapped, and the least that it can do with.
  struct Limits {
    std::vector<std::size_t> widest, least;
  };
  using Columns = std::vector<std::size_t>;  ///< numbers of columns, ascending

  Limits limits() const;
  bool fit(const Columns& shown, const Limits& limits, std::size_t width) const;
  Columns kept(const Limits& limits, std::size_t width) const;
  std::vector<Columns> dealt(const Columns& kept, const Limits& limits, std::size_t width) const;
  std::vector<std::size_t> widths(const Columns& shown, const Limits& limits, std::size_t width) const;
  std::string part(const Columns& shown, const Limits& limits, std::size_t width, bool is_first) const;

  std::vector<Column> columns_;
  std::vector<HeadingOrRow> rows_;
  std::set<std::size_t> filled_;  ///< how many cells rows have behind which a rest runs on
};

/// The rows of a table's head: headings, wrapped, which end on the line above the units.
std::vector<std::vector<std::string>> heading_rows(const std::vector<TextTable::Column>& columns,
                                                   const std::vector<std::size_t>& widths);

}  // namespace gnomon
