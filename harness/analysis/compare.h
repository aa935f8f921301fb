#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "analysis/timed_part.h"

namespace gnomon {

struct CompareOptions {
  double floor = 0.05;            ///< a time must differ by more than this share to be called different
  double fdr = 0.05;              ///< rate of false discoveries among all times called different
  double threshold = 1.05;        ///< a time called slower is a regression when its ratio is above this
  double error_threshold = 1e-4;  ///< an error that rises by more than this is a regression
  bool force = false;             ///< judge times of different processors, too
};

enum class Verdict {
  not_judged,  ///< `why` says why
  similar,     ///< not distinguishable
  faster,
  slower,
};
std::string_view name(Verdict verdict);  ///< "not judged", "not distinguishable", "faster", "slower"

/// One stage of one row in both runs.
struct StageChange {
  TimedPart stage = Stage::setup;
  std::optional<double> base_ms, contender_ms;  ///< medians of process medians
  /// contender / base of times that count as `least_time` at least; the interval covers what runs differ by on their own.
  std::optional<Estimate> ratio = {};
  std::optional<double> p = {}, false_discovery = {};  ///< of difference.h's Judgement
  Verdict verdict = Verdict::not_judged;
  std::string why = {};
  bool is_regression = false;
};

/// A metric that is not the same in both runs. Metrics repeat bit for bit, so every change has a cause.
struct MetricChange {
  Truth truth = Truth::shape;
  std::string metric;
  std::optional<double> base, contender;  ///< nothing: not defined
  bool is_regression = false;
  /// Of an error under a light with area, to be shown beside: the greater of both floors.
  std::optional<double> floor;
};

/// Counted work that is not the same in both runs. It repeats exactly, so every change has a cause; what is counted in
/// milliseconds is left to the times.
struct CountChange {
  std::string name, unit;
  double base = 0, contender = 0;
};

/// One job in both runs, or in one of them.
struct RowChange {
  const Record* base = nullptr;       ///< nullptr: the row is new
  const Record* contender = nullptr;  ///< nullptr: the row is missing
  std::vector<std::string> notes;     ///< status, scene or parameters changed: what from, what to
  bool is_regression = false;         ///< of the status: it worked, and does not any more
  std::vector<StageChange> stages;    ///< setup is listed, never judged
  std::vector<MetricChange> metrics;
  std::vector<CountChange> counts;

  const Record& record() const { return contender ? *contender : *base; }
  bool differs() const;
  bool regressed() const;
};

/// What the rows of a contender, or all rows, have in common over all scenes.
struct OverallChange {
  std::string contender;  ///< label, or id and settings; empty: all rows
  TimedPart stage = Stage::build;
  std::size_t times = 0;  ///< how many were judged
  Estimate ratio = {};    ///< geometric mean over scenes
  double p = 1, false_discovery = 1;
  Verdict verdict = Verdict::similar;
  bool is_regression = false;
  double least_ratio = 1;  ///< see Comparison
};

struct Comparison {
  CompareOptions options;
  /// What the two runs do not share: topic, and how base and contender differ.
  std::vector<std::pair<std::string, std::string>> differences;
  std::string refusal;                ///< why no time is judged; empty: times are judged
  bool side_by_side = false;          ///< both programs were timed in one run, in pairs
  double between = 0, inflation = 1;  ///< of difference.h's Judgements
  double least_ratio =
      1;  ///< the least that one row alone would have been found to be slower by four times in five: the median
  std::vector<OverallChange> overall;  ///< all rows first; nothing where all rows are of one scene
  std::vector<RowChange> rows;         ///< in the order of the contender, missing ones last

  struct Counts {
    std::size_t matched = 0, missing = 0, added = 0, status = 0;
    std::size_t judged = 0, faster = 0, slower = 0;     ///< times
    std::size_t changed_rows = 0, changed_metrics = 0;  ///< rows with a changed metric, changed metrics in all
    std::size_t rows_of_other_work = 0;                 ///< with a changed count
    std::size_t overall = 0, overall_faster = 0, overall_slower = 0;
    std::size_t regressions = 0;  ///< rows, and what is worse over all scenes
  };
  Counts counts() const;
};

/// A part of compare: lists the stages of the matched rows and judges them.
void judge_times(Comparison& comparison);

/// Compares two runs, rows matched by their job. The records must outlive the result.
Comparison compare(std::span<const Record> base, std::span<const Record> contender, const CompareOptions& options = {});

}  // namespace gnomon
