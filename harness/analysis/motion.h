#pragma once
#include "analysis/analysis.h"

namespace gnomon {

/// What one row did along its path.
struct PathErrors {
  const Record* record = nullptr;
  std::size_t frames = 0;
  struct Range {
    double mean = 0, least = 0, greatest = 0;
    std::size_t worst = 0;  ///< frame of the worst value, from 0
  };
  std::optional<Range> instability;  ///< between a frame and the one before; nothing when never defined
  std::optional<Range> error;        ///< of the requested metric
  /// Of the metrics over all frames, in the order of names_over_time; nothing where one is not defined.
  std::vector<std::optional<double>> over_time;
  bool has_over_time() const;
};

/// The metrics that a row on a path has over all its frames.
std::vector<std::string> names_over_time();

/// The rows that follow a path, in their order, with the range of `error` over the frames. Throws Error when there is none, or
/// when none has this metric.
std::vector<PathErrors> find_motion(std::span<const Record> records, const std::string& error = "error");

}  // namespace gnomon
