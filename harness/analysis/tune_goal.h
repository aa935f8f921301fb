#pragma once
#include "analysis/analysis.h"
#include "analysis/tune_search.h"

namespace gnomon {

/// A number of a row that tuning makes least, or limits.
struct TuneNumber {
  std::string name;               ///< as of a column: "error", "light_ms", "bytes"
  std::optional<Cost> cost = {};  ///< of a time of several stages, or of memory; nothing: the quantity of that name
  std::optional<double> of(const Record& record) const;
  /// Times differ from process to process; all other numbers come out the same in every run.
  bool is_time() const;
  bool is_cost() const;  ///< a time or bytes: not what the mask says
};

struct TuneLimit {
  TuneNumber number;
  bool is_least = false;  ///< the number must be at least the bound, else at most
  double bound = 0;       ///< in the unit of records
  std::string text;       ///< as written
  /// How far a value is beyond the bound, as a share of it; 0 or less: the limit is kept.
  double beyond(double value) const;
};

/// What tuning looks for.
struct TuneGoal {
  TuneNumber least;
  std::vector<TuneLimit> each;  ///< at each place
  TuneOver over = TuneOver::worst;
  bool is_timed() const;      ///< a time decides
  bool counts_costs() const;  ///< a time or bytes decide
};

/// "cost=light", or a quantity that is better when lower. Throws Error with the nearest names.
TuneNumber tuned_number(const std::string& text);
/// "error<=1%" or "ssim>=0.98", several with commas between them. `error` takes a share or a percentage, `MiB` is `bytes` in
/// that unit. Throws Error with the nearest names, and on a number that is none.
std::vector<TuneLimit> tune_limits(const std::string& text);

/// What a row answers; not there where it has no number to make least. A limit on a number that a row does not define is not
/// applied there.
TuneAnswer tune_answer(const Record& record, const TuneGoal& goal);

/// How likely the value of each candidate is at most (1 + `more`) times the least of them all, where processes and repetitions
/// are drawn as `Sample::draw` does, and a value is the worst or the mean of a candidate's samples.
std::vector<double> chances_of_least(std::span<const std::vector<Sample>> candidates, TuneOver over, double more,
                                     int draws = 4000);

}  // namespace gnomon
