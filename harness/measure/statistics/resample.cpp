#include "measure/statistics/resample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

/// In (0, 1).
double uniform(Random& random) { return (random.next() + 0.5) * 0x1p-32; }

double normal(Random& random) {
  const double far = std::sqrt(-2 * std::log(uniform(random)));
  return far * std::cos(2 * std::numbers::pi * uniform(random));
}

/// Of a shape of at least 1 (Marsaglia and Tsang 2000, A Simple Method for Generating Gamma Variables).
double gamma(double shape, Random& random) {
  const double d = shape - 1.0 / 3, c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = normal(random), root = 1 + c * x, v = root * root * root;
    if (v > 0 && std::log(uniform(random)) < x * x / 2 + d - d * v + d * std::log(v)) return d * v;
  }
}

/// The k-th smallest of n uniform numbers, k from 1.
double order_statistic(std::size_t k, std::size_t n, Random& random) {
  const double below = gamma(static_cast<double>(k), random), above = gamma(static_cast<double>(n - k + 1), random);
  return below / (below + above);
}

}  // namespace

void order_long_processes(ProcessTimes& times) {
  for (std::vector<double>& process : times)
    if (process.size() > most_drawn_singly) std::sort(process.begin(), process.end());
}

std::span<double> draw_repetitions(const std::vector<double>& process, Random& random, std::vector<double>& scratch) {
  const std::size_t count = process.size();
  if (count <= most_drawn_singly) {
    scratch.resize(count);
    for (double& one : scratch) one = process[random.below(static_cast<std::uint32_t>(count))];
    return scratch;
  }
  const auto at = [&](double share) {
    return process[std::min(static_cast<std::size_t>(share * static_cast<double>(count)), count - 1)];
  };
  const std::size_t middle = (count + 1) / 2;
  const double lower = order_statistic(middle, count, random);
  scratch = {at(lower)};
  // The next one is the least of the count - middle numbers that are uniform above it.
  if (count % 2 == 0)
    scratch.push_back(at(1 - (1 - lower) * std::pow(uniform(random), 1 / static_cast<double>(count - middle))));
  return scratch;
}

}  // namespace gnomon
