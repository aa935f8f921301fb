#include "measure/statistics/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "measure/statistics/resample.h"

namespace gnomon {

/// Reorders the values.
static double quantile_in_place(std::span<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  const double place = q * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  const double below = *at, above = at + 1 == values.end() ? below : *std::min_element(at + 1, values.end());
  // Equal neighbours are returned as they are: a sum of two products may miss them by a rounding.
  if (below == above) return below;
  return below + (place - std::floor(place)) * (above - below);
}

/// The indices of the values, that of the least first.
static std::vector<std::size_t> rising(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  return order;
}

double quantile(std::span<const double> values, double q) {
  std::vector<double> copy(values.begin(), values.end());
  return quantile_in_place(copy, q);
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
  return medians.empty() ? std::nullopt : std::optional(median(medians));
}

std::optional<Estimate> bootstrap(const ProcessTimes& times) {
  ProcessTimes kept;
  std::ranges::copy_if(times, std::back_inserter(kept), [](const auto& process) { return !process.empty(); });
  if (kept.size() < 2) return std::nullopt;
  // PCG32's own first state and increment, written as seed and stream: intervals of all records were made with them.
  Random random(0xe5505758d9003cadu, 0xa02bdbf7bb3c0a7u);
  order_long_processes(kept);
  std::vector<double> resamples(resample_count), medians(kept.size()), scratch;
  for (double& resample : resamples) {
    for (double& process_median : medians) {
      const std::vector<double>& process = kept[random.below(static_cast<std::uint32_t>(kept.size()))];
      process_median = quantile_in_place(draw_repetitions(process, random, scratch), 0.5);
    }
    resample = quantile_in_place(medians, 0.5);
  }
  return Estimate{*median_of_medians(kept), quantile_in_place(resamples, 0.025), quantile_in_place(resamples, 0.975)};
}

std::vector<double> false_discovery_rates(std::span<const double> p_values) {
  const std::vector<std::size_t> order = rising(p_values);
  std::vector<double> rates(p_values.size());
  // From the largest p down: the rank-th smallest would be called at p * count / rank, or with any larger one.
  double least = 1;
  for (std::size_t rank = order.size(); rank > 0; --rank) {
    least = std::min(least, p_values[order[rank - 1]] * static_cast<double>(order.size()) / static_cast<double>(rank));
    rates[order[rank - 1]] = least;
  }
  return rates;
}

std::vector<double> family_rates(std::span<const double> p_values, std::size_t tests) {
  assert(tests >= p_values.size());
  const std::vector<std::size_t> order = rising(p_values);
  std::vector<double> rates(p_values.size());
  // From the smallest p up: each is called among those that are left, and only after all smaller ones.
  double most = 0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    most = std::max(most, std::min(1.0, p_values[order[rank]] * static_cast<double>(tests - rank)));
    rates[order[rank]] = most;
  }
  return rates;
}

}  // namespace gnomon
