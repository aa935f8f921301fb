#pragma once
#include <optional>

namespace gnomon {

/// Distances in pixels between the shadow boundaries of technique and reference, both ways; none when one side has none.
struct Displacement {
  std::optional<double> mean, p95;
};
struct Evidence;
Displacement measure_displacement(const Evidence& evidence);

}  // namespace gnomon
