#include "measure/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// PCG32 (O'Neill 2014, XSH RR): the same stream on every machine and library, unlike the distributions of <random>.
class Pcg32 {
 public:
  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + 1442695040888963407u;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<int>(old >> 59);
    return (shifted >> turn) | (shifted << (-turn & 31));
  }
  /// Below `count`, by the high half of a product; the bias is below count / 2^32.
  std::size_t below(std::size_t count) { return (static_cast<std::uint64_t>(next()) * count) >> 32; }

 private:
  std::uint64_t state_ = 0x853c49e6748fea9bu;
};

/// Sorts in place.
double sorted_quantile(std::span<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  // Equal neighbours are returned as they are: a sum of two products may miss them by a rounding.
  if (values[below] == values[above]) return values[below];
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

ProcessTimes without_empty(const ProcessTimes& times) {
  ProcessTimes kept;
  for (const std::vector<double>& process : times)
    if (!process.empty()) kept.push_back(process);
  return kept;
}

/// One resample of the statistic. Its buffers are kept from call to call.
class Resampler {
 public:
  explicit Resampler(ProcessTimes times) : times_(std::move(times)), medians_(times_.size()) {}

  double draw(Pcg32& random) {
    for (double& process_median : medians_) {
      const std::vector<double>& process = times_[random.below(times_.size())];
      repetitions_.resize(process.size());
      for (double& repetition : repetitions_) repetition = process[random.below(process.size())];
      process_median = sorted_quantile(repetitions_, 0.5);
    }
    return sorted_quantile(medians_, 0.5);
  }

 private:
  ProcessTimes times_;
  std::vector<double> medians_, repetitions_;
};

/// The percentile interval of `resample_count` values of `draw`.
template <class Draw>
Estimate estimate(double value, Draw draw) {
  std::vector<double> resamples(resample_count);
  for (double& resample : resamples) resample = draw();
  return {value, sorted_quantile(resamples, 0.025), sorted_quantile(resamples, 0.975)};
}

}  // namespace

double quantile(std::span<const double> values, double q) {
  std::vector<double> copy(values.begin(), values.end());
  return sorted_quantile(copy, q);
}

double median(std::span<const double> values) { return quantile(values, 0.5); }

double median_absolute_deviation(std::span<const double> values) {
  const double center = median(values);
  std::vector<double> distances;
  for (const double value : values) distances.push_back(std::abs(value - center));
  return median(distances);
}

std::optional<double> median_of_medians(const ProcessTimes& times) {
  std::vector<double> medians;
  for (const std::vector<double>& process : times)
    if (!process.empty()) medians.push_back(median(process));
  if (medians.empty()) return std::nullopt;
  return median(medians);
}

std::optional<Estimate> bootstrap(const ProcessTimes& times) {
  const ProcessTimes kept = without_empty(times);
  if (kept.size() < 2) return std::nullopt;
  Pcg32 random;
  Resampler resampler(kept);
  return estimate(*median_of_medians(kept), [&] { return resampler.draw(random); });
}

std::optional<Estimate> bootstrap_ratio(const ProcessTimes& contender, const ProcessTimes& base) {
  const ProcessTimes top = without_empty(contender), bottom = without_empty(base);
  if (top.size() < 2 || bottom.size() < 2) return std::nullopt;
  for (const std::vector<double>& process : bottom)
    for (const double time : process)
      if (!(time > 0)) return std::nullopt;
  Pcg32 random;
  Resampler top_resampler(top), bottom_resampler(bottom);
  return estimate(*median_of_medians(top) / *median_of_medians(bottom), [&] {
    const double numerator = top_resampler.draw(random);
    return numerator / bottom_resampler.draw(random);
  });
}

}  // namespace gnomon
