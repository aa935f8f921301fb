#pragma once
#include <gnomon/kit/random.h>

#include "measure/statistics/statistics.h"

namespace gnomon {

/// With more repetitions than this, a bootstrap draws the middle of a resample and not each of its values.
inline constexpr std::size_t most_drawn_singly = 100;

/// Sorts the repetitions of processes with more than `most_drawn_singly` in rising order, as `draw_repetitions` requires.
void order_long_processes(ProcessTimes& times);

/// Values with the median of as many repetitions of a process, one at least, drawn from it with replacement. Of a long process
/// these are the one or two in the middle, by their own distribution: the k-th of n uniform numbers has the beta distribution
/// of k and n - k + 1 (Devroye 1986, Non-Uniform Random Variate Generation, V.3.1), so that a draw takes no longer the longer
/// the process is. They lie in `scratch`.
std::span<double> draw_repetitions(const std::vector<double>& process, Random& random, std::vector<double>& scratch);

}  // namespace gnomon
