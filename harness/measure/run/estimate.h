#pragma once
#include "measure/run/jobs.h"

namespace gnomon {

/// How often a row repeats what it times.
struct Effort {
  int processes = 5, warmups = 3, repetitions = 3;
};

/// What a row of an earlier run took, split by what it grows with.
struct RowCost {
  std::string job, scene, technique, settings, path;
  int width = 0, height = 0;
  int frames = 1;                ///< each has its references, masks and causes; 0: unknown
  std::string machine;           ///< machine_name() of where it ran
  bool is_measured = false;      ///< status ok: other rows may be guessed from it
  double once = 0;               ///< seconds of the row: first answer, its score, its pictures
  double process = 0;            ///< seconds of each process: its share of opening and setup
  std::array<double, 3> stages;  ///< milliseconds of build, relight, resolve
  double motion = 0;             ///< milliseconds of a frame in which the geometry moved; 0: it stands still

  double seconds(const Effort& effort) const;
};

/// Seconds of a process that opens a worker and its scene, where a record does not have them apart from the rest.
inline constexpr double usual_opening = 0.04;

/// The cost of a record's row that was run with so many warm-ups and `opening` seconds for each process.
RowCost cost_of(const Record& record, int warmups = 3, double opening = usual_opening);

/// Processor, cores and threads: what a time depends on most.
std::string machine_name(const Json& context);

/// Costs by job and machine, bounded; a file that all runs of one user write. Rows that cannot be read are left out: it is a
/// memory, not a result.
class History {
 public:
  static constexpr std::size_t most_rows = 4000;
  explicit History(std::filesystem::path file) : file_(std::move(file)) {}
  std::vector<RowCost> read() const;
  /// Replaces the costs of these jobs on their machine, and removes the oldest rows beyond `most_rows`. One writer at a time:
  /// others wait. Throws Error when the file cannot be written.
  void add(std::span<const RowCost> costs) const;

 private:
  std::filesystem::path file_;
};
/// CACHE/history.jsonl.
History own_history();

/// Costs of all results/*/records.jsonl that come with the program, for a fresh clone. Files that are no records are left out.
/// CACHE/shipped_costs.jsonl, where there is a cache, keeps them until one of the files changes.
std::vector<RowCost> shipped_costs();

struct TimeEstimate {
  double seconds = 0;
  std::size_t here = 0, elsewhere = 0, similar = 0;  ///< rows measured on this machine, on another, guessed
  std::size_t unknown = 0;                           ///< rows without any basis
};

/// What these jobs will take on `machine`, by the nearest earlier row: the same job; else the same technique on the same scene,
/// scaled by pixels and frames; else the median of the technique; else of everything. At each of these, rows of this machine
/// count before those of others, whose times are scaled by the median ratio over the jobs that both have run (from five on).
class Estimator {
 public:
  Estimator(std::vector<RowCost> costs, std::string machine);
  TimeEstimate operator()(std::span<const Job> jobs, const Effort& effort) const;

 private:
  std::vector<RowCost> costs_;  ///< those of other machines scaled to this one
  std::string machine_;
};

/// "estimated time: 4 min 10 s (from 140 rows measured on this machine, 18 guessed from similar rows)".
std::string text(const TimeEstimate& estimate);

}  // namespace gnomon
