#include "report/table/text_table.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace gnomon {

namespace {

constexpr std::size_t gap = 2;           // blanks between columns
constexpr std::size_t least_width = 16;  // text is not wrapped narrower than this,
constexpr std::size_t whole_width = 32;  // nor its pieces cut while they are no longer than this
constexpr std::string_view breaks = " ,:";

bool continues(unsigned char byte) { return (byte & 0xc0) == 0x80; }

/// U+0300 .. U+036F, combining diacritical marks: CC 80 .. CD AF.
bool is_combining(unsigned char lead, unsigned char next) { return lead == 0xcc || (lead == 0xcd && next < 0xb0); }

/// Bytes of the longest start of `text` that fits into `width` columns; at least one code point.
std::size_t fitting(std::string_view text, std::size_t width) {
  std::size_t end = 0;
  while (end < text.size()) {
    std::size_t next = end + 1;
    while (next < text.size() && continues(static_cast<unsigned char>(text[next]))) ++next;
    if (end > 0 && display_width(text.substr(0, next)) > width) break;
    end = next;
  }
  return end;
}

/// Width of the longest piece of `text` that `wrap` leaves whole.
std::size_t longest_piece(std::string_view text) {
  std::size_t longest = 0;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of(breaks), next = end == text.npos ? text.size() : end + 1;
    const bool ends_in_blank = end != text.npos && text[end] == ' ';
    longest = std::max(longest, display_width(text.substr(0, ends_in_blank ? end : next)));
    text.remove_prefix(next);
  }
  return longest;
}

void pad_to(std::string& line, std::size_t width) {
  const std::size_t now = display_width(line);
  if (now < width) line.append(width - now, ' ');
}

void finish_line(std::string& all, std::string& line) {
  line.erase(line.find_last_not_of(' ') + 1);
  all += line + '\n';
  line.clear();
}

}  // namespace

std::size_t display_width(std::string_view text) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if (continues(byte)) continue;
    width += i + 1 == text.size() || !is_combining(byte, static_cast<unsigned char>(text[i + 1]));
  }
  return width;
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  while (display_width(text) > width) {
    const std::size_t fits = fitting(text, width);
    // The last blank at or before the end of what fits, or the place behind the last comma or colon in it.
    std::size_t end = text.rfind(' ', fits), next = end + 1;
    if (const std::size_t sign = text.substr(0, fits).find_last_of(breaks);
        sign != text.npos && (end == text.npos || sign > end))
      end = next = sign + 1;
    if (end == text.npos || end == 0) end = next = fits;
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(next, text.size()));
    while (text.starts_with(' ')) text.remove_prefix(1);
  }
  if (!text.empty() || lines.empty()) lines.emplace_back(text);
  return lines;
}

std::string wrapped_line(std::string_view text, std::size_t width) {
  constexpr std::string_view indent = "  ";
  if (width == 0 || display_width(text) <= width) return fmt::format("{}\n", text);
  std::string all;
  for (const std::string& line : wrap(text, std::max(width, indent.size() + 1) - indent.size()))
    all += fmt::format("{}{}\n", all.empty() ? "" : indent, line);
  return all;
}

