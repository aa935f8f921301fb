#include "measure/statistics/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "measure/statistics/resample.h"

namespace gnomon {

namespace {

/// Reorders the values.
double quantile_in_place(std::span<double> values, double q) {
  assert(!values.empty() && q >= 0 && q <= 1);
  const double place = q * static_cast<double>(values.size() - 1);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(place);
  std::nth_element(values.begin(), at, values.end());
  const double below = *at, above = at + 1 == values.end() ? below : *std::min_element(at + 1, values.end());
  // Equal neighbours are returned as they are: a sum of two products may miss them by a rounding.
  if (below == above) return below;
  return below + (place - std::floor(place)) * (above - below);
}

/// The continued fraction of the incomplete beta function (Abramowitz and Stegun 26.5.8), evaluated by Lentz's method. It
/// converges fast for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr double tiny = 1e-300, enough = 1e-14;
  const auto away_from_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
  double c = 1, d = 1 / away_from_zero(1 - (a + b) * x / (a + 1)), fraction = d;
  for (int m = 1; m < 1000; ++m) {
    const double terms[] = {m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)),
                            -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))};
    double step = 1;
    for (const double term : terms) {
      d = 1 / away_from_zero(1 + term * d);
      c = away_from_zero(1 + term / c);
      fraction *= step = c * d;
    }
    if (std::abs(step - 1) < enough) break;
  }
  return fraction;
}

/// Regularized incomplete beta function I_x(a, b). `rest` is 1 - x, from whoever knows it without the difference, which cancels
/// for an x near 1.
double incomplete_beta(double a, double b, double x, double rest) {
  if (x <= 0) return 0;
  if (rest <= 0) return 1;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(rest));
  return x < (a + 1) / (a + b + 2) ? front * beta_fraction(a, b, x) / a : 1 - front * beta_fraction(b, a, rest) / b;
}

}  // namespace

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
  if (medians.empty()) return std::nullopt;
  return median(medians);
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

double student_tail(double t, double freedom) {
  assert(freedom > 0);
  if (std::isnan(t)) return t;
  // Abramowitz and Stegun 26.7.1: both tails together are I_x(n / 2, 1 / 2) at x = n / (n + t^2).
  const double whole = freedom + t * t;
  const double tail = std::isinf(t) ? 0 : 0.5 * incomplete_beta(freedom / 2, 0.5, freedom / whole, t * t / whole);
  return t > 0 ? tail : 1 - tail;
}

double student_quantile(double tail, double freedom) {
  assert(tail > 0 && tail < 1);
  if (tail > 0.5) return -student_quantile(1 - tail, freedom);
  double low = 0, high = 1;
  while (student_tail(high, freedom) > tail && high < 1e150) high *= 2;
  for (int k = 0; k < 200 && low < high; ++k) {
    const double middle = (low + high) / 2;
    if (middle == low || middle == high) break;
    (student_tail(middle, freedom) > tail ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<double> false_discovery_rates(std::span<const double> p_values) {
  std::vector<std::size_t> order(p_values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> rates(p_values.size());
  // From the largest p down: the rank-th smallest would be called at p * count / rank, or with any larger one.
  double least = 1;
  for (std::size_t rank = order.size(); rank > 0; --rank) {
    least = std::min(least, p_values[order[rank - 1]] * static_cast<double>(order.size()) / static_cast<double>(rank));
    rates[order[rank - 1]] = least;
  }
  return rates;
}

}  // namespace gnomon
