#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "measure/record/record.h"

namespace gnomon {

struct Report {
  std::string html;
  std::vector<std::string> notes;  ///< what the page leaves out, and why; the page contains them, too
};

/// One HTML page of a run, which needs no other file: the table, plots and the image comparer. `dir` is the run's folder: masks
/// are read from there, scenes and references from the frame cache. What cannot be shown is left out with a note. Pictures of
/// the frames of rows on a path are part of it while they are small (most_frame_bytes), unless `with_all_frames`. Throws Error
/// when the program was built without the page (GNOMON_REPORT=OFF).
Report make_report(const std::filesystem::path& dir, std::span<const Record> records, bool with_pictures,
                   bool with_all_frames = false);

}  // namespace gnomon
