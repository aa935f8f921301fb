#pragma once
#include <filesystem>

#include "report/analysis/analysis_table.h"

namespace gnomon {

struct FigureOptions {
  AnalysisOptions analysis = {};
  Cost bars = Cost::geometry;             ///< stages: what a bar is the sum of
  std::vector<std::string> metrics = {};  ///< sweep: several quantities in one figure; none: that of the analysis
  std::string title = {};
  double width_cm = 16;
};

/// front, growth, stages, map, causes, motion, sweep, parameters, sheet.
std::vector<std::string> figure_kinds();

/// The gnuplot program that draws the figure of this kind into `out`, data included. The terminal follows the name's ending:
/// .svg, .pdf, .png. A sheet reads the records' pictures, whose paths must lead to them from here. Throws Error on another
/// ending, on an unknown kind, when the records have nothing to draw, and on numbers that gnuplot cannot draw.
std::string figure_script(std::span<const Record> records, const std::string& kind, const FigureOptions& options,
                          const std::filesystem::path& out);

/// Runs gnuplot on a program made for `out`. The file appears whole or not at all. Throws Error, which names the package when
/// there is no gnuplot.
void run_gnuplot(const std::string& script, const std::filesystem::path& out);

}  // namespace gnomon
