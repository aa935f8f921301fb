#pragma once
#include <optional>
#include <span>

#include "measure/statistics/statistics.h"

namespace gnomon {

/// Of so many differences and fewer, all flips of their signs are counted; of more, some are drawn.
inline constexpr std::size_t most_flipped = 18;
/// How many are drawn at least.
inline constexpr std::size_t usual_flips = 99'999;

/// Whether differences lie about zero. Were the two of each pair alike, each difference might as well have the other sign.
struct SignFlips {
  double mean = 0;  ///< of the differences
  /// The share of all choices of signs whose sum is at least as far from 0: 2^(1 - n) at least, of n differences.
  double p = 1;
  /// The mean and the 95 % interval of the center: all that this test does not refuse at 5 %, between two means of subsets
  /// (Hartigan 1969). Nothing below six differences, where no center can be refused.
  std::optional<Estimate> center = {};
  std::size_t drawn = 0;  ///< flips that were drawn; 0: all were counted
};

/// The sign-flip test (Fisher 1935). Same differences, same answer. Of more than `most_flipped` differences `flips` are drawn,
/// and p is 1 / (flips + 1) at least.
SignFlips flip_signs(std::span<const double> differences, std::size_t flips = usual_flips);

}  // namespace gnomon
