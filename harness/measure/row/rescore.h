#pragma once
#include "measure/progress.h"
#include "measure/record/record.h"

namespace gnomon {

/// The outcome of rescoring.
struct RescoreSummary {
  std::size_t rows = 0;            ///< measured anew
  std::vector<std::string> notes;  ///< which rows keep their old metrics or lose their causes, and why
};

/// Today's metrics, classes and counts of causes for old records, from the masks in the run's folder: no technique runs. Scenes
/// are loaded, G-buffers and references come from the frame cache or are made. A row keeps what it has, with a note, when it
/// followed a path or an animation (only its last mask is kept), or when its scene is not available as it was measured. A mask
/// whose channel for a truth was not written leaves that part as it was. Causes that were found on other frames than today's
/// (see frame_version), or that the file lacks, are dropped with a note. Rows that are not ok are skipped. Throws Error that
/// names the row when its mask is missing, broken or of the wrong size.
RescoreSummary rescore(std::vector<Record>& records, const std::filesystem::path& dir, Progress& progress);

}  // namespace gnomon
