#include "analysis/tune_goal.h"

#include <algorithm>
#include <cmath>

#include "measure/score/metrics.h"

namespace gnomon {

namespace {

constexpr double mebibyte = 1024 * 1024;

/// The costs by the names that their numbers have here.
constexpr std::pair<std::string_view, Cost> timed_costs[] = {
    {"light_ms", Cost::light}, {"geometry_ms", Cost::geometry}, {"motion_ms", Cost::motion}};

std::vector<std::string> number_names() {
  std::vector<std::string> names{"bytes", "MiB", "peak_bytes"};
  for (const MetricInfo& info : metric_infos()) names.emplace_back(info.name);
  for (const auto& [name, cost] : timed_costs) names.emplace_back(name);
  for (const TimedPart part : all_parts) names.push_back(fmt::format("{}_ms", name(part)));
  return names;
}

/// The three nearest of the names, the nearest first.
std::string nearest_names(std::string_view word, std::vector<std::string> names) {
  std::vector<std::string> nearest;
  while (nearest.size() < 3 && !names.empty()) {
    nearest.push_back(nearest_word(word, names));
    std::erase(names, nearest.back());
  }
  return joined(nearest, ", ");
}

/// Throws Error, which begins with `where`, on a name that no row can have.
TuneNumber number_named(const std::string& wanted, const std::string& where) {
  for (const auto& [name, cost] : timed_costs)
    if (wanted == name) return {wanted, cost};
  if (wanted == "bytes" || wanted == "MiB") return {"bytes", Cost::bytes};
  const std::vector<std::string> names = number_names();
  if (std::ranges::find(names, wanted) == names.end() && !wanted.starts_with("cause."))
    throw Error("{}: there is no metric, time or size {}; the nearest are {}. gnomon list metrics has all metrics", where,
                wanted, nearest_names(wanted, names));
  return {wanted};
}

TuneLimit tune_limit(const std::string& text) {
  const std::string where = fmt::format("--each '{}'", text);
  std::size_t sign = text.find("<=");
  const bool is_least = sign == text.npos;
  if (is_least) sign = text.find(">=");
  if (sign == text.npos || sign == 0) throw Error("{} is not NAME<=NUMBER or NAME>=NUMBER", where);
  const std::string name = text.substr(0, sign);
  std::string bound = text.substr(sign + 2);
  const bool is_percentage = bound.ends_with('%');
  if (is_percentage) bound.pop_back();
  const std::optional<double> number = number_from(bound);
  if (!number || !std::isfinite(*number) || *number < 0)
    throw Error("{}: '{}' is not a number of 0 or more, or a percentage", where, text.substr(sign + 2));
  TuneLimit limit{number_named(name, where), is_least, *number, text};
  if (is_percentage && limit.number.is_cost()) throw Error("{}: {} has no percentage", where, name);
  if (is_percentage) limit.bound /= 100;
  if (name == "MiB") limit.bound *= mebibyte;
  if (name == "error" && !is_least && limit.bound >= 1)
    throw Error("{} is {} %, which every mask keeps; write error<={}%", where, 100 * limit.bound, *number);
  return limit;
}

}  // namespace

std::optional<double> TuneNumber::of(const Record& record) const {
  if (!cost) return quantity(record, name);
  if (*cost == Cost::bytes) return quantity(record, "bytes");
  const Sample sample = sample_of(record, parts_of(*cost));
  return sample.is_timed() ? std::optional(sample.value()) : std::nullopt;
}

bool TuneNumber::is_time() const { return cost ? *cost != Cost::bytes : name.ends_with("_ms"); }

bool TuneNumber::is_cost() const { return is_time() || name.ends_with("bytes"); }

double TuneLimit::beyond(double value) const {
  const double over = is_least ? bound - value : value - bound;
  return bound > 0 ? over / bound : over;
}

bool TuneGoal::is_timed() const {
  return least.is_time() || std::ranges::any_of(each, [](const TuneLimit& limit) { return limit.number.is_time(); });
}

bool TuneGoal::counts_costs() const {
  return least.is_cost() || std::ranges::any_of(each, [](const TuneLimit& limit) { return limit.number.is_cost(); });
}

TuneNumber tuned_number(const std::string& text) {
  const std::string where = fmt::format("--least {}", text);
  if (text.starts_with("cost=")) {
    const Cost cost = cost_named(text.substr(5));
    if (cost == Cost::resolve) return {"resolve_ms"};
    return {cost == Cost::bytes ? "bytes" : fmt::format("{}_ms", name(cost)), cost};
  }
  TuneNumber number = number_named(text, where);
  if (better(number.name) != "lower") throw Error("{}: {} is not better when lower; a limit may be on it", where, text);
  return number;
}

std::vector<TuneLimit> tune_limits(const std::string& text) {
  std::vector<TuneLimit> limits;
  for (std::size_t at = 0, end = 0; end != text.npos; at = end + 1) {
    end = text.find(',', at);
    limits.push_back(tune_limit(text.substr(at, end == text.npos ? end : end - at)));
  }
  return limits;
}

TuneAnswer tune_answer(const Record& record, const TuneGoal& goal) {
  const std::optional<double> least = goal.least.of(record);
  if (record.status != Status::ok || !least) return {.is_there = false};
  TuneAnswer answer{.goal = *least};
  for (const TuneLimit& limit : goal.each)
    if (const std::optional<double> value = limit.number.of(record))
      answer.beyond = std::max(answer.beyond, limit.beyond(*value));
  // Where nothing is in shadow there is nothing to gain, and nobody is to blame.
  const bool has_shadow = record.metric("constant_error").value_or(1) > 0;
  answer.gain = has_shadow ? gain_over_constant(record).value_or(1) : 1e-12;
  return answer;
}

std::vector<double> chances_of_least(std::span<const std::vector<Sample>> candidates, TuneOver over, double more, int draws) {
  Random random(1);
  std::vector<int> counts(candidates.size());
  std::vector<double> values(candidates.size());
  for (int k = 0; k < draws; ++k) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      values[c] = 0;
      for (const Sample& sample : candidates[c]) {
        const double drawn = sample.draw(random);
        values[c] = over == TuneOver::worst ? std::max(values[c], drawn) : values[c] + drawn;
      }
    }
    const double least = *std::ranges::min_element(values);
    for (std::size_t c = 0; c < candidates.size(); ++c) counts[c] += values[c] <= (1 + more) * least;
  }
  std::vector<double> chances;
  for (const int count : counts) chances.push_back(static_cast<double>(count) / draws);
  return chances;
}

}  // namespace gnomon
