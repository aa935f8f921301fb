#pragma once
#include "measure/progress.h"
#include "measure/submission/rules.h"

namespace gnomon {

struct RepeatOptions {
  std::size_t rows = 12;
  int seed = 1;          ///< another one draws other rows
  WorkerOptions worker;  ///< with the plugins and programs that the user named
};

struct RepeatSummary {
  std::size_t equal = 0;         ///< rows that came out the same to the last digit
  std::size_t within = 0;        ///< drawn by another renderer, with masks within what drivers may do otherwise
  std::size_t not_repeated = 0;  ///< by another renderer, and further apart; or changed by an erratum
  std::size_t unable = 0;        ///< that nothing here can repeat: failed, or of code that is not here
  std::vector<std::string> faults, notes;
};

/// Runs a drawn sample of rows again with this program, by one process each, and compares all numbers that are no times, and
/// the masks. Only techniques of this program and those that the user named run: nothing from the folder does. A row that
/// another renderer drew is judged by its mask; DriverDifferences has what may differ.
RepeatSummary repeat_rows(const Submission& submission, const Edition& edition, const EditionPlaces& places,
                          SceneLibrary& library, const RepeatOptions& options, Progress& progress);

/// The rows that are drawn, by the number of the record, in the order of drawing; `may` says which rows can be.
std::vector<std::size_t> drawn_rows(std::span<const Record> records, std::size_t most, int seed,
                                    const std::function<bool(const Record&)>& may);

}  // namespace gnomon
