#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <string>

#include "measure/fields.h"

namespace gnomon {

/// Differences of a reference made of eight replicas from exact values, beside the standard errors that it states. Student's
/// law of seven degrees of freedom lets so many lie beyond 2, 3 and 4 standard errors, and their mean is 0.
struct StatedErrors {
  std::string what;  ///< "area in penumbrae"
  std::size_t count = 0;
  std::array<std::size_t, 3> beyond{}, allowed{};  ///< 2, 3 and 4 standard errors; allowed but for false alarms
  double mean = 0, mean_error = 0;                 ///< of the differences, and the standard error of that
  double largest = 0;                              ///< absolute difference
  bool is_mean_zero = true;                        ///< within its interval
  bool holds() const { return beyond[0] <= allowed[0] && beyond[1] <= allowed[1] && beyond[2] <= allowed[2] && is_mean_zero; }
};

/// Of as many differences as errors. `false_alarm` is the chance that a reference which keeps the law to the letter is refused.
StatedErrors stated_errors(std::string what, std::span<const double> differences, std::span<const double> errors,
                           double false_alarm);
/// Whether there is something to hold, and all of it does.
bool all_hold(std::span<const StatedErrors> comparisons);

/// Two lines for the terminal.
std::string text(const StatedErrors& errors);
/// One line for the terminal.
std::string false_alarm_text(double false_alarm);
/// Keys in alphabetical order.
void for_each_field(MaybeConst<StatedErrors> auto& c, const auto& use) {
  const bool holds = c.holds();
  use("allowed", c.allowed, "beyond", c.beyond, "count", c.count, "holds", holds, "largest", c.largest, "mean", c.mean,
      "mean_error", c.mean_error, "what", c.what);
}

}  // namespace gnomon
