#include "measure/run/run.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <charconv>
#include <regex>

#include "measure/run/context.h"
#include "measure/run/estimate.h"
#include "measure/run/resume.h"
#include "measure/run/rows.h"
#include "measure/scratch_folder.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

void make_folder(const fs::path& out) {
  std::error_code code;
  fs::create_directories(out, code);
  if (code) throw Error("output folder {} cannot be made: {}", out.string(), code.message());
}

void refuse_records(const RunOptions& options) {
  const fs::path records = records_file(options.out);
  if (!options.resume && fs::exists(records) && !fs::is_empty(records))
    throw Error("output folder {} holds records already: continue them with --resume, or name another --out",
                options.out.string());
}

/// A run that was killed may have left half a picture under a temporary name. Only the owner of the folder may clean it.
void remove_leftovers(const fs::path& out) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(out))
    if (const std::string name = entry.path().filename();
        name.starts_with(records_file(out).filename().string() + ".") && name.ends_with(".part"))
      fs::remove(entry.path(), ignored);
  for (const char* kind : {"masks", "errors", "shaded"})
    if (const fs::path folder = out / kind; fs::is_directory(folder))
      for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(".")) fs::remove(entry.path(), ignored);
}

}  // namespace

int shard_of(const Job& job, int count) {
  std::uint32_t number = 0;
  std::from_chars(job.hash.data(), job.hash.data() + 8, number, 16);
  return static_cast<int>(number % static_cast<std::uint32_t>(count));
}

std::vector<Job> select_jobs(const RunOptions& options, std::vector<Job> jobs) {
  if (!options.filter.empty()) {
    std::regex expression;
    try {
      expression.assign(options.filter);
    } catch (const std::regex_error& error) {
      throw Error("--filter {} is no regular expression: {}", options.filter, error.what());
    }
    const std::string first = jobs.front().title();
    std::erase_if(jobs, [&](const Job& job) { return !std::regex_search(job.title(), expression); });
    if (jobs.empty()) throw Error("--filter {} matches no row; the first row reads '{}'", options.filter, first);
  }
  std::erase_if(jobs, [&](const Job& job) { return shard_of(job, options.shard_count) != options.shard_index; });
  return jobs;
}

RunSummary run_suite(const RunOptions& options, SceneLibrary& library, Progress& progress) {
  const auto start = Clock::now();
  const std::vector<Job> suite = expand_jobs(options.suite, library), jobs = select_jobs(options, suite);
  make_folder(options.out);
  refuse_records(options);
  // From here on the folder is ours: nobody else reads what to do from it, or changes what it holds.
  RecordWriter writer(options.out);
  refuse_records(options);  // of a run that ended just now
  const Earlier earlier = options.resume ? earlier_rows(options, library, suite, jobs) : Earlier{};
  for (const std::string& note : earlier.notes) progress.say(note);
  if (earlier.is_changed) writer.replace(earlier.kept);
  remove_leftovers(options.out);
  RunSummary summary;

  std::vector<PendingRow> rows;
  for (const Job& job : jobs) {
    if (earlier.done.contains(job.hash))
      ++summary.done_before;
    else
      rows.push_back({job, {}, 0, false});
  }
  std::optional<ScratchFolder> scratch(ScratchFolder::at(options.out / ".scratch"));
  const Side side{options.worker, options.out};
  const auto keep = [&](const BatchDone& batch) {
    std::vector<RowCost> costs;
    for (const PendingRow& row : batch.rows) {
      writer.append(row.record);
      if (batch.was_run) costs.push_back(cost_of(row.record, options.suite.warmups, batch.opening));
      ++(row.record.status == Status::ok       ? summary.ok
         : row.record.status == Status::failed ? summary.failed
                                               : summary.unsupported);
    }
    try {
      own_history().add(costs);
    } catch (const Error& error) {  // estimates get worse, results do not
      progress.say(error.what());
    }
  };
  run_rows(std::move(rows),
           {options.suite,
            library,
            {&side, 1},
            scratch->path(),
            [&] { return std::vector{machine_context(options.worker.threads)}; },
            keep},
           progress);
  scratch.reset();  // while it is ours
  writer.close();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return summary;
}

}  // namespace gnomon
