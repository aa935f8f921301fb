#include <algorithm>
#include <array>
#include <numeric>

#include "report/table/layout.h"

namespace gnomon {

namespace {

/// What LaTeX reads as commands, what the old text encoding prints as another sign, and the signs our own text uses.
constexpr std::array<std::pair<std::string_view, std::string_view>, 25> replacements{{
    {"->", R"($\rightarrow$)"},
    {"\\", R"(\textbackslash{})"},
    {"{", R"(\{)"},
    {"}", R"(\})"},
    {"_", R"(\_)"},
    {"%", R"(\%)"},
    {"&", R"(\&)"},
    {"#", R"(\#)"},
    {"$", R"(\$)"},
    {"~", R"(\textasciitilde{})"},
    {"^", R"(\textasciicircum{})"},
    {"<", "$<$"},
    {">", "$>$"},
    {"|", "$|$"},
    {"\"", "''"},
    {"±", R"($\pm$)"},
    {"×", R"($\times$)"},
    {"·", R"($\cdot$)"},
    {"°", R"($^\circ$)"},
    {"µ", R"($\mu$)"},
    {"μ", R"($\mu$)"},
    {"≤", R"($\leq$)"},
    {"≥", R"($\geq$)"},
    {"→", R"($\rightarrow$)"},
    {"\n", " "},
}};

/// What a float takes, in lines and characters of small print. A character is reckoned as 4.9 pt, a fifth more than most are.
struct FloatRoom {
  std::string_view of;           ///< what the document needs, beside booktabs
  std::string_view environment;  ///< of the float
  std::string_view place;
  std::size_t width;
  std::size_t heading;  ///< characters in a line above a group
  std::size_t lines;    ///< beside caption and rules
};
// In the order of Paper. Of the usual classes article has the narrowest columns, on A4.
constexpr FloatRoom rooms[] = {{"a page in landscape", "table", "p", 150, std::string::npos, 34},
                               {"452 pt across both columns of a page", "table*", "tp", 92, 74, 52},
                               {"a column of 220 pt", "table", "tp", 45, 36, 52}};
const FloatRoom& room_of(Paper paper) { return rooms[static_cast<std::size_t>(paper)]; }

constexpr std::size_t held_floats = 40;  // printed together; LaTeX gives up when it holds more than 52
constexpr std::size_t least_text = 14;   // no column of words becomes narrower, but one of short words
constexpr std::size_t least_word = 6;

/// The column whose cells name the reason of a row.
std::size_t reason_column(const Layout& layout) {
  const auto support = std::ranges::find(layout.columns, "support", &Column::name);
  return support == layout.columns.end() ? 0 : static_cast<std::size_t>(support - layout.columns.begin());
}

/// A row cut into lines: words wrap, numbers are on the first.
std::vector<std::vector<std::string>> lines_of(const Layout::Row& row, const Layout& layout,
                                               const std::vector<std::size_t>& widths) {
  std::vector<std::vector<std::string>> lines;
  for (std::size_t i = 0; i < row.cells.size(); ++i) {
    const Column& column = layout.columns[i];
    const std::string text = shown(column, row.cells[i]);
    const std::vector<std::string> pieces = column.alignment == Align::left ? wrap(text, widths[i]) : std::vector{text};
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (lines.size() <= k) lines.emplace_back(row.cells.size());
      std::string& cell = lines[k][i];
      cell = pieces[k] == "-" ? "--" : latex_text(pieces[k]);
      if (row.cells[i].is_best && !cell.empty()) cell = "\\textbf{" + cell + "}";
    }
    std::string& last = lines[pieces.size() - 1][i];
    if (row.cells[i].is_floored) last += "$^\\circ$";
    if (row.cells[i].is_flagged) last += "$^\\dagger$";
    if (row.reason > 0 && i == reason_column(layout)) last += fmt::format("$^{{{}}}$", row.reason);
  }
  return lines;
}

/// Blanks between the columns of a row, with those around it.
std::size_t gaps_across(const Layout& layout) { return 2 * layout.columns.size(); }

/// Widths of the columns in characters, such that the whole fits the room: the widest columns of words give way, where no
/// other can go down to their longest word.
std::vector<std::size_t> fitting_widths(const Layout& layout, const FloatRoom& room) {
  std::vector<std::size_t> widths, least, words;
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    const Column& column = layout.columns[i];
    // Headings wrap at their blanks.
    std::size_t width = std::min<std::size_t>(display_width(column.heading), 8);
    width = std::max(width, display_width(column.shown_unit));
    std::size_t word = least_word;
    for (const Layout::Group& group : layout.groups)
      for (const Layout::Row& row : group.rows) {
        const std::string text = shown(column, row.cells[i]);
        width = std::max(width, display_width(text));
        for (const std::string& piece : wrap(text, least_word)) word = std::max(word, display_width(piece));
      }
    const bool is_words = column.alignment == Align::left;
    widths.push_back(width);
    least.push_back(is_words ? least_text : width);
    words.push_back(is_words ? std::min(word, least_text) : width);
  }
  shrink(widths, least, gaps_across(layout), room.width);
  const bool has_spare = std::ranges::any_of(layout.columns, [](const Column& column) { return column.spare > 0; });
  const bool is_landscape = room.heading == std::string::npos;  // where a table may be wider
  if (!has_spare && !is_landscape) shrink(widths, words, gaps_across(layout), room.width);
  return widths;
}

