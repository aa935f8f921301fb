#include "analysis/compare.h"

#include <gnomon/error.h>

#include "analysis/in_order.h"
#include "measure/score/metrics.h"

namespace gnomon {

std::string_view name(Verdict verdict) {
  static constexpr std::string_view names[] = {"not judged", "not distinguishable", "faster", "slower"};
  return names[static_cast<int>(verdict)];
}

bool RowChange::differs() const {
  const auto called = [](const StageChange& s) { return s.verdict == Verdict::faster || s.verdict == Verdict::slower; };
  return !base || !contender || !notes.empty() || !metrics.empty() || !counts.empty() || std::ranges::any_of(stages, called);
}

bool RowChange::regressed() const {
  const auto is_bad = [](const auto& change) { return change.is_regression; };
  return is_regression || std::ranges::any_of(stages, is_bad) || std::ranges::any_of(metrics, is_bad);
}

Comparison::Counts Comparison::counts() const {
  Counts counts;
  for (const RowChange& row : rows) {
    if (row.base && row.contender) ++counts.matched;
    counts.missing += !row.contender;
    counts.added += !row.base;
    counts.status += row.base && row.contender && row.base->status != row.contender->status;
    for (const StageChange& stage : row.stages) {
      counts.judged += stage.verdict != Verdict::not_judged;
      counts.faster += stage.verdict == Verdict::faster;
      counts.slower += stage.verdict == Verdict::slower;
    }
    counts.changed_rows += !row.metrics.empty();
    counts.changed_metrics += row.metrics.size();
    counts.rows_of_other_work += !row.counts.empty();
    counts.regressions += row.regressed();
  }
  for (const OverallChange& change : overall) {
    ++counts.overall;
    counts.overall_faster += change.verdict == Verdict::faster;
    counts.overall_slower += change.verdict == Verdict::slower;
    counts.regressions += change.is_regression;
  }
  return counts;
}

namespace {

std::string plain(const Json& value) { return value.is_null() ? "-" : plain_text(value); }

double median_load(std::span<const Record> records) {
  std::vector<double> loads;
  for (const Record& record : records)
    if (const auto found = record.context.find("load_average"); found != record.context.end() && found->is_number())
      loads.push_back(found->get<double>());
  return loads.empty() ? 0 : median(loads);
}

void compare_contexts(Comparison& result, std::span<const Record> base, std::span<const Record> contender) {
  static constexpr const char* keys[] = {"processor",  "cores",    "threads", "version",     "commit",     "build",
                                         "build_type", "compiler", "flags",   "gl_renderer", "gl_version", "libraries"};
  for (const char* key : keys) {
    const std::vector<std::string> b = context_values(base, key), c = context_values(contender, key);
    if (b == c) continue;
    const auto text = [](const auto& values) { return values.empty() ? "-" : joined(values, ", "); };
    result.differences.emplace_back(key, fmt::format("{} -> {}", text(b), text(c)));
    // Records without a processor say nothing against each other.
    if (std::string_view(key) == "processor" && !b.empty() && !c.empty() && !result.options.force)
      result.refusal = "the runs were made by different processors";
  }
  // A machine that was busy in one run and idle in the other explains much.
  const double b = median_load(base), c = median_load(contender);
  if (std::abs(b - c) > 0.5) result.differences.emplace_back("load_average", fmt::format("{:.1f} -> {:.1f}", b, c));
}

/// What rows are matched by: the job, or all that its hash would be made from.
std::string key_of(const Record& record) {
  if (!record.job.empty()) return record.job;
  return fmt::format("{}|{}|{}|{}|{}|{}x{}|{}|{}|{} {} {}", record.scene, record.light, record.view, record.technique,
                     record.settings, record.width, record.height, name(record.truth), record.path, record.start.value_or(0),
                     record.frame_rate.value_or(0), record.frame_count.value_or(0));
}

/// Both runs were one run of two programs: they carry the same mark.
bool are_side_by_side(std::span<const Record> base, std::span<const Record> contender) {
  std::set<std::string> marks[2];
  for (const Record& record : base) marks[0].insert(context_text(record, "side_by_side"));
  for (const Record& record : contender) marks[1].insert(context_text(record, "side_by_side"));
  return marks[0].size() == 1 && marks[0] == marks[1] && !marks[0].contains("");
}

void compare_parameters(RowChange& row) {
  const Json &base = row.base->parameters, &contender = row.contender->parameters;
  std::vector<std::string> changes;
  for (const auto& [key, value] : base.items()) {
    const auto now = contender.find(key);
    if (now == contender.end())
      changes.push_back(key + " is gone");
    else if (*now != value)
      changes.push_back(fmt::format("{}: {} -> {}", key, plain(value), plain(*now)));
  }
  for (const auto& [key, value] : contender.items())
    if (!base.contains(key)) changes.push_back(fmt::format("{} is new: {}", key, plain(value)));
  if (!changes.empty()) row.notes.push_back(fmt::format("parameters changed: {}", joined(changes, ", ")));
}

/// The greater of the floors of both rows.
std::optional<double> common_floor(const RowChange& row, Truth truth, std::string_view metric) {
  const std::string floor = fmt::format("{}_floor", metric);
  const auto base = row.base->metric(truth, floor), contender = row.contender->metric(truth, floor);
  return base && contender ? std::optional(std::max(*base, *contender)) : std::nullopt;
}

/// Metrics against one truth that both runs have: one that only the newer program computes has not changed.
std::vector<MetricChange> changed_metrics(const RowChange& row, Truth truth, double error_threshold) {
  std::vector<MetricChange> changes;
  const auto b = row.base->metrics.find(truth), c = row.contender->metrics.find(truth);
  if (b == row.base->metrics.end() || c == row.contender->metrics.end()) return changes;
  for (const MetricInfo& info : metric_infos()) {
    const auto before = b->second.find(info.name), after = c->second.find(info.name);
    if (before == b->second.end() || after == c->second.end() || before->second == after->second) continue;
    MetricChange change{truth, std::string(info.name), before->second, after->second, false, {}};
    change.floor = common_floor(row, truth, info.name);
    if (info.name == "error")
      change.is_regression = truth == row.contender->truth && change.base &&
                             (!change.contender || *change.contender - *change.base > error_threshold);
    changes.push_back(std::move(change));
  }
  return changes;
}

void compare_metrics(RowChange& row, double error_threshold) {
  const Truth headline = row.contender->truth, other = headline == Truth::shape ? Truth::mesh : Truth::shape;
  row.metrics = changed_metrics(row, headline, error_threshold);
  const std::size_t count = row.metrics.size();
  // Without curved shapes both truths are one; it is said once.
  for (MetricChange& change : changed_metrics(row, other, error_threshold)) {
    const auto says_the_same = [&](const MetricChange& c) {
      return c.metric == change.metric && c.base == change.base && c.contender == change.contender;
    };
    if (std::none_of(row.metrics.begin(), row.metrics.begin() + static_cast<std::ptrdiff_t>(count), says_the_same))
      row.metrics.push_back(std::move(change));
  }
}

/// Counts that both runs have.
std::vector<CountChange> changed_counts(const Record& base, const Record& contender) {
  std::vector<CountChange> changes;
  for (const Count& after : contender.counts) {
    const auto before = std::ranges::find(base.counts, after.name, &Count::name);
    if (before != base.counts.end() && after.unit != "ms" && before->value != after.value)
      changes.push_back({after.name, after.unit, before->value, after.value});
  }
  return changes;
}

RowChange match(const Record& base, const Record& contender, const CompareOptions& options) {
  RowChange row{&base, &contender, {}, false, {}, {}, {}};
  if (base.status != contender.status) {
    const std::string& why = contender.status == Status::ok ? base.reason : contender.reason;
    row.notes.push_back(fmt::format("{} -> {}{}{}", name(base.status), name(contender.status), why.empty() ? "" : ": ", why));
    row.is_regression = base.status == Status::ok;
  }
  if (base.status == contender.status && base.support && contender.support && *base.support != *contender.support)
    row.notes.push_back(fmt::format("support: {} -> {}{}{}", name(*base.support), name(*contender.support),
                                    contender.reason.empty() ? "" : ": ", contender.reason));
  const std::string before = context_text(base, "scene_hash"), after = context_text(contender, "scene_hash");
  if (before != after && !before.empty() && !after.empty())
    row.notes.push_back("the scene has changed: neither times nor errors can be compared");
  compare_parameters(row);
  if (const std::string source = context_text(base, "technique_source"), now = context_text(contender, "technique_source");
      source != now && !source.empty() && !now.empty())
    row.notes.push_back("the source of the technique has changed");
  if (base.status != Status::ok || contender.status != Status::ok) return row;
  if (before == after) {
    compare_metrics(row, options.error_threshold);
    row.counts = changed_counts(base, contender);
  }
  return row;
}

}  // namespace

Comparison compare(std::span<const Record> base, std::span<const Record> contender, const CompareOptions& options) {
  Comparison result;
  result.options = options;
  result.side_by_side = are_side_by_side(base, contender);
  compare_contexts(result, base, contender);

  std::map<std::string, const Record*> by_key;
  for (const Record& record : base) by_key.emplace(key_of(record), &record);
  for (const Record& record : contender) {
    const auto found = by_key.find(key_of(record));
    if (found == by_key.end()) {
      result.rows.push_back({nullptr, &record, {}, false, {}, {}, {}});
      continue;
    }
    result.rows.push_back(match(*found->second, record, options));
    by_key.erase(found);
  }
  for (const Record& record : base)
    if (const auto left = by_key.find(key_of(record)); left != by_key.end() && left->second == &record)
      result.rows.push_back({&record, nullptr, {}, false, {}, {}, {}});
  judge_times(result);
  return result;
}

}  // namespace gnomon
