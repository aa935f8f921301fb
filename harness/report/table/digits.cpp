#include "report/table/digits.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gnomon {

std::string rounded(double value, int significant) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return fmt::format("{}", value);
  const auto decimals_for = [&](double x) {
    return std::max(0, significant - 1 - static_cast<int>(std::floor(std::log10(std::abs(x)))));
  };
  int decimals = decimals_for(value);
  // 9.996 rounds to 10.00: one digit more than requested.
  const double after = std::round(value * std::pow(10, decimals)) / std::pow(10, decimals);
  if (after != 0) decimals = decimals_for(after);
  return fmt::format("{:.{}f}", value, decimals);
}

std::string measured(double value) {
  // What rounds to 1 from below looks like its neighbors above.
  if (std::abs(value) >= 0.995 && std::abs(value) < 1) return value < 0 ? "-1.00" : "1.00";
  return rounded(value, std::abs(value) < 1 ? 2 : 3);
}

std::string milliseconds(double value) { return value > 0 && value < 0.001 ? "<0.001" : rounded(value, 3); }

std::string exact(double value) {
  char text[32];
  const bool is_whole = std::abs(value) < 0x1p53 && value == std::trunc(value);
  const std::to_chars_result end = is_whole ? std::to_chars(text, text + sizeof text, static_cast<long long>(value))
                                            : std::to_chars(text, text + sizeof text, value);
  return std::string(text, end.ptr);
}

}  // namespace gnomon
