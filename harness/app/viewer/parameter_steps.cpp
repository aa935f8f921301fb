#include "app/viewer/parameter_steps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <type_traits>

namespace gnomon::viewer {

namespace {

constexpr double slack = 1e-9;  // relative: what is nearer to a value of a series is that value

/// 1, 2 or 5 times a power of ten, exactly as its digits are read.
double round_number(int times, int power) { return std::stod(fmt::format("{}e{}", times, power)); }

/// The nearest of the series ... 0.5, 1, 2, 5, 10 ... above a positive value, or below it.
double next_round(double value, bool is_up) {
  const int power = static_cast<int>(std::floor(std::log10(value)));
  double below = 0, above = std::numeric_limits<double>::infinity();
  for (int k = power - 1; k <= power + 1; ++k)
    for (const int times : {1, 2, 5}) {
      const double known = round_number(times, k);
      if (known < value * (1 - slack)) below = std::max(below, known);
      if (known > value * (1 + slack)) above = std::min(above, known);
    }
  return is_up ? above : below;
}

/// The nearest power of two above a value, or below it.
double next_power_of_two(double value, bool is_up) {
  double power = 1;
  while (is_up ? power <= value : 2 * power < value) power *= 2;
  return power;
}

/// A fiftieth of a range, or somewhat more.
double linear_step(double range) { return range > 0 ? next_round(range / 50 * (1 - 2 * slack), true) : 0; }

template <class T>
double step_of(const Number<T>& row, double value, bool is_up) {
  constexpr bool is_whole = std::is_same_v<T, int>;
  const auto& range = row.range();
  const double low = range.min, high = range.max;
  if (range.log) {
    // A range may begin at 0, which the series never reaches.
    const double least = is_whole ? 1 : 1e-6 * high;
    if (value < least) return is_up ? std::min(least, high) : low;
    const double next = is_whole ? next_power_of_two(value, is_up) : next_round(value, is_up);
    return !is_up && value <= least * (1 + slack) ? low : std::clamp(next, low, high);
  }
  const double step = is_whole ? std::max(1.0, linear_step(high - low)) : linear_step(high - low);
  const double next = value + (is_up ? step : -step);
  return std::clamp(std::abs(next) < slack * step ? 0 : next, low, high);
}

template <class T>
std::string number_after(const Number<T>& row, int steps) {
  double value = row.value();
  for (int k = 0; k < std::abs(steps); ++k) value = step_of(row, value, steps > 0);
  if constexpr (std::is_same_v<T, int>) return fmt::format("{}", static_cast<std::int64_t>(value));
  // Twelve digits: 0.1 + 0.2 is 0.3. The ends of the range are themselves.
  const bool is_end = value == row.range().min || value == row.range().max;
  return is_end ? fmt::format("{}", value) : fmt::format("{:.12g}", value);
}

}  // namespace

std::string value_after(const Parameter& row, int steps) {
  if (steps == 0) return row.text();
  if (const auto* whole = dynamic_cast<const Number<int>*>(&typed(row))) return number_after(*whole, steps);
  if (const auto* real = dynamic_cast<const Number<double>*>(&typed(row))) return number_after(*real, steps);
  const std::vector<std::string> texts = row.probes();
  const auto count = std::ssize(texts);
  const auto here = std::ranges::find(texts, row.text()) - texts.begin();
  return texts[(((here + steps) % count) + count) % count];
}

}  // namespace gnomon::viewer
