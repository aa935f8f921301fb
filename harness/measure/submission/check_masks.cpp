#include "measure/submission/check_masks.h"

#include "measure/images/image_files.h"
#include "measure/row/rescore.h"
#include "measure/submission/numbers.h"
#include "measure/submission/rules.h"
#include "measure/worker/machine_context.h"

namespace gnomon {

namespace {

/// Before a picture is read: a small file may hold a huge one.
void check_header(const Record& record, const std::filesystem::path& file) {
  const auto [width, height] = image_files().exr_size(file);
  if (width != record.width || height != record.height)
    throw Error("{} has {}x{} pixels, and its row {}x{}", file.string(), width, height, record.width, record.height);
  // Of a light: visibility, cause, visibility under the other truth; of all light two pictures in color.
  const std::size_t most = 3 * std::size(record.lights) + 6;
  const std::size_t count = image_files().exr_channels(file).size();
  if (count > most) throw Error("{} has {} channels; a mask of its row has at most {}", file.string(), count, most);
}

/// Causes need the reference that they were found with.
bool has_kept_causes(const Record& before, const Record& after) {
  return after.causes.has_value() == before.causes.has_value();
}

}  // namespace

MaskCheck check_masks(const Submission& submission, Progress& progress) {
  for (const Record& record : submission.records)
    if (record.mask) check_header(record, submission.folder / *record.mask);
  std::vector<Record> again = submission.records;
  RescoreSummary summary;
  try {
    summary = rescore(again, submission.folder, progress);
  } catch (const Error& problem) {  // what is no mask of its row, or no causes of it
    return {.rows = 0, .faults = {problem.what()}, .notes = {}};
  }
  MaskCheck check{.rows = summary.rows, .faults = {}, .notes = std::move(summary.notes)};
  const std::string processor = plain_text(machine_context(0)["processor"]);
  Faults faults;
  std::size_t untested = 0;
  for (std::size_t k = 0; k < again.size(); ++k) {
    const Record& stated = submission.records[k];
    std::vector<NumberDifference> found = mask_differences(stated, again[k], has_kept_causes(stated, again[k]));
    if (!found.empty() && context_text(stated, "processor") != processor) {
      found = of_tested_pixels(std::move(found));
      untested += found.empty();
    }
    if (!found.empty()) faults.add(fmt::format("its numbers are not those of its mask: {}", first_of(found)), stated);
  }
  if (untested > 0)
    check.notes.push_back(
        fmt::format("rows whose pixels that are not tested came out otherwise on this processor: {}", untested));
  check.faults = faults.lines();
  return check;
}

}  // namespace gnomon
