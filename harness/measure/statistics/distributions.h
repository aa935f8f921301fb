#pragma once
#include <cstddef>

namespace gnomon {

/// P(T > t) for Student's t with `freedom` > 0 degrees of freedom, which need not be whole; NaN for a t that is NaN.
double student_tail(double t, double freedom);
/// The t with P(T > t) = tail, 0 < tail < 1.
double student_quantile(double tail, double freedom);

/// The least k with P(X > k) < false_alarm, X being the number of events in `total` independent trials with probability
/// `chance` each: more events than that are no chance.
std::size_t most_by_chance(std::size_t total, double chance, double false_alarm);

}  // namespace gnomon