/// Characters across, gaps included.
std::size_t across(const Layout& layout, std::span<const std::size_t> widths) {
  return std::accumulate(widths.begin(), widths.end(), gaps_across(layout));
}

/// The head of every float: headings over units, wrapped at blanks, the last line on the bottom.
std::string head_lines(const Layout& layout, std::vector<std::size_t> widths) {
  std::vector<TextTable::Column> columns;
  for (const Column& column : layout.columns)
    columns.push_back({column.heading, column.shown_unit.empty() ? "" : fmt::format("[{}]", column.shown_unit)});
  for (std::size_t& width : widths) width = std::max<std::size_t>(width, 8);
  std::string text;
  for (const std::vector<std::string>& cells : heading_rows(columns, widths)) {
    text += "    ";
    // A row that opened with a bracket would be read as an option of the line break above it.
    for (std::size_t i = 0; i < cells.size(); ++i) text += (i == 0 ? "{}" : " & ") + latex_text(cells[i]);
    text += " \\\\\n";
  }
  return text;
}

/// Lines of the body that stay together: a group with its heading, or a page of it.
struct Block {
  std::string text;
  std::size_t lines = 0;
};

std::vector<Block> blocks_of(const Layout& layout, const std::vector<std::size_t>& widths, const FloatRoom& room,
                             std::size_t most) {
  std::vector<Block> blocks;
  for (const Layout::Group& group : layout.groups) {
    const auto open = [&](std::string_view remark) {
      Block& block = blocks.emplace_back();
      block.text = "    \\midrule\n";
      if (group.heading.empty()) return;
      for (const std::string& piece : wrap(fmt::format("{}{}", group.heading, remark), room.heading)) {
        block.text +=
            fmt::format("    \\multicolumn{{{}}}{{@{{}}l}}{{\\emph{{{}}}}} \\\\\n", layout.columns.size(), latex_text(piece));
        ++block.lines;
      }
    };
    open("");
    for (const Layout::Row& row : group.rows) {
      const auto lines = lines_of(row, layout, widths);
      if (blocks.back().lines + lines.size() > most) open(" (continued)");
      for (const auto& line : lines) blocks.back().text += fmt::format("    {} \\\\\n", joined(line, " & "));
      blocks.back().lines += lines.size();
    }
  }
  return blocks;
}

/// The bodies of the floats: as many blocks in each as its page holds.
std::vector<std::string> pages_of(std::span<const Block> blocks, std::size_t most) {
  std::vector<std::string> pages{""};
  std::size_t used = 0;
  for (const Block& block : blocks) {
    if (used > 0 && used + block.lines > most) {
      pages.emplace_back();
      used = 0;
    }
    pages.back() += block.text;
    used += block.lines + 1;  // the rule
  }
  return pages;
}

/// The lines below the last float, in LaTeX.
std::vector<std::string> lines_below(const Layout& layout) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < layout.reasons.size(); ++i)
    lines.push_back(fmt::format("$^{{{}}}$~{}", i + 1, latex_text(layout.reasons[i])));
  for (const auto& [mark, meaning] : legend(layout, {"\\textbf{bold}", "$^\\circ$", "$^\\dagger$"}))
    lines.push_back(fmt::format("{}: {}", mark == "-" ? "--" : mark, latex_text(meaning)));
  for (const std::string& note : layout.notes) lines.push_back(latex_text(note));
  for (const auto& [topic, what] : layout.provenance)
    lines.push_back(fmt::format("{}: {}", latex_text(topic), latex_text(what)));
  return lines;
}

