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

constexpr std::size_t page_lines = 34;   // of small print, beside caption and rules, on a page in landscape
constexpr std::size_t page_width = 150;  // characters of small print across it
constexpr std::size_t held_floats = 40;  // printed together; LaTeX gives up when it holds more than 52
constexpr std::size_t least_text = 14;   // no column of words becomes narrower

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
    if (row.reason > 0 && column.name == "support") last += fmt::format("$^{{{}}}$", row.reason);
  }
  return lines;
}

/// Blanks between the columns of a row, with those around it.
std::size_t gaps_across(const Layout& layout) { return 2 * layout.columns.size(); }

/// Widths of the columns in characters, such that the whole fits the page: the widest columns of words give way.
std::vector<std::size_t> fitting_widths(const Layout& layout) {
  std::vector<std::size_t> widths, least;
  for (std::size_t i = 0; i < layout.columns.size(); ++i) {
    const Column& column = layout.columns[i];
    // Headings wrap at their blanks.
    std::size_t width = std::min<std::size_t>(display_width(column.heading), 8);
    width = std::max(width, display_width(column.shown_unit));
    for (const Layout::Group& group : layout.groups)
      for (const Layout::Row& row : group.rows) width = std::max(width, display_width(shown(column, row.cells[i])));
    widths.push_back(width);
    least.push_back(column.alignment == Align::left ? least_text : width);
  }
  shrink(widths, least, gaps_across(layout), page_width);
  return widths;
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

std::vector<Block> blocks_of(const Layout& layout, const std::vector<std::size_t>& widths) {
  std::vector<Block> blocks;
  for (const Layout::Group& group : layout.groups) {
    const auto open = [&](std::string_view remark) {
      Block& block = blocks.emplace_back();
      block.text = "    \\midrule\n";
      if (group.heading.empty()) return;
      block.text += fmt::format("    \\multicolumn{{{}}}{{@{{}}l}}{{\\emph{{{}{}}}}} \\\\\n", layout.columns.size(),
                                latex_text(group.heading), remark);
      block.lines = 1;
    };
    open("");
    for (const Layout::Row& row : group.rows) {
      const auto lines = lines_of(row, layout, widths);
      if (blocks.back().lines + lines.size() > page_lines) open(" (continued)");
      for (const auto& line : lines) blocks.back().text += fmt::format("    {} \\\\\n", joined(line, " & "));
      blocks.back().lines += lines.size();
    }
  }
  return blocks;
}

/// The bodies of the floats: as many blocks in each as its page holds.
std::vector<std::string> pages_of(std::span<const Block> blocks) {
  std::vector<std::string> pages{""};
  std::size_t used = 0;
  for (const Block& block : blocks) {
    if (used > 0 && used + block.lines > page_lines) {
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

std::string latex_table(const Layout& layout, const TableOptions& options) {
  const std::string& caption = options.caption.empty() ? layout.title : options.caption;
  const std::vector<std::size_t> widths = fitting_widths(layout);
  const std::vector<std::string> pages = pages_of(blocks_of(layout, widths)), below = lines_below(layout);
  std::string alignments;
  for (const Column& column : layout.columns) alignments += column.alignment == Align::right ? 'r' : 'l';
  const std::size_t across = std::accumulate(widths.begin(), widths.end(), gaps_across(layout));
  const std::string_view size = across <= page_width * 4 / 5 ? "footnotesize" : "scriptsize";
  std::string text = "% Needs \\usepackage{booktabs} and a page in landscape.\n";
  for (std::size_t page = 0; page < pages.size(); ++page) {
    const std::string part = pages.size() > 1 ? fmt::format(" ({} of {})", page + 1, pages.size()) : "";
    text += fmt::format("\\begin{{table}}[p]\n  \\centering\\{}\\setlength{{\\tabcolsep}}{{4pt}}\n", size);
    text += fmt::format("  \\caption{{{}{}}}\n", latex_text(caption), part);
    if (page == 0) text += fmt::format("  \\label{{{}}}\n", options.label);
    text += fmt::format("  \\begin{{tabular}}{{@{{}}{}@{{}}}}\n    \\toprule\n{}", alignments, head_lines(layout, widths));
    text += pages[page] + "    \\bottomrule\n  \\end{tabular}\n";
    const bool is_last = page + 1 == pages.size();
    if (is_last && !below.empty()) {
      // Lines of their own paragraph each would be a page of short lines.
      text += "\n  \\smallskip\\raggedright\n";
      for (const std::string& line : below) text += fmt::format("  {}.\n", line);
    }
    text += "\\end{table}\n";
    if (!is_last && (page + 1) % held_floats == 0) text += "\\clearpage\n";
  }
  return text;
}

}  // namespace gnomon
