#include "measure/frame/stated_errors.h"

#include <algorithm>
#include <cmath>

#include "measure/statistics/distributions.h"

namespace gnomon {

namespace {

constexpr std::array<double, 3> error_multiples = {2, 3, 4};
constexpr double degrees_of_freedom = 7;  // eight replicas

}  // namespace

StatedErrors stated_errors(std::string what, std::span<const double> differences, std::span<const double> errors,
                           double false_alarm) {
  StatedErrors result{.what = std::move(what), .count = differences.size()};
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const double off = std::abs(differences[i]);
    for (std::size_t k = 0; k < error_multiples.size(); ++k) result.beyond[k] += off > error_multiples[k] * errors[i];
    sum += differences[i];
    squares += differences[i] * differences[i];
    result.largest = std::max(result.largest, off);
  }
  for (std::size_t k = 0; k < error_multiples.size(); ++k)
    result.allowed[k] =
        most_by_chance(differences.size(), 2 * student_tail(error_multiples[k], degrees_of_freedom), false_alarm);
  const auto n = static_cast<double>(differences.size());
  if (n < 2) return result;
  result.mean = sum / n;
  result.mean_error = std::sqrt(std::max(0.0, squares / n - result.mean * result.mean) / (n - 1));
  // Masks are of float32, and so are the differences' last digits.
  result.is_mean_zero = std::abs(result.mean) <= 3.9 * result.mean_error + 1e-7;
  return result;
}

bool all_hold(std::span<const StatedErrors> comparisons) {
  const auto has_some = [](const StatedErrors& c) { return c.count > 0; };
  return std::ranges::any_of(comparisons, has_some) && std::ranges::all_of(comparisons, &StatedErrors::holds);
}

std::string text(const StatedErrors& s) {
  return fmt::format("  {}\n    {} exact shares; beyond 2, 3, 4 errors: {}, {}, {} (at most {}, {}, {}){}\n", s.what, s.count,
                     s.beyond[0], s.beyond[1], s.beyond[2], s.allowed[0], s.allowed[1], s.allowed[2],
                     s.holds() ? "" : "  REFUSED") +
         fmt::format("    mean difference {:.2g} +- {:.2g}, largest {:.2g}\n", s.mean, s.mean_error, s.largest);
}

std::string false_alarm_text(double false_alarm) {
  return fmt::format("  false alarms   a reference that keeps Student's law is refused once in {:.0f} comparisons\n",
                     1 / false_alarm);
}

}  // namespace gnomon
