#include "analysis/motion.h"

#include <algorithm>

namespace gnomon {

std::optional<Motion::Range> range_of(std::span<const std::optional<double>> values, std::string_view direction) {
  std::optional<Motion::Range> range;
  std::size_t count = 0;
  for (std::size_t frame = 0; frame < values.size(); ++frame) {
    if (!values[frame]) continue;
    const double value = *values[frame];
    if (!range) range = Motion::Range{.mean = 0, .least = value, .greatest = value, .worst = frame};
    const bool is_worst = direction == "higher" ? value < range->least : value > range->greatest;
    if (is_worst) range->worst = frame;
    range->mean += value;
    range->least = std::min(range->least, value);
    range->greatest = std::max(range->greatest, value);
    ++count;
  }
  if (range) range->mean /= static_cast<double>(count);
  return range;
}

std::vector<Motion> find_motion(std::span<const Record> records, const std::string& error) {
  std::vector<Motion> rows;
  std::set<std::string> metrics;
  for (const Record& r : records) {
    if (r.path.empty() || r.status != Status::ok || r.frames.empty()) continue;
    Motion row{.record = &r, .frames = 0, .instability = {}, .error = {}};
    for (const auto& [metric, values] : r.frames) {
      metrics.insert(metric);
      row.frames = std::max(row.frames, values.size());
    }
    const auto range = [&](const std::string& metric) -> std::optional<Motion::Range> {
      const auto found = r.frames.find(metric);
      return found == r.frames.end() ? std::nullopt : range_of(found->second, better(metric));
    };
    row.instability = range("instability");
    row.error = range(error);
    rows.push_back(row);
  }
  if (rows.empty()) throw Error("no row of these records follows a path; a suite asks for it with paths = [...] in a group");
  const std::vector<std::string> known(metrics.begin(), metrics.end());
  if (!metrics.contains(error))
    throw Error("no frame has {}; did you mean {}? There are: {}", error, nearest_word(error, known), joined(known, ", "));
  return rows;
}

}  // namespace gnomon
