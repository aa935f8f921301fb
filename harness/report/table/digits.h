#pragma once
#include <string>

namespace gnomon {

/// `value` without exponent, rounded to `significant` digits; digits before the point are never dropped: 3 digits give
/// "0.0123", "1.23", "12.3", "123", "1235". Zero is "0".
std::string rounded(double value, int significant);

/// As many digits as a rate, a size or a distance deserves: three from 1 up, two below.
std::string measured(double value);

/// A time: three digits, but nothing finer than the microsecond that a call and the clock cost: "<0.001" below it.
std::string milliseconds(double value);

/// The shortest text that reads back as the same double, `.` for the decimal point in every locale; whole numbers below
/// 2^53 without exponent.
std::string exact(double value);

}  // namespace gnomon
