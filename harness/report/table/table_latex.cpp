#include <array>

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

}  // namespace

std::string latex_text(std::string_view text) {
  std::string safe;
  while (!text.empty()) {
    std::size_t taken = 0;
    for (const auto& [from, to] : replacements)
      if (text.starts_with(from)) {
        safe += to;
        taken = from.size();
        break;
      }
    if (taken == 0) {
      safe += text.front();
      taken = 1;
    }
    text.remove_prefix(taken);
  }
  return safe;
}

namespace {

constexpr std::size_t page_lines = 34;   // of small print, beside caption and rules, on a page in landscape
constexpr std::size_t page_width = 150;  // characters of small print across it
constexpr std::size_t held_floats = 40;  // printed together; LaTeX gives up when it holds more than 52
constexpr std::size_t least_text = 14;   // no column of words becomes narrower

/// A row cut into lines: words wrap, numbers stand on the first.
std::vector<std::vector<std::string>> lines_of(const std::vector<LatexRows::Entry>& row, const std::vector<std::size_t>& widths,
                                               const std::vector<Column>& columns) {
  std::vector<std::vector<std::string>> lines;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const bool is_text = columns[i].alignment == Align::left;
    const std::vector<std::string> pieces = is_text ? wrap(row[i].text, widths[i]) : std::vector{row[i].text};
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (lines.size() <= k) lines.emplace_back(row.size());
      std::string cell = pieces[k] == "-" ? "--" : latex_text(pieces[k]);
      if (row[i].is_best && !cell.empty()) cell = "\\textbf{" + cell + "}";
      if (k + 1 == pieces.size()) cell += row[i].mark;
      lines[k][i] = std::move(cell);
    }
  }
  return lines;
}

/// Characters of a row with the gaps between its columns.
std::size_t width_across(const std::vector<std::size_t>& widths) {
  std::size_t sum = 0;
  for (const std::size_t width : widths) sum += width + 2;
  return sum;
}

/// Widths of the columns in characters, such that the whole fits the page: the widest columns of words give way.
std::vector<std::size_t> fitting_widths(const LatexRows& rows) {
  std::vector<std::size_t> widths;
  for (std::size_t i = 0; i < rows.columns.size(); ++i) {
    // Headings wrap at their blanks.
    std::size_t width = std::min<std::size_t>(display_width(rows.columns[i].heading), 8);
    width = std::max(width, display_width(rows.columns[i].shown_unit));
    for (const LatexRows::Group& group : rows.groups)
      for (const auto& row : group.rows) width = std::max(width, display_width(row[i].text));
    widths.push_back(width);
  }
  while (width_across(widths) > page_width) {
    std::size_t widest = widths.size();
    for (std::size_t i = 0; i < widths.size(); ++i)
      if (rows.columns[i].alignment == Align::left && widths[i] > least_text &&
          (widest == widths.size() || widths[i] > widths[widest]))
        widest = i;
    if (widest == widths.size()) break;
    --widths[widest];
  }
  return widths;
}

/// The head of every float: headings over units, wrapped at blanks, the last line on the bottom.
std::string head_lines(const LatexRows& rows, const std::vector<std::size_t>& widths) {
  std::vector<std::vector<std::string>> blocks;
  std::size_t height = 1;
  bool has_unit = false;
  for (std::size_t i = 0; i < rows.columns.size(); ++i) {
    blocks.push_back(wrap(rows.columns[i].heading, std::max<std::size_t>(widths[i], 8)));
    has_unit = has_unit || !rows.columns[i].shown_unit.empty();
    height = std::max(height, blocks.back().size());
  }
  std::string text;
  for (std::size_t line = 0; line < height + (has_unit ? 1 : 0); ++line) {
    text += "    ";
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::size_t above = height - blocks[i].size();
      std::string cell;
      if (line == height) {
        cell = rows.columns[i].shown_unit.empty() ? "" : fmt::format("[{}]", rows.columns[i].shown_unit);
      } else if (line >= above) {
        cell = blocks[i][line - above];
      }
      // A row that opened with a bracket would be read as an option of the line break above it.
      text += (i == 0 ? "{}" : " & ") + latex_text(cell);
    }
    text += " \\\\\n";
  }
  return text;
}

/// Lines of the body that stay together: a group with its heading, or a page of it.
struct Block {
  std::string text;
  std::size_t lines = 0;
};

