#pragma once
#include "measure/run/jobs.h"

namespace gnomon {

/// A program that serves rows, and the folder for their pictures. Usually there is one; two are timed side by side.
struct Side {
  WorkerOptions worker;
  std::filesystem::path out;
};

/// One row on its way: its record, and where it is in its batch.
struct PendingRow {
  Job job;
  Record record;
  std::size_t contender = 0;  ///< index into the contenders of its batch
  bool over = false;          ///< unsupported or failed: nothing more to do
  std::size_t side = 0;       ///< index into the sides of its batch
  bool is_wanted = true;      ///< needs more processes
  int processes = 0;          ///< that a run before this one has done
};

/// From fewer processes no interval of the bootstrap covers 95 %, or nearly (statistics.h).
inline constexpr std::size_t least_processes = 5;

/// Light, view, size, and what moves, as a text. Rows that have them in common are timed together.
std::string timed_together(const Job& job);

/// Whether relight, resolve and, where geometry moves, update are measured well enough: the 95 % interval of each is at most
/// the share `interval` of its time wide and comes from `least_processes` at least. Times below statistics.h's least_time
/// always are.
bool is_narrow(const Record& record, double interval);

/// No row gets more processes than this, however wide its intervals are.
int most_processes(const Suite& suite);

/// The rows that are timed together, in order of first appearance.
std::vector<std::vector<PendingRow*>> timed_groups(std::vector<PendingRow>& rows);

/// A scene's rows in batches of about equally many contenders: all workers of a batch live at once and each holds the scene, so
/// a long sweep takes turns. Contenders of one batch are interleaved. A job's rows of both sides stay together.
std::vector<std::vector<PendingRow>> split(std::vector<PendingRow> rows);

/// Runs the rows of one batch: each comes back with its record complete, or failed with the reason. When the suite has an
/// interval, rows that need it get more processes, of at most `budget` seconds in all. Rows that have processes already get the
/// others. Calls `ran` after each process. Returns the seconds of the processes beyond the fixed ones.
double run_batch(SceneRun& run, const Suite& suite, std::span<const Side> sides, std::vector<PendingRow>& rows,
                 Progress& progress, double budget, const std::function<void()>& ran);

/// Distributes the time of the batch beside its rows (opening workers, loading the scene) among them by processes, so that the
/// seconds of all rows are those of the run. Returns the share of one process.
double share_overhead(std::vector<PendingRow>& batch, double seconds);

}  // namespace gnomon
