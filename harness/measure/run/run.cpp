#include "measure/run/run.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <charconv>
#include <regex>
#include <set>

#include "measure/paths.h"
#include "measure/run/batch.h"
#include "measure/run/context.h"
#include "measure/run/estimate.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// A folder that goes away with its owner.
struct ScratchFolder {
  fs::path path;
  explicit ScratchFolder(fs::path p) : path(std::move(p)) { fs::create_directories(path); }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

void prepare_folder(const RunOptions& options) {
  std::error_code code;
  fs::create_directories(options.out, code);
  if (code) throw Error("output folder {} cannot be made: {}", options.out.string(), code.message());
  const fs::path records = records_file(options.out);
  if (!options.resume && fs::exists(records) && !fs::is_empty(records))
    throw Error("output folder {} holds records already: continue them with --resume, or name another --out",
                options.out.string());
}

/// The jobs that a resumed folder has records of. A scene that was not fetched then and is now is run, and its old row goes; so
/// does a failed row of `jobs` that is to be tried again. A scene that has changed since is an Error, because its old and new
/// rows must not stand in one table.
std::set<std::string> jobs_done(const fs::path& out, SceneLibrary& library, const std::vector<Job>& jobs, bool retry_failed) {
  std::set<std::string> wanted;
  for (const Job& job : jobs) wanted.insert(job.hash);
  std::set<std::string> done;
  if (!fs::exists(records_file(out))) return done;
  std::string kept;
  bool dropped = false;
  for (const Record& record : read_records(out)) {
    const SceneLibrary::Entry& entry = library.get(record.scene);
    const std::string then = record.context.value("scene_hash", "");
    const bool is_retried = retry_failed && record.status == Status::failed && wanted.contains(record.job);
    if ((entry.scene && then.empty()) || is_retried) {
      dropped = true;
      continue;
    }
    if (entry.scene && then != content_hash(scene_bytes(*entry.scene)))
      throw Error("scene {} has changed since {} was run: run it into another --out", record.scene, out.string());
    done.insert(record.job);
    kept += record_line(record);
  }
  if (dropped) write_file(records_file(out), kept);
  return done;
}

/// A run that was killed may have left half a picture under a temporary name. Only the owner of the folder may clean it.
void remove_leftovers(const fs::path& out) {
  std::error_code ignored;
  for (const char* kind : {"masks", "errors", "shaded"})
    if (const fs::path folder = out / kind; fs::is_directory(folder))
      for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.path().filename().string().starts_with(".")) fs::remove(entry.path(), ignored);
}

/// What the batch took beside its rows (opening workers, loading the scene) belongs to them: shared out by processes, so that
/// the seconds of all rows are those of the run. Answers the share of one process.
double share_overhead(std::vector<Row>& batch, double seconds) {
  double processes = 0;
  const auto count = [](const Row& row) {
    return std::max<double>(1, static_cast<double>(row.record.times(Stage::resolve).size()));
  };
  for (const Row& row : batch) {
    seconds -= row.record.seconds.value_or(0);
    processes += count(row);
  }
  const double share = std::max(0.0, seconds) / processes;
  for (Row& row : batch) row.record.seconds = row.record.seconds.value_or(0) + share * count(row);
  return share;
}

}  // namespace

int shard_of(const Job& job, int count) {
  std::uint32_t number = 0;
  std::from_chars(job.hash.data(), job.hash.data() + 8, number, 16);
  return static_cast<int>(number % static_cast<std::uint32_t>(count));
}

std::vector<Job> select_jobs(const RunOptions& options, SceneLibrary& library) {
  std::vector<Job> jobs = expand_jobs(options.suite, library);
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
  const std::vector<Job> jobs = select_jobs(options, library);
  prepare_folder(options);
  const std::set<std::string> done =
      options.resume ? jobs_done(options.out, library, jobs, options.retry_failed) : std::set<std::string>{};
  RecordWriter writer(options.out);
  remove_leftovers(options.out);
  RunSummary summary;

  std::vector<std::string> scenes;
  std::map<std::string, std::vector<Row>> rows;
  for (const Job& job : jobs) {
    if (done.contains(job.hash)) {
      ++summary.done_before;
      continue;
    }
    if (!rows.contains(job.scene)) scenes.push_back(job.scene);
    rows[job.scene].push_back({job, {}, 0, false});
  }
  progress.expect(static_cast<double>(jobs.size() - summary.done_before) * options.suite.processes);
  const ScratchFolder scratch(options.out / ".scratch");
  const Side side{options.worker, options.out};
  double budget = options.suite.budget;  // for processes beyond the fixed ones; every batch may spend its share of what is left
  std::size_t rows_left = jobs.size() - summary.done_before;
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = library.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene) run.emplace(scene, *entry.scene, options.suite, cache_root() / "frames", scratch.path);
    std::vector<RowCost> costs;
    for (std::vector<Row>& batch : split(std::move(rows[scene]))) {
      const Json context = machine_context(options.worker.threads);
      for (Row& row : batch) {
        row.record = start_record(row.job, options.suite, entry.scene ? &*entry.scene : nullptr, context);
        if (run) {
          row.record.context["scene_hash"] = run->frames.scene_hash();
        } else {
          row.record.status = Status::unsupported;
          row.record.reason = entry.missing;
          progress.advance(options.suite.processes);
        }
      }
      double opening = 0;
      if (run) {
        const auto opened = Clock::now();
        const double allowance = budget * static_cast<double>(batch.size()) / static_cast<double>(rows_left);
        budget -= run_batch(*run, {&side, 1}, batch, progress, allowance);
        opening = share_overhead(batch, std::chrono::duration<double>(Clock::now() - opened).count());
      }
      rows_left -= batch.size();
      for (const Row& row : batch) {
        writer.append(row.record);
        if (run) costs.push_back(cost_of(row.record, options.suite.warmups, opening));
        ++(row.record.status == Status::ok       ? summary.ok
           : row.record.status == Status::failed ? summary.failed
                                                 : summary.unsupported);
      }
    }
    try {
      own_history().add(costs);
    } catch (const Error& error) {  // estimates get worse, results do not
      progress.say(error.what());
    }
    library.forget(scene);
  }
  writer.close();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return summary;
}

}  // namespace gnomon
