#pragma once
#include <optional>
#include <span>
#include <vector>

#include "measure/statistics/statistics.h"

namespace gnomon {

/// Weight of the typical variance of many, in degrees of freedom. Two times five processes have eight of their own.
inline constexpr double typical_freedom = 4;

/// One stage of one row, timed in two runs: the difference of the logarithms of its times, contender minus base.
struct LogDifference {
  double value = 0;     ///< of the means of the logarithms of the process medians
  double variance = 0;  ///< of the value, from the spread of the processes within each run
  double freedom = 0;   ///< degrees of freedom of the variance
  int kind = 0;         ///< the stage: differences of one kind share what a run adds to all of them
  int batch = 0;        ///< the scene: its rows were timed at the same time and drift together
  int place = 0;        ///< scene and light: a neighbor of the machine that comes for seconds meets the rows of one
  int owner = 0;        ///< the technique: some drift more from run to run than others
  /// What the machine is known to add on its own: a value is no difference up to this far above zero, or below it when
  /// negative.
  double slack = 0;
};

/// The difference of two runs at different times: processes of the two have nothing in common (Welch). Times below `least`
/// count as `least`, in milliseconds. Nothing below two processes on either side.
std::optional<LogDifference> log_difference(const ProcessTimes& base, const ProcessTimes& contender, double least);

/// The difference of two programs timed side by side: the k-th process of one ran interleaved with the k-th of the other, so
/// that what disturbs both cancels in each pair. Nothing below two pairs.
std::optional<LogDifference> paired_difference(const ProcessTimes& base, const ProcessTimes& contender, double least);

/// How sure one difference is.
struct Judgement {
  double p = 1;                ///< of a difference this large, were the true one at most the floor
  double false_discovery = 1;  ///< the rate of false calls, over all differences, at which this one is called
  double low = 0, high = 0;    ///< 95 % interval of the value
  /// The least true difference that, alone among the differences, would be called four times in five, with a rate of false
  /// calls of 5 %.
  double least = 0;
  bool operator==(const Judgement&) const = default;
};

struct Judgements {
  std::vector<Judgement> each;  ///< in the order of the differences
  double between = 0;           ///< standard deviation, in logarithms, that one run differs from the next by on its own
  double inflation = 1;         ///< by how much `between` widens the typical interval
};

/// How far a run on a machine of `cores` may be slower (positive) or faster than another for the load of the machine alone, in
/// logarithms: `load` other threads leave a worker cores / (cores + load) of its speed at worst. One unit of load does not
/// count: it is the run's own, and lags behind by minutes.
double load_slack(double base_load, double contender_load, double cores);

/// Judges all differences of two runs at once. Each is tested against the floor, not against zero (McCarthy and Smyth 2009),
/// with a variance shrunk toward the typical one (Smyth 2004) and widened by what runs of the same program differ by at
/// different times. That is read off the spread of the differences themselves about the median of their kind: most rows are
/// taken to be the same program. Side by side it starts from nothing; at different times from 10 %, as if seen on five rows.
/// Same differences, same judgement.
Judgements judge(std::span<const LogDifference> differences, double floor, bool side_by_side);

/// Judges what groups of differences have in common over their batches, `groups` naming the group of each difference: the mean
/// over batches of the mean of the batch. Its variance is the spread of the batches, drawn toward 5 %; runs at
/// different times add as much again for the drift that a whole run shares. Nothing for a group of one batch.
struct GroupJudgement {
  double value = 0;  ///< of the group, a difference of logarithms
  Judgement judgement;
};
std::vector<std::optional<GroupJudgement>> judge_groups(std::span<const LogDifference> differences, std::span<const int> groups,
                                                        int group_count, double floor, bool side_by_side);

}  // namespace gnomon
