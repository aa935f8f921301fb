#pragma once
// Private to the command `submission`: the folder that a run becomes. docs/submissions.md describes it.
#include <filesystem>
#include <optional>
#include <string>

#include "measure/submission/submission.h"

namespace gnomon::app {

/// What a maker adds to a run.
struct SubmissionWords {
  std::string name;
  std::optional<std::string> tuning, notes;
};

/// Writes the submission of a run's folder below `folder`, which is empty: records without paths of this machine, masks, run,
/// table, and what says which files belong to it. Throws Error on a run that is none of an edition, and on masks that are not
/// there or are links.
void write_submission(const std::filesystem::path& run, const SubmissionWords& words, const std::filesystem::path& folder);

/// The table of a submission, as `make` writes it.
std::string submission_table(const Submission& submission);

}  // namespace gnomon::app
