#pragma once
#include "analysis/tune_choice.h"
#include "report/table/columns.h"

namespace gnomon {

/// A setting with what it measured at each place; null where it did not run.
struct TuneRow {
  std::string what;  ///< "answer", "default", "neighbor"
  std::string name;  ///< "shadow_map:resolution=512"
  std::vector<const Record*> rows;
};

/// What `gnomon tune` says. The records are whoever fills it's, and outlive it.
struct TuneReport {
  TuneGoal goal;
  std::vector<Place> places = {}, held = {};  ///< that decided, and that were held out
  bool is_feasible = true;
  std::vector<TuneRow> rows = {};                                  ///< the answer first, then whoever is compared with it
  std::vector<const Record*> answer_held = {}, default_held = {};  ///< by place that was held out
  std::vector<std::string> tied = {};                              ///< names, without the answer's
  std::optional<std::array<double, 3>> chances = {};               ///< see TuneDecision; nothing where the goal is no time
  std::vector<TuneEffect> effects = {};
  std::vector<SceneLeftOut> scenes_left_out = {};
  std::vector<std::string> compared = {};  ///< names of the settings that SceneLeftOut::chosen counts
  std::vector<std::string> notes = {};     ///< what was skipped, what failed, and what must be known
  std::size_t asked = 0;
  double possible = 0;
  bool is_cut_short = false;
  std::uint64_t seed = 1;
};

/// The report for people, in lines of at most `width` columns; 0: no limit.
std::string tune_text(const TuneReport& report, std::size_t width);

/// "0.82 %", "3.1 ms", "4 MiB".
std::string number_text(const TuneNumber& number, double value);

}  // namespace gnomon