std::vector<std::vector<std::string>> heading_rows(const std::vector<TextTable::Column>& columns,
                                                   const std::vector<std::size_t>& widths) {
  std::vector<std::vector<std::string>> blocks;  // by column: its lines
  std::size_t height = 0;
  const bool has_unit = std::any_of(columns.begin(), columns.end(), [](const auto& column) { return !column.unit.empty(); });
  for (std::size_t i = 0; i < columns.size(); ++i) {
    blocks.push_back(wrap(columns[i].heading, std::max<std::size_t>(widths[i], 1)));
    if (has_unit) blocks.back().push_back(columns[i].unit);
    height = std::max(height, blocks.back().size());
  }
  std::vector<std::vector<std::string>> rows(height, std::vector<std::string>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    for (std::size_t line = 0; line < blocks[i].size(); ++line)
      rows[height - blocks[i].size() + line][i] = std::move(blocks[i][line]);
  return rows;
}

void shrink(std::span<std::size_t> widths, std::span<const std::size_t> least, std::size_t gaps, std::size_t room) {
  for (std::size_t total = std::accumulate(widths.begin(), widths.end(), gaps); total > room; --total) {
    std::size_t widest = widths.size();
    for (std::size_t i = 0; i < widths.size(); ++i)
      if (widths[i] > least[i] && (widest == widths.size() || widths[i] > widths[widest])) widest = i;
    if (widest == widths.size()) return;
    --widths[widest];
  }
}

void TextTable::add_row(std::vector<std::string> cells, std::string rest) {
  assert(cells.size() == columns_.size() || (cells.size() < columns_.size() && !rest.empty()));
  if (!rest.empty()) filled_.insert(cells.size());
  rows_.push_back({false, std::move(cells), std::move(rest)});
}

void TextTable::add_heading(std::string text) { rows_.push_back({true, {}, std::move(text)}); }

TextTable::Limits TextTable::limits() const {
  Limits limits;
  for (std::size_t i = 0; i < columns_.size(); ++i) {
    std::size_t widest = std::max(longest_piece(columns_[i].heading), display_width(columns_[i].unit)), least = least_width;
    for (const HeadingOrRow& row : rows_) {
      if (i >= row.cells.size()) continue;
      widest = std::max(widest, display_width(row.cells[i]));
      least = std::max(least, std::min(longest_piece(row.cells[i]), whole_width));
    }
    limits.widest.push_back(widest);
    // Numbers stay whole.
    limits.least.push_back(columns_[i].align == Align::right ? widest : std::min(least, widest));
  }
  return limits;
}

/// Whether these columns and what runs on behind them have room beside one another.
bool TextTable::fit(const Columns& shown, const Limits& limits, std::size_t width) const {
  const auto end_of = [&](std::size_t count) {
    std::size_t end = 0;
    for (const std::size_t i : shown)
      if (i < count) end += limits.least[i] + gap;
    return end;
  };
  return end_of(columns_.size()) <= width + gap &&
         std::ranges::all_of(filled_, [&](std::size_t count) { return end_of(count) + least_width <= width; });
}

/// The columns without those that are left out.
TextTable::Columns TextTable::kept(const Limits& limits, std::size_t width) const {
  Columns shown(columns_.size());
  std::iota(shown.begin(), shown.end(), std::size_t{0});
  while (width > 0 && !fit(shown, limits, width)) {
    int most = 0;
    for (const std::size_t i : shown) most = std::max(most, columns_[i].spare);
    if (most == 0) break;
    std::erase_if(shown, [&](std::size_t i) { return columns_[i].spare == most; });
  }
  return shown;
}

/// The columns of each of the tables that are below one another.
std::vector<TextTable::Columns> TextTable::dealt(const Columns& kept, const Limits& limits, std::size_t width) const {
  std::vector<Columns> parts(1);
  for (const std::size_t i : kept) {
    Columns longer = parts.back();
    longer.push_back(i);
    if (width == 0 || longer.size() <= 2 || fit(longer, limits, width))
      parts.back() = std::move(longer);
    else
      parts.push_back({kept.front(), i});
  }
  return parts;
}

std::vector<std::size_t> TextTable::widths(const Columns& shown, const Limits& limits, std::size_t width) const {
  std::vector<std::size_t> result, least;
  for (const std::size_t i : shown) {
    result.push_back(limits.widest[i]);
    least.push_back(limits.least[i]);
  }
  if (width == 0 || shown.empty()) return result;
  shrink(result, least, gap * (shown.size() - 1), width);
  for (const std::size_t filled : filled_) {
    const auto before = static_cast<std::size_t>(std::ranges::count_if(shown, [&](std::size_t i) { return i < filled; }));
    shrink(std::span(result).first(before), least, gap * before, std::max(width, least_width) - least_width);
  }
  return result;
}

/// A table of these columns. What runs on behind cells is in the first one alone.
std::string TextTable::part(const Columns& shown, const Limits& limits, std::size_t width, bool is_first) const {
  const std::vector<std::size_t> column_widths = widths(shown, limits, width);
  std::vector<std::size_t> starts{0};
  for (const std::size_t column : column_widths) starts.push_back(starts.back() + column + gap);

  std::string all, line;
  const auto write_row = [&](std::span<const std::string> cells, const std::string& rest) {
    std::vector<std::vector<std::string>> blocks;
    std::size_t height = 1;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      blocks.push_back(wrap(cells[i], std::max<std::size_t>(column_widths[i], 1)));
      height = std::max(height, blocks.back().size());
    }
    if (!rest.empty()) {
      const std::size_t start = starts[cells.size()];
      const std::size_t room = width == 0 ? std::string::npos : std::max(width, start + least_width) - start;
      blocks.push_back(wrap(rest, room));
      height = std::max(height, blocks.back().size());
    }
    for (std::size_t l = 0; l < height; ++l) {
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (l >= blocks[i].size()) continue;
        const std::string& piece = blocks[i][l];
        const bool is_right = i < cells.size() && columns_[shown[i]].align == Align::right;
        pad_to(line, starts[i] + (is_right ? column_widths[i] - display_width(piece) : 0));
        line += piece;
      }
      finish_line(all, line);
    }
  };

  std::vector<Column> heads;
  for (const std::size_t i : shown) heads.push_back(columns_[i]);
  for (const std::vector<std::string>& cells : heading_rows(heads, column_widths)) write_row(cells, "");
  if (!shown.empty()) all += std::string(starts.back() - gap, '-') + '\n';
  for (const HeadingOrRow& row : rows_) {
    if (row.is_heading) {
      all += '\n';
      for (const std::string& piece : wrap(row.rest, width > 0 ? width : std::string::npos)) all += piece + '\n';
      continue;
    }
    std::vector<std::string> cells;
    for (const std::size_t i : shown)
      if (i < row.cells.size()) cells.push_back(row.cells[i]);
    if (is_first || cells.size() > 1) write_row(cells, is_first ? row.rest : "");
  }
  return all;
}

std::vector<std::size_t> TextTable::left_out(std::size_t width) const {
  const Columns shown = kept(limits(), width);
  Columns missing;
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (!std::ranges::binary_search(shown, i)) missing.push_back(i);
  return missing;
}

std::string TextTable::text(std::size_t width) const {
  const Limits all_limits = limits();
  std::string all;
  for (const Columns& shown : dealt(kept(all_limits, width), all_limits, width)) {
    if (!all.empty()) all += '\n';
    all += part(shown, all_limits, width, all.empty());
  }
  if (width == 0) return all;
  std::vector<std::string> missing;
  for (const std::size_t i : left_out(width)) missing.push_back(columns_[i].heading);
  if (!missing.empty())
    all += wrapped_line(fmt::format("left out for want of room: {}; --wide shows all", joined(missing, ", ")), width);
  return all;
}

}  // namespace gnomon
