#include "measure/statistics/sign_flip.h"

#include <gnomon/kit/random.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace gnomon {

namespace {

constexpr double false_share = 0.05;

/// The differences whose signs a flip keeps.
struct Subset {
  double sum = 0, size = 0;
};

/// All of them, the empty one first.
std::vector<Subset> all_subsets(std::span<const double> differences) {
  std::vector<Subset> subsets(1);
  subsets.reserve(std::size_t{1} << differences.size());
  for (const double difference : differences) {
    const std::size_t known = subsets.size();
    for (std::size_t k = 0; k < known; ++k) subsets.push_back({subsets[k].sum + difference, subsets[k].size + 1});
  }
  return subsets;
}

/// So many, none of them empty.
std::vector<Subset> drawn_subsets(std::span<const double> differences, std::size_t count) {
  Random random(1);
  std::vector<Subset> subsets;
  subsets.reserve(count);
  while (subsets.size() < count) {
    Subset subset;
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < differences.size(); ++k) {
      if (k % 32 == 0) bits = random.next();
      if (bits >> k % 32 & 1) subset = {subset.sum + differences[k], subset.size + 1};
    }
    if (subset.size > 0) subsets.push_back(subset);
  }
  return subsets;
}

/// The center is as likely between any two neighbors of these means, n of them, as below the least and above the greatest:
/// each with a chance of 1 / (n + 1).
std::optional<Estimate> center_of(double mean, std::span<const Subset> subsets) {
  std::vector<double> means;
  for (const Subset& subset : subsets)
    if (subset.size > 0) means.push_back(subset.sum / subset.size);
  const auto left_out = static_cast<std::ptrdiff_t>(false_share / 2 * static_cast<double>(means.size() + 1));
  if (left_out == 0) return std::nullopt;
  const auto low = means.begin() + (left_out - 1), high = means.end() - left_out;
  std::nth_element(means.begin(), low, means.end());
  const double least = *low;
  std::nth_element(means.begin(), high, means.end());
  return Estimate{mean, least, *high};
}

}  // namespace

SignFlips flip_signs(std::span<const double> differences, std::size_t flips) {
  if (differences.empty()) return {};
  const bool is_exact = differences.size() <= most_flipped;
  const std::vector<Subset> subsets = is_exact ? all_subsets(differences) : drawn_subsets(differences, flips);
  double sum = 0, size = 0;
  for (const double difference : differences) {
    sum += difference;
    size += std::abs(difference);
  }
  // Sums in another order differ in their last bits.
  constexpr double rounding = 1e-12;
  const double least = std::abs(sum) - rounding * size;
  const auto is_as_far = [&](const Subset& subset) { return std::abs(2 * subset.sum - sum) >= least; };
  const auto far = static_cast<double>(std::ranges::count_if(subsets, is_as_far));
  const auto count = static_cast<double>(subsets.size());
  const double mean = sum / static_cast<double>(differences.size());
  return {.mean = mean,
          .p = is_exact ? far / count : (far + 1) / (count + 1),
          .center = center_of(mean, subsets),
          .drawn = is_exact ? 0 : flips};
}

}  // namespace gnomon
