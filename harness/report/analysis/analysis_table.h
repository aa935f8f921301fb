#pragma once
#include "analysis/front.h"
#include "analysis/growth.h"
#include "analysis/map.h"
#include "analysis/motion.h"
#include "report/table/columns.h"
#include "report/table/table.h"

namespace gnomon {

/// Options of `gnomon analyze` and `gnomon figure` beside the kind.
struct AnalysisOptions {
  /// growth: the axis, `triangles` by default; forecast: the same, `lights` by default; map, sweep: parameters
  std::string x = {}, y = {}, facet = {};
  std::string metric = "error";  ///< a quantity, see analysis.h
  std::string growing = {};      ///< growth: a quantity; times by default
  double to = 0;                 ///< forecast: where on the axis; 0: at four times the greatest x
  Cost cost = Cost::light;
  std::optional<Cost> only_cost = {};  ///< rank: by default each
  bool all_pairs = false;              ///< rank: by default the best against each
  /// Budgets of `best`, and of `enough` those of error, in the units that tables show: ms, MiB, and % or the metric's unit. All
  /// empty: round numbers.
  std::vector<double> times = {}, memories = {}, errors = {};
  bool all = false;         ///< people too see rows that are beaten
  std::string folder = {};  ///< masks: the run's, whose masks are read
  bool over_all = false;    ///< front, best, enough: only what is over all places
};

/// The kinds of analysis, for messages.
std::vector<std::string> analysis_kinds();

/// The analysis of this kind in this format. Throws Error on an unknown kind, quantity or parameter.
std::string analyze(std::span<const Record> records, const std::string& kind, const AnalysisOptions& options, Format format,
                    const TableOptions& table = {});

/// The quantity that a word names: its name, or its heading as tables print it; another word is returned as it is. Throws Error
/// with the names where several quantities have the heading.
std::string quantity_named(std::span<const Record> records, const std::string& word);

/// The column that shows a quantity: its heading, unit and scale.
Column quantity_column(const std::string& quantity);

}  // namespace gnomon
