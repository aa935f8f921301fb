#pragma once
#include <gnomon/param.h>

#include <string>

namespace gnomon::viewer {

/// The value of a parameter so many steps on, as text that it accepts; back for steps below 0. Words, boxes and techniques go
/// round in their order. Numbers stop at the ends of their range. Where the range is logarithmic, whole numbers go from power
/// of two to power of two, others through 1, 2, 5, 10 and their like; else a step is about a fiftieth of the range, again 1, 2
/// or 5 times a power of ten, and of whole numbers 1 at least.
std::string value_after(const Parameter& row, int steps);

}  // namespace gnomon::viewer
