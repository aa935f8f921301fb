#pragma once
#include <filesystem>

#include "analysis/analysis.h"
#include "measure/progress.h"

namespace gnomon {

/// How far the masks of two rows of one place differ, over the pixels of T.
struct MaskDifference {
  const Record *base = nullptr, *other = nullptr;
  double changed = 0;   ///< share of T that differs by more than 1/256
  double mean = 0;      ///< of |V - V_base|
  double rms = 0;       ///< root of the mean square
  double greatest = 0;  ///< of |V - V_base|
};

struct MaskDifferences {
  std::vector<MaskDifference> pairs;  ///< in the order of the records
  std::vector<std::string> notes;     ///< which rows are left out, and why
};

/// The first row of each place that has a mask below `dir` against each other one there: no technique runs. G-buffers and
/// references, which say what is tested, come from the frame cache or are made. Rows on paths are left out, since only their
/// last mask is kept, and so are rows whose scene is not the one that was measured. Throws Error when no two rows are left in
/// one place, and one that names the row when its mask is missing, broken or of the wrong size.
MaskDifferences compare_masks(std::span<const Record> records, const std::filesystem::path& dir, Progress& progress);

}  // namespace gnomon