/// Lines of their own paragraph each would be a page of short lines.
std::string paragraph_of(std::span<const std::string> lines) {
  std::string text = lines.empty() ? "" : "\n  \\smallskip\\raggedright\n";
  for (const std::string& line : lines) text += fmt::format("  {}.\n", line);
  return text;
}

}  // namespace

std::string latex_text(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    const auto* const found = std::ranges::find_if(replacements, [&](const auto& one) { return text.starts_with(one.first); });
    const bool is_plain = found == replacements.end();
    safe += is_plain ? text.substr(0, 1) : found->second;
    text.remove_prefix(is_plain ? 1 : found->first.size());
  }
  return safe;
}

std::vector<std::string> left_out_on_paper(Layout layout, Paper paper) {
  const FloatRoom& room = room_of(paper);
  std::vector<std::string> left_out;
  if (paper == Paper::landscape) return left_out;
  while (across(layout, fitting_widths(layout, room)) > room.width) {
    const int most = std::ranges::max(layout.columns, {}, &Column::spare).spare;
    if (most == 0) break;
    for (const Column& column : layout.columns)
      if (column.spare == most) left_out.push_back(column.name);
    remove_columns(layout, [&](const Column& column) { return column.spare == most; });
  }
  return left_out;
}

std::string latex_table(const Layout& layout, const TableOptions& options) {
  const FloatRoom& room = room_of(options.paper);
  const bool is_wide = options.paper == Paper::landscape;
  const std::string& caption = options.caption.empty() ? layout.title : options.caption;
  const std::vector<std::size_t> widths = fitting_widths(layout, room);
  const std::size_t characters = across(layout, widths);
  if (!is_wide && characters > room.width)
    throw Error("--fit {} has room for {} characters, and the {} columns take {}; choose fewer, or --fit landscape",
                options.paper == Paper::column ? "column" : "page", room.width, layout.columns.size(), characters);
  const std::vector<std::string> below = lines_below(layout);
  const std::size_t below_lines = 1 + joined(below, " ").size() / room.width;
  // Lines below that are longer than the half of a page follow the last float as text.
  const bool is_apart = !is_wide && below_lines > room.lines / 2;
  const std::size_t most = is_wide || is_apart ? room.lines : room.lines - below_lines;
  const std::vector<std::string> pages = pages_of(blocks_of(layout, widths, room, most), most);
  std::string alignments;
  for (const Column& column : layout.columns) alignments += column.alignment == Align::right ? 'r' : 'l';
  const std::string_view size = characters <= room.width * 4 / 5 ? "footnotesize" : "scriptsize";
  std::string text = fmt::format("% Needs \\usepackage{{booktabs}} and {}.\n", room.of);
  for (std::size_t page = 0; page < pages.size(); ++page) {
    const std::string part = pages.size() > 1 ? fmt::format(" ({} of {})", page + 1, pages.size()) : "";
    text += fmt::format("\\begin{{{}}}[{}]\n  \\centering\\{}\\setlength{{\\tabcolsep}}{{4pt}}\n", room.environment, room.place,
                        size);
    text += fmt::format("  \\caption{{{}{}}}\n", latex_text(caption), part);
    if (page == 0) text += fmt::format("  \\label{{{}}}\n", options.label);
    text += fmt::format("  \\begin{{tabular}}{{@{{}}{}@{{}}}}\n    \\toprule\n{}", alignments, head_lines(layout, widths));
    text += pages[page] + "    \\bottomrule\n  \\end{tabular}\n";
    const bool is_last = page + 1 == pages.size();
    if (is_last && !is_apart) text += paragraph_of(below);
    text += fmt::format("\\end{{{}}}\n", room.environment);
    if (!is_last && (page + 1) % held_floats == 0) text += "\\clearpage\n";
  }
  if (is_apart) text += fmt::format("{{\\{}{}\\par}}\n", size, paragraph_of(below));
  return text;
}

}  // namespace gnomon
