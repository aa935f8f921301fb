#include "measure/run.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <regex>
#include <set>

#include "measure/batch.h"
#include "measure/context.h"
#include "measure/paths.h"

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

/// The jobs that a resumed folder has records of. A scene that was not fetched then and is now is run, and its old row goes; a
/// scene that has changed since is an Error, because its old and new rows must not stand in one table.
std::set<std::string> jobs_done(const fs::path& out, SceneLibrary& library) {
  std::set<std::string> done;
  if (!fs::exists(records_file(out))) return done;
  std::string kept;
  bool dropped = false;
  for (const Record& record : read_records(out)) {
    const SceneLibrary::Entry& entry = library.get(record.scene);
    const std::string then = record.context.value("scene_hash", "");
    if (entry.scene && then.empty()) {
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

}  // namespace

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
  std::vector<Job> mine;
  for (std::size_t k = 0; k < jobs.size(); ++k)
    if (static_cast<int>(k % static_cast<std::size_t>(options.shard_count)) == options.shard_index) mine.push_back(jobs[k]);
  return mine;
}

RunSummary run_suite(const RunOptions& options, SceneLibrary& library, Progress& progress) {
  const auto start = Clock::now();
  const std::vector<Job> jobs = select_jobs(options, library);
  prepare_folder(options);
  const std::set<std::string> done = options.resume ? jobs_done(options.out, library) : std::set<std::string>{};
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
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = library.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene) run.emplace(scene, *entry.scene, options.suite, cache_root() / "frames", scratch.path);
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
      if (run) run_batch(*run, options.worker, options.out, batch, progress);
      for (const Row& row : batch) {
        writer.append(row.record);
        ++(row.record.status == Status::ok       ? summary.ok
           : row.record.status == Status::failed ? summary.failed
                                                 : summary.unsupported);
      }
    }
    library.forget(scene);
  }
  writer.close();
  summary.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return summary;
}

}  // namespace gnomon
