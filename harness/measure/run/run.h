#pragma once
#include <filesystem>

#include "measure/record/record.h"
#include "measure/run/jobs.h"
#include "measure/run/progress.h"
#include "measure/run/worker.h"

namespace gnomon {

struct RunOptions {
  Suite suite;
  std::filesystem::path out;
  std::string filter;  ///< regular expression over "SCENE LIGHT [PATH] TECHNIQUE:SETTINGS"; empty: all
  bool resume = false;
  bool retry_failed = false;             ///< with resume: rows that failed are run again
  int shard_index = 0, shard_count = 1;  ///< runs the jobs of which shard_of(job, shard_count) is shard_index
  WorkerOptions worker;
};

struct RunSummary {
  std::size_t ok = 0, unsupported = 0, failed = 0;
  std::size_t done_before = 0;  ///< found in the folder by --resume
  double seconds = 0;
};

/// The shard of a job among `count`: by its hash, so that machines which have fetched other scenes deal the same jobs alike.
int shard_of(const Job& job, int count);

/// Those of `jobs` (all of the suite) that the options select, in order. Throws Error on a bad expression.
std::vector<Job> select_jobs(const RunOptions& options, std::vector<Job> jobs);

/// Runs them: one record per job in OUT/records.jsonl, masks, error pictures and shaded pictures beside it. A worker that
/// fails costs its own row. What the rows took is remembered for estimates (estimate.h). The folder belongs to one run at a
/// time. Throws Error on an output folder that another run writes, or that holds records without `resume` or such that cannot
/// be continued (resume.h), and on a full disk.
RunSummary run_suite(const RunOptions& options, SceneLibrary& library, Progress& progress);

}  // namespace gnomon
