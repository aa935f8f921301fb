#pragma once
#include "measure/progress.h"
#include "measure/submission/submission.h"

namespace gnomon {

struct MaskCheck {
  std::size_t rows = 0;             ///< whose numbers were computed from their masks
  std::vector<std::string> faults;  ///< numbers that their masks do not have, a line each
  std::vector<std::string> notes;   ///< which rows could not be computed, and why
};

/// Computes classes, metrics and causes of all rows from their masks, as `table --rescore` does, and compares. No technique
/// runs. The rows keep the other rules. Throws Error on a mask that is no picture of the row's size with the channels of a row.
MaskCheck check_masks(const Submission& submission, Progress& progress);

}  // namespace gnomon
