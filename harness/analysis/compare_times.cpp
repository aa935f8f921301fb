// The times of a comparison: which are judged, and how they come out.
#include <gnomon/error.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "analysis/compare.h"
#include "analysis/difference.h"

namespace gnomon {

namespace {

std::vector<StageChange> list_stages(const RowChange& row) {
  std::vector<StageChange> stages;
  for (const TimedPart part : all_parts) {
    StageChange change{.stage = part,
                       .base_ms = median_of_medians(times_of(*row.base, part)),
                       .contender_ms = median_of_medians(times_of(*row.contender, part))};
    if (!change.base_ms && !change.contender_ms) continue;
    if (change.base_ms && change.contender_ms) {
      const double ratio = std::max(*change.contender_ms, least_time) / std::max(*change.base_ms, least_time);
      change.ratio = Estimate{ratio, ratio, ratio};
    }
    stages.push_back(std::move(change));
  }
  return stages;
}

/// The number of a part, for LogDifference::kind.
int kind_of(TimedPart part) { return static_cast<int>(std::ranges::find(all_parts, part) - std::begin(all_parts)); }

/// What the load of the machine explains of a row's times.
double slack(const Record& base, const Record& contender) {
  const auto number = [](const Record& record, const char* key, double fallback) {
    const auto found = record.context.find(key);
    return found != record.context.end() && found->is_number() ? found->get<double>() : fallback;
  };
  const double cores = std::min(number(base, "cores", 1), number(contender, "cores", 1));
  return load_slack(number(base, "load_average", 0), number(contender, "load_average", 0), std::max(cores, 1.0));
}

/// What all rows, and all rows of each contender, have in common. `owners` are the contenders of the differences.
void judge_contenders(Comparison& result, const std::vector<LogDifference>& differences,
                      const std::vector<std::string>& owners) {
  std::vector<OverallChange> changes;
  std::vector<int> groups;
  std::vector<LogDifference> members;
  const auto enter = [&](std::size_t k, const std::string& contender) {
    const TimedPart stage = all_parts[differences[k].kind];
    const auto same = [&](const OverallChange& c) { return c.contender == contender && c.stage == stage; };
    const auto found = std::ranges::find_if(changes, same);
    groups.push_back(static_cast<int>(found - changes.begin()));
    members.push_back(differences[k]);
    if (found == changes.end()) changes.push_back({.contender = contender, .stage = stage});
    ++changes[static_cast<std::size_t>(groups.back())].times;
  };
  for (const TimedPart part : repeated_parts)
    for (std::size_t k = 0; k < differences.size(); ++k)
      if (differences[k].kind == kind_of(part)) enter(k, "");
  for (std::size_t k = 0; k < differences.size(); ++k) enter(k, owners[k]);

  const double floor = std::log1p(result.options.floor);
  const auto all = judge_groups(members, groups, static_cast<int>(changes.size()), floor, result.side_by_side);
  for (std::size_t g = 0; g < changes.size(); ++g) {
    if (!all[g]) continue;
    OverallChange& change = changes[g];
    const Judgement& judgement = all[g]->judgement;
    change.ratio = {std::exp(all[g]->value), std::exp(judgement.low), std::exp(judgement.high)};
    change.p = judgement.p;
    change.false_discovery = judgement.false_discovery;
    change.least_ratio = std::exp(judgement.least);
    if (judgement.false_discovery <= result.options.fdr && std::abs(all[g]->value) > floor)
      change.verdict = all[g]->value > 0 ? Verdict::slower : Verdict::faster;
    change.is_regression = change.verdict == Verdict::slower && change.ratio.value > result.options.threshold;
    result.overall.push_back(change);
  }
}

}  // namespace

void judge_times(Comparison& result) {
  std::vector<StageChange*> judged;
  std::vector<LogDifference> differences;
  std::vector<std::string> owners;  // contenders
  // Build does not depend on the light, so all rows of a contender on a scene have the same times: judged once.
  std::set<std::tuple<std::string, ProcessTimes, ProcessTimes>> builds;
  const auto is_repeated = [&](const Record& base, const Record& contender, TimedPart part) {
    const std::string setting = base.scene + '|' + base.technique + '|' + base.settings;
    return part == Stage::build && !builds.emplace(setting, times_of(base, part), times_of(contender, part)).second;
  };
  std::map<std::string, int> scenes, places, techniques;
  for (RowChange& row : result.rows) {
    if (!row.base || !row.contender || row.base->status != Status::ok || row.contender->status != Status::ok) continue;
    row.stages = list_stages(row);
    for (StageChange& change : row.stages) {
      const ProcessTimes &base = times_of(*row.base, change.stage), &contender = times_of(*row.contender, change.stage);
      std::optional<LogDifference> difference =
          result.side_by_side ? paired_difference(base, contender, least_time) : log_difference(base, contender, least_time);
      if (context_text(*row.base, "scene_hash") != context_text(*row.contender, "scene_hash"))
        change.why = "the scene has changed";
      else if (change.stage == Stage::setup)
        change.why = "setup is listed only";
      else if (!change.ratio)
        change.why = "timed in one run only";
      else if (*change.base_ms < least_time && *change.contender_ms < least_time)
        change.why = fmt::format("below {} ms in both runs", least_time);
      else if (!difference)
        change.why = "needs two processes in each run";
      else if (is_repeated(*row.base, *row.contender, change.stage))
        change.why = "the same times as under another light";
      else if (!result.refusal.empty())
        change.why = result.refusal;
      if (!change.why.empty()) continue;
      difference->kind = kind_of(change.stage);
      difference->batch = scenes.try_emplace(row.base->scene, static_cast<int>(scenes.size())).first->second;
      const std::string place = row.base->scene + '|' + row.base->light;
      difference->place = places.try_emplace(place, static_cast<int>(places.size())).first->second;
      difference->owner = techniques.try_emplace(row.base->technique, static_cast<int>(techniques.size())).first->second;
      difference->slack = slack(*row.base, *row.contender);
      differences.push_back(*difference);
      judged.push_back(&change);
      owners.push_back(setting_name(*row.contender));
    }
  }

  const double floor = std::log1p(result.options.floor);
  const Judgements all = judge(differences, floor, result.side_by_side);
  result.between = all.between;
  result.inflation = all.inflation;
  std::vector<double> least;
  for (std::size_t k = 0; k < judged.size(); ++k) {
    StageChange& change = *judged[k];
    const Judgement& judgement = all.each[k];
    const double value = differences[k].value, ratio = change.ratio->value;
    change.p = judgement.p;
    change.false_discovery = judgement.false_discovery;
    change.ratio->low = ratio * std::exp(judgement.low - value);
    change.ratio->high = ratio * std::exp(judgement.high - value);
    least.push_back(judgement.least);
    change.verdict = Verdict::similar;
    // The mean of the logarithms is tested and the ratio of medians is shown: they must agree.
    if (judgement.false_discovery <= result.options.fdr && std::abs(std::log(ratio)) > floor && std::log(ratio) * value > 0)
      change.verdict = ratio > 1 ? Verdict::slower : Verdict::faster;
    change.is_regression = change.verdict == Verdict::slower && ratio > result.options.threshold;
    if (change.verdict == Verdict::similar && differences[k].slack * value > 0 && std::abs(value) > floor)
      change.why = fmt::format("the load of the machine explains up to {:.2f}", std::exp(differences[k].slack));
  }
  if (!least.empty()) result.least_ratio = std::exp(median(least));
  judge_contenders(result, differences, owners);
}

}  // namespace gnomon
