#pragma once
#include "measure/submission/submission.h"

namespace gnomon {

// What a submission must keep, as docs/run_rules.md has it. Each function returns what is against the rules, a line each, and
// runs nothing; nothing is right without these, and all may be right of a forged one.

/// Lines of faults. What several rows have in common is one line, with the first row that has it.
class Faults {
 public:
  /// Of a line that is there already it adds nothing.
  void add(const std::string& what);
  void add(const std::string& what, const Record& row);
  std::vector<std::string> lines() const;

 private:
  std::vector<std::pair<std::string, std::vector<std::string>>> lines_;  ///< with titles of rows
};

/// Files that are not those that submission.json states.
std::vector<std::string> file_faults(const Submission& submission);

/// Which program and which code made the rows: one clean commit, runs of this edition and division, the code that is named.
std::vector<std::string> origin_faults(const Submission& submission);

/// What is missing in the description of the system, and what rows say otherwise.
std::vector<std::string> system_faults(const Submission& submission);

/// Whether the division's words on settings are there, and name training scenes alone. `scenes` are all that this program has,
/// by id.
std::vector<std::string> tuning_faults(const SubmissionFacts& facts, const Edition& edition,
                                       const std::vector<std::string>& scenes);

/// Times that contradict each other: they were changed, or something is broken.
std::vector<std::string> time_faults(std::span<const Record> records);

/// The places of an edition, by group: jobs without a contender.
using EditionPlaces = std::vector<std::vector<Job>>;
/// Loads scenes; no technique runs. Throws Error as expand_jobs does.
EditionPlaces edition_places(const Edition& edition, SceneLibrary& library);

/// Whether a technique with these settings supports nothing in a group, by its number in the edition; nothing where the
/// technique is not here.
using SupportsNothing = std::function<std::optional<bool>(const Contender& contender, std::size_t group)>;
/// Of a technique that this program has, asked in a worker.
SupportsNothing supports_nothing(const Edition& edition, SceneLibrary& library, const WorkerOptions& worker);

struct RowFaults {
  std::vector<std::string> faults;
  std::vector<std::string> notes;  ///< what could not be checked
};
/// Rows that the edition does not have, that are missing, twice or not as the edition asks: scene, size, settings, effort,
/// metrics.
RowFaults row_faults(const Submission& submission, const Edition& edition, const EditionPlaces& places,
                     const SupportsNothing& supports_nothing);

/// The job of a row among an edition's places; null where there is none.
const Job* place_of(const Record& record, const Edition& edition, const EditionPlaces& places);

}  // namespace gnomon
