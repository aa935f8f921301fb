#include <array>

#include "report/layout.h"

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

std::string latex_table(const Layout& layout, const TableOptions& options) {
  std::string alignments, headings, units;
  for (const Column& column : layout.columns) {
    const bool is_first = alignments.empty();
    alignments += column.alignment == Align::right ? 'r' : 'l';
    headings += (is_first ? "" : " & ") + latex_text(column.heading);
    units += (is_first ? "" : " & ") + latex_text(column.shown_unit);
  }
  const std::string caption =
      options.caption.empty() ? "Cost and error of shadow techniques, by scene, light and view." : options.caption;
  std::string text = "% Needs \\usepackage{booktabs}.\n\\begin{table}\n  \\centering\n";
  text += fmt::format("  \\caption{{{}}}\n  \\label{{{}}}\n", latex_text(caption), options.label);
  text += fmt::format("  \\begin{{tabular}}{{{}}}\n    \\toprule\n    {} \\\\\n    {} \\\\\n", alignments, headings, units);

  for (const Layout::Group& group : layout.groups) {
    text += "    \\midrule\n";
    for (const Layout::Row& row : group.rows) {
      std::string line;
      for (std::size_t i = 0; i < row.entries.size(); ++i) {
        const Layout::Entry& entry = row.entries[i];
        std::string cell = entry.text == "-" ? "--" : latex_text(entry.text);
        if (entry.is_best) cell = "\\textbf{" + cell + "}";
        if (entry.is_flagged) cell += "$^\\dagger$";
        if (row.note > 0 && layout.columns[i].name == "support") cell += fmt::format("$^{{{}}}$", row.note);
        line += (i == 0 ? "" : " & ") + cell;
      }
      text += fmt::format("    {} \\\\\n", line);
    }
  }
  text += "    \\bottomrule\n  \\end{tabular}\n\n  \\smallskip\\footnotesize\n";
  for (std::size_t i = 0; i < layout.notes.size(); ++i)
    text += fmt::format("  $^{{{}}}$~{}.\n", i + 1, latex_text(layout.notes[i]));
  for (const auto& [mark, meaning] : legend(layout, "\\textbf{bold}", "$^\\dagger$"))
    text += fmt::format("  {}: {}.\n", mark == "-" ? "--" : mark, latex_text(meaning));
  for (const auto& [topic, what] : layout.provenance) text += fmt::format("  {}: {}.\n", latex_text(topic), latex_text(what));
  return text + "\\end{table}\n";
}

}  // namespace gnomon
