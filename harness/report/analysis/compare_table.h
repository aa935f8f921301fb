#pragma once
#include "analysis/compare.h"
#include "report/table/table.h"

namespace gnomon {

struct CompareTableOptions {
  std::string base = {}, contender = {};  ///< where the records come from, as the user named it
  bool all = false;                       ///< rows and times that do not differ, too
  std::size_t width = 0;                  ///< columns of the terminal; 0: no limit
  bool over_all = false;                  ///< for people: only what is over all scenes
};

/// A comparison for people (terminal, Markdown: what differs, unless all is requested) or for programs (CSV, JSON: everything,
/// unrounded). Throws Error on LaTeX.
std::string render_comparison(const Comparison& comparison, Format format, const CompareTableOptions& options);

/// One line for each row, each stage and each changed metric.
std::string comparison_csv(const Comparison& comparison);
std::string comparison_json(const Comparison& comparison, const CompareTableOptions& options);

/// One line: how many rows and times, and what became of them.
std::string summary_line(const Comparison& comparison);

}  // namespace gnomon
