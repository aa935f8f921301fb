#pragma once
#include <optional>
#include <span>
#include <vector>

#include "measure/statistics/statistics.h"

namespace gnomon {

/// The logarithm of a time in milliseconds: the mean of the logarithms of its processes' medians.
struct LogTime {
  double value = 0;
  double variance = 0;  ///< of the value, from the spread of the processes
  double freedom = 0;   ///< degrees of freedom of the variance
};

/// Times below `least` count as that. Nothing below two processes.
std::optional<LogTime> log_time(const ProcessTimes& times, double least = least_time);

/// The mean of several that have nothing in common: the logarithm of a geometric mean.
LogTime mean_of(std::span<const LogTime> times);
/// The mean of logarithms, and the variance of that mean from their spread, 0 for one value.
LogTime mean_of(std::span<const double> logs);
/// Degrees of freedom of a sum of these (Welch and Satterthwaite): the least of theirs where no part varies.
double freedom_of(std::span<const LogTime> parts);

/// A time and a lesser one that it is compared with, which is the least of `among` times, or was chosen among as many.
struct Contrast {
  LogTime greater, least;
  std::size_t among = 2;
};

/// Which of these differences are real, with a rate of false calls of 5 % over them all (Benjamini and Hochberg 1995):
/// Student's t of each (Welch 1947), with variances shrunk toward the typical one (Smyth 2004), its tail times `among`, because
/// the least of many equal times is less than they are by chance alone.
std::vector<bool> told_apart(std::span<const Contrast> contrasts);

}  // namespace gnomon
