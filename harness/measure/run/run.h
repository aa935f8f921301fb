#pragma once
#include "measure/run/unfinished.h"

namespace gnomon {

/// The edition whose rows a run has, as run.json says it.
struct RunEdition {
  std::string name, hash;
  std::string division;  ///< see Division in measure/edition/edition.h
  bool operator==(const RunEdition&) const = default;
};

struct RunOptions {
  Suite suite;
  std::optional<RunEdition> edition;  ///< nothing: of none
  std::filesystem::path out;
  std::string filter;  ///< regular expression over "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS"; empty: all
  bool resume = false;
  bool retry_failed = false;             ///< with resume: rows that failed are run again
  bool rebuilt = false;                  ///< with resume: rows that other code measured are run again, and no error
  bool any_effort = false;               ///< with resume: rows may have any number of processes and repetitions
  std::vector<std::string> command;      ///< the words by which the program was called, for run.json
  int shard_index = 0, shard_count = 1;  ///< runs the jobs of this shard, by their hash
  WorkerOptions worker;                  ///< of this program
};

struct RunSummary {
  std::size_t ok = 0, unsupported = 0, failed = 0;
  std::size_t done_before = 0;  ///< found in the folder by --resume
  double seconds = 0;
  std::vector<std::string> left_out;  ///< see SuiteJobs
};

/// Those of `jobs` (all of the suite) that the options select, in order. Throws Error on a bad expression.
std::vector<Job> select_jobs(const RunOptions& options, std::vector<Job> jobs);

/// The rows in a folder in which a run continues.
struct Earlier {
  std::vector<Record> kept;        ///< numbered as the suite numbers its rows now, in order of the file
  std::set<std::string> done;      ///< jobs of `kept`: they are not run again
  std::vector<Record> dropped;     ///< rows that are run again, whose pictures go
  bool is_changed = false;         ///< the file does not hold `kept` as it is: rows went, or have new places
  std::vector<std::string> notes;  ///< for readers of the table: other processors, other numbers of threads
};

/// Scenes of the suite that records in the folder name by another path to the same file get the name in the records, so that a
/// run may continue from any folder.
void use_recorded_scenes(const std::filesystem::path& out, Suite& suite, SceneLibrary& library);

/// Reads options.out; nothing where there are no records. `suite` are all jobs of the suite, `jobs` the selected ones. These
/// rows are removed and run again:
///   - of a scene that was not fetched then and is now;
///   - of `jobs`, failed, with `retry_failed`;
///   - of `jobs`, with a plugin that was built anew;
///   - with `rebuilt`, measured by other code: of all techniques, or of its own.
/// Rows that one table cannot have with new ones are an Error: of a scene that has changed since, of other code, of a plugin as
/// it was when they are not in `jobs`, of another suite, of another edition or division, and of the same suite with other
/// processes, repetitions or truth. So is a folder without any row of the suite. Where it has some, a note counts the rest.
Earlier earlier_rows(const RunOptions& options, SceneLibrary& library, std::span<const Job> suite, std::span<const Job> jobs);

/// The folder of a run while rows are added to it, all at once or in rounds. It belongs to one run at a time.
class OpenRun {
 public:
  /// Makes the folder or continues it; `suite` are all jobs that it may get, `jobs` those that are selected. Throws Error on a
  /// folder that another run writes, and on one with records that the options do not continue (earlier_rows).
  OpenRun(const RunOptions& options, SceneLibrary& library, std::span<const Job> suite, std::span<const Job> jobs,
          Progress& progress);
  const Earlier& earlier() const { return earlier_; }

  /// How rows are added.
  struct Round {
    const Suite& suite;  ///< processes, repetitions and pictures
    Progress& progress;
    std::function<void(const Record&)> seen = {};  ///< called with each row when it is in the file
    std::function<bool()> is_over = {};            ///< asked before every batch of rows: whether the rest is not run
  };
  /// Runs these jobs: a row of a job that has one already counts in its place. A worker that fails costs its own row. The
  /// times of the rows are kept for estimates (estimate.h). Throws Error on a full disk.
  void add_rows(std::span<const Job> jobs, const Round& round);
  void close() { writer_.close(); }

 private:
  const RunOptions& options_;
  SceneLibrary& library_;
  RecordWriter writer_;
  Earlier earlier_;
  std::optional<UnfinishedRows> unfinished_;
};

/// Runs the selected jobs: one record per job in OUT/records.jsonl, masks, error pictures and shaded pictures beside it. Throws
/// Error as OpenRun does.
RunSummary run_suite(const RunOptions& options, SceneLibrary& library, Progress& progress);

/// Runs every selected job with two programs side by side: workers of both live at once and their repetitions are interleaved
/// at random, so that the machine's load affects both alike. The scenes, G-buffers and references are this program's, the
/// contender. The folders `base` and `contender` in `out` become runs of their own; both have the same mark in the context of
/// their records, by which compare finds that their processes are pairs. Throws Error when the other program cannot serve this
/// one, and when a folder contains records already.
void run_live(const RunOptions& options, const std::string& base_program, SceneLibrary& library, Progress& progress);

}  // namespace gnomon
