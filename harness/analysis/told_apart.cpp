#include "analysis/told_apart.h"

#include <algorithm>
#include <cmath>

#include "analysis/difference.h"
#include "measure/statistics/distributions.h"

namespace gnomon {

namespace {

constexpr double most_false = 0.05;

}  // namespace

double freedom_of(std::span<const LogTime> parts) {
  double sum = 0, own = 0, least = parts.front().freedom;
  for (const LogTime& part : parts) {
    sum += part.variance;
    own += part.variance * part.variance / part.freedom;
    least = std::min(least, part.freedom);
  }
  return own > 0 ? sum * sum / own : least;
}

std::optional<LogTime> log_time(const ProcessTimes& times, double least) {
  std::vector<double> logs;
  for (const std::vector<double>& process : times)
    if (!process.empty()) logs.push_back(std::log(std::max(median(process), least)));
  return logs.size() < 2 ? std::nullopt : std::optional(mean_of(logs));
}

LogTime mean_of(std::span<const double> logs) {
  const auto n = static_cast<double>(logs.size());
  LogTime mean{.freedom = n - 1};
  for (const double log : logs) mean.value += log / n;
  if (logs.size() < 2) return mean;
  for (const double log : logs) mean.variance += (log - mean.value) * (log - mean.value) / (n - 1) / n;
  return mean;
}

LogTime mean_of(std::span<const LogTime> times) {
  const auto n = static_cast<double>(times.size());
  LogTime mean{.freedom = freedom_of(times)};
  for (const LogTime& time : times) {
    mean.value += time.value / n;
    mean.variance += time.variance / (n * n);
  }
  return mean;
}

std::vector<bool> told_apart(std::span<const Contrast> contrasts) {
  if (contrasts.empty()) return {};
  std::vector<double> variances, p_values;
  for (const Contrast& c : contrasts) variances.push_back(c.greater.variance + c.least.variance);
  const double typical = median(variances);
  for (std::size_t k = 0; k < contrasts.size(); ++k) {
    const Contrast& c = contrasts[k];
    const LogTime parts[] = {c.greater, c.least};
    const double freedom = freedom_of(parts);
    const double variance = (typical_freedom * typical + freedom * variances[k]) / (typical_freedom + freedom);
    const double difference = c.greater.value - c.least.value;
    const double tail = variance > 0     ? student_tail(difference / std::sqrt(variance), typical_freedom + freedom)
                        : difference > 0 ? 0
                                         : 1;
    p_values.push_back(std::min(1.0, tail * static_cast<double>(c.among)));
  }
  std::vector<bool> told;
  for (const double rate : false_discovery_rates(p_values)) told.push_back(rate <= most_false);
  return told;
}

}  // namespace gnomon
