#pragma once
#include "analysis/analysis.h"

namespace gnomon {

/// What one row is off by, by the distance of pixels to the seams of its technique's images.
struct SeamErrors {
  const Record* record = nullptr;
  std::vector<std::optional<double>> errors;  ///< of each bin; nothing where no pixel of T lies in it
  std::vector<std::optional<double>> shares;  ///< of T
  /// Of the pixels up to 8 px from a seam: their share of T, and the part of the error that they make; nothing of a row without
  /// an error.
  std::optional<double> near_share, near_part;
};

/// The bins as metrics name them, from near to far: "0_1" of `error_seam_0_1`.
std::vector<std::string> seam_bin_names();

/// The rows whose technique has seams, in their order. Throws Error when there is none.
std::vector<SeamErrors> find_seams(std::span<const Record> records);

}  // namespace gnomon
