#include "measure/score/coverage_error.h"

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

/// Of all numbers the median is the nearest to the reference in the mean. `tested` is that of the tested pixels.
std::optional<double> least_constant_error(std::vector<float> tested) {
  if (tested.empty()) return std::nullopt;
  const auto middle = tested.begin() + std::ssize(tested) / 2;
  std::ranges::nth_element(tested, middle);
  double sum = 0;
  for (const float reference : tested) sum += std::abs(reference - *middle);
  return sum / static_cast<double>(tested.size());
}

}  // namespace

std::optional<double> constant_error(const Scoring& s) {
  const Evidence& e = s.evidence();
  std::vector<float> tested;
  for (std::size_t i = 0; i < e.reference.size(); ++i)
    if (e.classes[i] == PixelClass::T) tested.push_back(e.reference[i]);
  return least_constant_error(std::move(tested));
}

std::optional<double> coverage_constant_error(const Scoring& s) {
  const Evidence& e = s.evidence();
  std::vector<float> tested;
  for (std::size_t i = 0; i < e.pixel_mean.size(); ++i)
    if (e.is_tested_over_pixel(i)) tested.push_back(e.pixel_mean[i]);
  return least_constant_error(std::move(tested));
}

std::optional<double> coverage_error(const Evidence& e, std::span<const float> values, int power) {
  double sum = 0;
  std::size_t tested = 0;
  for (std::size_t i = 0; i < e.pixel_mean.size(); ++i) {
    if (!e.is_tested_over_pixel(i)) continue;
    const double off = std::abs(static_cast<double>(values[i]) - e.pixel_mean[i]);
    sum += power == 2 ? off * off : off;
    ++tested;
  }
  if (tested == 0) return std::nullopt;
  const double mean = sum / static_cast<double>(tested);
  return power == 2 ? std::sqrt(mean) : mean;
}

}  // namespace gnomon
