#include "analysis/motion.h"

#include <algorithm>
#include <set>

#include "measure/score/metrics.h"

namespace gnomon {

namespace {

/// Over the frames where it is defined; nothing when it never is. `direction` says which end is the worst.
std::optional<PathErrors::Range> range_of(std::span<const std::optional<double>> values, std::string_view direction) {
  std::optional<PathErrors::Range> range;
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < values.size(); ++frame) {
    if (!values[frame]) continue;
    const double value = *values[frame];
    if (!range) range = PathErrors::Range{.mean = 0, .least = value, .greatest = value, .worst = frame};
    if (is_better(direction, direction == "higher" ? range->least : range->greatest, value)) range->worst = frame;
    range->mean += value;
    range->least = std::min(range->least, value);
    range->greatest = std::max(range->greatest, value);
    ++count;
  }
  if (range) range->mean /= static_cast<double>(count);
  return range;
}

}  // namespace

bool PathErrors::has_over_time() const {
  return std::ranges::any_of(over_time, [](const std::optional<double>& value) { return value.has_value(); });
}

std::vector<std::string> names_over_time() {
  std::vector<std::string> names;
  for (const MetricInfo& info : metric_infos())
    if (info.of == MetricInfo::Of::row) names.emplace_back(info.name);
  return names;
}

std::vector<PathErrors> find_motion(std::span<const Record> records, const std::string& error) {
  std::vector<PathErrors> rows;
  std::set<std::string> metrics;
  const std::vector<std::string> over_time = names_over_time();
  for (const Record& r : records) {
    if (r.path.empty() || r.status != Status::ok || r.frames.empty()) continue;
    PathErrors row{.record = &r, .frames = 0, .instability = {}, .error = {}, .over_time = {}};
    for (const auto& [metric, values] : r.frames) {
      metrics.insert(metric);
      row.frames = std::max(row.frames, values.size());
    }
    const auto range = [&](const std::string& metric) -> std::optional<PathErrors::Range> {
      const auto found = r.frames.find(metric);
      return found == r.frames.end() ? std::nullopt : range_of(found->second, better(metric));
    };
    row.instability = range("instability");
    row.error = range(error);
    for (const std::string& metric : over_time) row.over_time.push_back(r.metric(metric));
    rows.push_back(row);
  }
  if (rows.empty()) throw Error("no row of these records follows a path; a suite requests it with paths = [...] in a group");
  require_word("no frame has", error, std::vector<std::string>(metrics.begin(), metrics.end()));
  return rows;
}

}  // namespace gnomon