std::vector<Block> blocks_of(const LatexRows& rows, const std::vector<std::size_t>& widths) {
  std::vector<Block> blocks;
  for (const LatexRows::Group& group : rows.groups) {
    const auto open = [&](std::string_view remark) {
      Block& block = blocks.emplace_back();
      block.text = "    \\midrule\n";
      if (group.heading.empty()) return;
      block.text += fmt::format("    \\multicolumn{{{}}}{{@{{}}l}}{{\\emph{{{}{}}}}} \\\\\n", rows.columns.size(),
                                latex_text(group.heading), remark);
      block.lines = 1;
    };
    open("");
    for (const auto& row : group.rows) {
      const auto lines = lines_of(row, widths, rows.columns);
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

}  // namespace

std::string latex_floats(const LatexRows& rows, const std::string& caption, const std::string& label) {
  const std::vector<std::size_t> widths = fitting_widths(rows);
  const std::vector<std::string> pages = pages_of(blocks_of(rows, widths));
  std::string alignments;
  for (const Column& column : rows.columns) alignments += column.alignment == Align::right ? 'r' : 'l';
  const std::string_view size = width_across(widths) <= page_width * 4 / 5 ? "footnotesize" : "scriptsize";
  std::string text = "% Needs \\usepackage{booktabs} and a page in landscape.\n";
  for (std::size_t page = 0; page < pages.size(); ++page) {
    const std::string part = pages.size() > 1 ? fmt::format(" ({} of {})", page + 1, pages.size()) : "";
    text += fmt::format("\\begin{{table}}[p]\n  \\centering\\{}\\setlength{{\\tabcolsep}}{{4pt}}\n", size);
    text += fmt::format("  \\caption{{{}{}}}\n", latex_text(caption), part);
    if (page == 0) text += fmt::format("  \\label{{{}}}\n", label);
    text += fmt::format("  \\begin{{tabular}}{{@{{}}{}@{{}}}}\n    \\toprule\n{}", alignments, head_lines(rows, widths));
    text += pages[page] + "    \\bottomrule\n  \\end{tabular}\n";
    const bool is_last = page + 1 == pages.size();
    if (is_last && !rows.notes.empty()) {
      // Notes of their own paragraph each would be a page of short lines.
      text += "\n  \\smallskip\\raggedright\n";
      for (const std::string& note : rows.notes) text += fmt::format("  {}.\n", note);
    }
    text += "\\end{table}\n";
    if (!is_last && (page + 1) % held_floats == 0) text += "\\clearpage\n";
  }
  return text;
}

std::string latex_table(const Layout& layout, const TableOptions& options) {
  LatexRows rows;
  rows.columns = layout.columns;
  const auto leads = [&](std::string_view name) {
    return std::any_of(layout.columns.begin(), layout.columns.end(), [&](const Column& c) { return c.name == name; });
  };
  for (const Layout::Group& group : layout.groups) {
    LatexRows::Group& made = rows.groups.emplace_back();
    if (!leads("scene")) made.heading = group.heading;
    for (const Layout::Row& row : group.rows) {
      std::vector<LatexRows::Entry>& cells = made.rows.emplace_back();
      for (std::size_t i = 0; i < row.entries.size(); ++i) {
        const Layout::Entry& entry = row.entries[i];
        std::string mark = entry.is_flagged ? "$^\\dagger$" : "";
        if (row.note > 0 && layout.columns[i].name == "support") mark += fmt::format("$^{{{}}}$", row.note);
        cells.push_back({entry.text, entry.is_best, std::move(mark)});
      }
    }
  }
  for (std::size_t i = 0; i < layout.notes.size(); ++i)
    rows.notes.push_back(fmt::format("$^{{{}}}$~{}", i + 1, latex_text(layout.notes[i])));
  for (const auto& [mark, meaning] : legend(layout, "\\textbf{bold}", "$^\\dagger$"))
    rows.notes.push_back(fmt::format("{}: {}", mark == "-" ? "--" : mark, latex_text(meaning)));
  for (const auto& [topic, what] : layout.provenance)
    rows.notes.push_back(fmt::format("{}: {}", latex_text(topic), latex_text(what)));
  const std::string caption =
      options.caption.empty() ? "Cost and error of shadow techniques, by scene, light and view." : options.caption;
  return latex_floats(rows, caption, options.label);
}

}  // namespace gnomon
