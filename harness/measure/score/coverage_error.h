#pragma once
#include "measure/score/metrics.h"

namespace gnomon {

// What a mask errs by over whole pixels, and what the best mask without shadows errs by.

/// Error of the best mask of one value everywhere, by the truth at pixel centers and by the truth over the pixel.
std::optional<double> constant_error(const Scoring& s);
std::optional<double> coverage_constant_error(const Scoring& s);

/// The mean of |values - the truth over the pixel| to this power, 1 or 2, and of 2 its root; nothing where no pixel is tested
/// by it.
std::optional<double> coverage_error(const Evidence& e, std::span<const float> values, int power);

}  // namespace gnomon
