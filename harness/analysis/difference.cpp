#include "analysis/difference.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "analysis/told_apart.h"
#include "measure/statistics/distributions.h"

namespace gnomon {

namespace {

/// The share of the differences, the smallest ones, from whose spread the drift between runs is read. The others may be as
/// far away as they like: a fifth of the rows may really have changed.
constexpr double steady_share = 0.8;
/// What runs at different times differ by when there are no rows to measure it, and for how many rows it counts.
constexpr double usual_drift = 0.1, usual_weight = 5;

/// Logarithm of every process median; a process without times has none.
std::vector<std::optional<double>> log_medians(const ProcessTimes& times, double least) {
  std::vector<std::optional<double>> logs;
  for (const std::vector<double>& process : times)
    logs.push_back(process.empty() ? std::optional<double>() : std::log(std::max(median(process), least)));
  return logs;
}

/// Median of the differences by kind, or by kind and what a member names: the batch or the place.
std::map<std::pair<int, int>, double> centers(std::span<const LogDifference> differences, int LogDifference::*by = nullptr) {
  std::map<std::pair<int, int>, std::vector<double>> groups;
  for (const LogDifference& d : differences) groups[{d.kind, by ? d.*by : 0}].push_back(d.value);
  std::map<std::pair<int, int>, double> result;
  for (const auto& [group, values] : groups) result[group] = median(values);
  return result;
}

/// Distance of every difference from the median of its kind.
std::vector<double> distances(std::span<const LogDifference> differences) {
  const auto middle = centers(differences);
  std::vector<double> result;
  for (const LogDifference& d : differences) result.push_back(std::abs(d.value - middle.at({d.kind, 0})));
  return result;
}

/// Variance of the medians of batches or places about those of their kinds; 0 where each kind has one only. A neighbor of the
/// machine that comes while one is timed moves all rows of it, which the steady share may not see.
double variance_between(std::span<const LogDifference> differences, int LogDifference::*by) {
  const auto middle = centers(differences), batches = centers(differences, by);
  double sum = 0;
  for (const auto& [group, value] : batches) sum += std::pow(value - middle.at({group.first, 0}), 2);
  const auto freedom = static_cast<double>(batches.size() - middle.size());
  return freedom > 0 ? sum / freedom : 0;
}

/// The variance to be added to all others so that the steady share of the distances is as wide as theory predicts.
double excess_variance(std::span<const double> distances, std::span<const double> variances, double freedom) {
  const double wanted = student_quantile((1 - steady_share) / 2, freedom);
  const auto width = [&](double excess) {
    std::vector<double> scaled;
    for (std::size_t k = 0; k < distances.size(); ++k)
      scaled.push_back(distances[k] == 0 ? 0 : distances[k] / std::sqrt(variances[k] + excess));
    return quantile(scaled, steady_share);
  };
  if (width(0) <= wanted) return 0;
  double low = 0, high = 1;
  while (width(high) > wanted) high *= 2;
  for (int k = 0; k < 60; ++k) {
    const double middle = (low + high) / 2;
    (width(middle) > wanted ? low : high) = middle;
  }
  return high;
}

/// What runs at different times differ by for each owner and kind: read off its own differences about their median as `drift`
/// is off all, which counts as `usual_weight` of them, and not less than that, nor than what its places differ by. One
/// that was timed in one place alone may drift as the worst of the others.
std::map<std::pair<int, int>, double> drifts_by_owner(std::span<const LogDifference> differences,
                                                      std::span<const double> variances, double freedom, double drift) {
  std::map<std::pair<int, int>, std::vector<std::size_t>> members;
  for (std::size_t k = 0; k < differences.size(); ++k) members[{differences[k].owner, differences[k].kind}].push_back(k);
  std::map<std::pair<int, int>, double> drifts;
  double worst = 0;
  std::vector<std::pair<int, int>> in_one_place;
  for (const auto& [owner, rows] : members) {
    std::vector<double> distances, own_variances;
    for (const std::size_t k : rows) distances.push_back(differences[k].value);
    const double middle = median(distances);
    for (double& distance : distances) distance = std::abs(distance - middle);
    for (const std::size_t k : rows) own_variances.push_back(variances[k]);
    const double seen = static_cast<double>(rows.size()) - 1;
    std::vector<LogDifference> own_rows;
    for (const std::size_t k : rows) own_rows.push_back(differences[k]);
    const double own =
        std::max(excess_variance(distances, own_variances, freedom), variance_between(own_rows, &LogDifference::place));
    drifts[owner] = std::max(drift, (usual_weight * drift + seen * own) / (usual_weight + seen));
    const auto is_elsewhere = [&](const LogDifference& d) { return d.place != own_rows[0].place; };
    if (std::ranges::any_of(own_rows, is_elsewhere))
      worst = std::max(worst, drifts[owner]);
    else
      in_one_place.push_back(owner);
  }
  for (const std::pair<int, int>& owner : in_one_place) drifts[owner] = std::max(drifts[owner], worst);
  return drifts;
}

/// The test of one value, of so many, against the floor. No difference is what lies between -floor and floor, widened on one
/// side by the slack.
Judgement judge_one(double value, double slack, double variance, double freedom, double floor, std::size_t tests) {
  const double width = floor + std::abs(slack) / 2, far = std::abs(value - slack / 2), deviation = std::sqrt(variance);
  Judgement judgement;
  if (deviation > 0)
    judgement.p =
        std::min(1.0, student_tail((far - width) / deviation, freedom) + student_tail((far + width) / deviation, freedom));
  else
    judgement.p = far > width ? 0 : 1;
  const double half = student_quantile(0.025, freedom) * deviation;
  judgement.low = value - half;
  judgement.high = value + half;
  constexpr double false_share = 0.05, missed_share = 0.2;
  const double beyond =
      student_quantile(false_share / static_cast<double>(tests), freedom) + student_quantile(missed_share, freedom);
  judgement.least = width + beyond * deviation;
  return judgement;
}

}  // namespace

std::optional<LogDifference> log_difference(const ProcessTimes& base, const ProcessTimes& contender, double least) {
  const std::optional<LogTime> b = log_time(base, least), c = log_time(contender, least);
  if (!b || !c) return std::nullopt;
  const LogTime parts[] = {*b, *c};
  const double variance = b->variance + c->variance;
  return LogDifference{c->value - b->value, variance, variance > 0 ? freedom_of(parts) : b->freedom + c->freedom};
}

std::optional<LogDifference> paired_difference(const ProcessTimes& base, const ProcessTimes& contender, double least) {
  const auto b = log_medians(base, least), c = log_medians(contender, least);
  std::vector<double> differences;
  for (std::size_t k = 0; k < std::min(b.size(), c.size()); ++k)
    if (b[k] && c[k]) differences.push_back(*c[k] - *b[k]);
  if (differences.size() < 2) return std::nullopt;
  const LogTime mean = mean_of(differences);
  return LogDifference{mean.value, mean.variance, mean.freedom};
}

double load_slack(double base_load, double contender_load, double cores) {
  constexpr double own_load = 1;
  const double least = std::min(base_load, contender_load);
  const double more = std::max(0.0, std::abs(contender_load - base_load) - own_load);
  const double slack = std::log((cores + least + more) / (cores + least));
  return contender_load > base_load ? slack : -slack;
}

Judgements judge(std::span<const LogDifference> differences, double floor, bool side_by_side) {
  Judgements judged;
  if (differences.empty()) return judged;

  // Few processes give a poor variance: draw each toward the typical one.
  std::vector<double> raw, variances;
  for (const LogDifference& d : differences) raw.push_back(d.variance);
  const double typical = median(raw);
  std::vector<double> freedoms;
  for (const LogDifference& d : differences) {
    variances.push_back((typical_freedom * typical + d.freedom * d.variance) / (typical_freedom + d.freedom));
    freedoms.push_back(typical_freedom + d.freedom);
  }

  // What a run adds on its own. A median of a kind is fitted to its differences: that many do not count.
  const double excess = std::max(excess_variance(distances(differences), variances, median(freedoms)),
                                 variance_between(differences, &LogDifference::batch));
  std::map<int, int> kinds;
  for (const LogDifference& d : differences) ++kinds[d.kind];
  const double seen = static_cast<double>(differences.size() - kinds.size());
  const double weight = side_by_side ? 0 : usual_weight;
  const double drift = seen + weight > 0 ? (seen * excess + weight * usual_drift * usual_drift) / (seen + weight) : 0;
  // Rows of one batch drift together, so the spread is known less well than their number says.
  const double drift_freedom = std::max(4.0, (seen + weight) / 6);
  judged.between = std::sqrt(drift);

  const auto by_owner =
      side_by_side ? std::map<std::pair<int, int>, double>() : drifts_by_owner(differences, variances, median(freedoms), drift);
  std::vector<double> p_values, growth;
  for (std::size_t k = 0; k < differences.size(); ++k) {
    const double own = side_by_side ? drift : by_owner.at({differences[k].owner, differences[k].kind});
    const double variance = variances[k] + own, value = differences[k].value;
    const double freedom = variance > 0
                               ? variance * variance / (variances[k] * variances[k] / freedoms[k] + own * own / drift_freedom)
                               : freedoms[k];
    const Judgement judgement = judge_one(value, differences[k].slack, variance, freedom, floor, differences.size());
    p_values.push_back(judgement.p);
    if (variances[k] > 0) growth.push_back(std::sqrt(variance / variances[k]));
    judged.each.push_back(judgement);
  }
  const std::vector<double> rates = false_discovery_rates(p_values);
  for (std::size_t k = 0; k < rates.size(); ++k) judged.each[k].false_discovery = rates[k];
  if (!growth.empty()) judged.inflation = median(growth);
  return judged;
}

std::vector<std::optional<GroupJudgement>> judge_groups(std::span<const LogDifference> differences, std::span<const int> groups,
                                                        int group_count, double floor, bool side_by_side) {
  // What batches differ by when there are too few to measure it, and for how many of them it counts.
  constexpr double batch_drift = 0.05, weight = 2;
  struct Group {
    std::map<int, std::vector<double>> batches;
    std::vector<double> slacks;
  };
  std::vector<Group> members(static_cast<std::size_t>(group_count));
  for (std::size_t k = 0; k < differences.size(); ++k) {
    Group& group = members[static_cast<std::size_t>(groups[k])];
    group.batches[differences[k].batch].push_back(differences[k].value);
    group.slacks.push_back(differences[k].slack);
  }
  std::vector<std::optional<GroupJudgement>> result(members.size());
  std::vector<double> p_values;
  for (std::size_t g = 0; g < members.size(); ++g) {
    std::vector<double> means;
    for (const auto& [batch, values] : members[g].batches) means.push_back(mean_of(values).value);
    if (means.size() < 2) continue;
    const auto count = static_cast<double>(means.size());
    const double value = mean_of(means).value, freedom = count - 1 + weight;
    double squares = weight * batch_drift * batch_drift;
    for (const double mean : means) squares += (mean - value) * (mean - value);
    const double variance = squares / freedom * (1 / count + (side_by_side ? 0 : 1));
    result[g] = GroupJudgement{value, judge_one(value, median(members[g].slacks), variance, freedom, floor, members.size())};
    p_values.push_back(result[g]->judgement.p);
  }
  const std::vector<double> rates = false_discovery_rates(p_values);
  std::size_t next = 0;
  for (auto& together : result)
    if (together) together->judgement.false_discovery = rates[next++];
  return result;
}

}  // namespace gnomon
