#include "measure/run/live.h"

#include <gnomon/error.h>

#include <array>
#include <chrono>
#include <optional>

#include "measure/paths.h"
#include "measure/run/batch.h"
#include "measure/run/context.h"
#include "measure/run/run.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// This machine, and what the other program says of how it was built.
Json context_of(const Json& build, int threads) {
  Json context = machine_context(threads);
  for (const char* key : {"version", "commit", "build_type", "compiler", "flags", "libraries"})
    if (build.contains(key)) context[key] = build[key];
  return context;
}

/// A folder that goes away with its owner.
struct Scratch {
  fs::path path;
  explicit Scratch(fs::path p) : path(std::move(p)) { fs::create_directories(path); }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

void refuse_records(const fs::path& folder) {
  const fs::path records = records_file(folder);
  if (fs::exists(records) && !fs::is_empty(records))
    throw Error("output folder {} holds records already: name another --out", folder.string());
}

}  // namespace

void run_live(const LiveOptions& options, SceneLibrary& library, Progress& progress) {
  std::array<Side, 2> sides{Side{options.worker, options.out / "base"}, Side{options.worker, options.out / "contender"}};
  sides[0].worker.program = options.base_program;
  const Json build = ask_program(sides[0].worker);
  RunOptions selection;
  selection.suite = options.suite;
  selection.filter = options.filter;
  const std::vector<Job> jobs = select_jobs(selection, expand_jobs(selection.suite, library));
  for (const Side& side : sides) refuse_records(side.out);
  for (const Side& side : sides) fs::create_directories(side.out);
  std::array<RecordWriter, 2> writers{RecordWriter(sides[0].out), RecordWriter(sides[1].out)};
  for (const Side& side : sides) refuse_records(side.out);  // of a run that ended just now

  std::vector<std::string> scenes;
  std::map<std::string, std::vector<Row>> rows;
  for (const Job& job : jobs) {
    if (!rows.contains(job.scene)) scenes.push_back(job.scene);
    for (std::size_t side = 0; side < sides.size(); ++side) {
      Row row;
      row.job = job;
      row.side = side;
      rows[job.scene].push_back(std::move(row));
    }
  }
  progress.expect(static_cast<double>(2 * jobs.size()) * options.suite.processes);
  const Json now = machine_context(options.worker.threads);
  const std::string mark = content_hash(fmt::format("{} {}", options.out.string(), now.dump())).substr(0, 16);
  std::optional<Scratch> scratch(options.out / ".scratch");
  double budget = options.suite.budget;
  std::size_t rows_left = 2 * jobs.size();
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = library.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene) run.emplace(scene, *entry.scene, options.suite, cache_root() / "frames", scratch->path);
    for (std::vector<Row>& batch : split(std::move(rows[scene]))) {
      const Json contexts[] = {context_of(build, options.worker.threads), machine_context(options.worker.threads)};
      for (Row& row : batch) {
        row.record = start_record(row.job, options.suite, entry.scene ? &*entry.scene : nullptr, contexts[row.side]);
        // Pairs are judged as if nothing differed but the program: one load for both.
        row.record.context["load_average"] = contexts[0]["load_average"];
        row.record.context["side_by_side"] = mark;
        if (run) {
          row.record.context["scene_hash"] = run->frames.scene_hash();
          row.record.context["frames"] = frame_version();
        } else {
          row.record.status = Status::unsupported;
          row.record.reason = entry.missing;
          progress.advance(options.suite.processes);
        }
      }
      if (run) {
        const double allowance = budget * static_cast<double>(batch.size()) / static_cast<double>(rows_left);
        const auto opened = std::chrono::steady_clock::now();
        budget -= run_batch(*run, sides, batch, progress, allowance);
        share_overhead(batch, std::chrono::duration<double>(std::chrono::steady_clock::now() - opened).count());
      }
      rows_left -= batch.size();
      for (const Row& row : batch) writers[row.side].append(row.record);
    }
    library.forget(scene);
  }
  scratch.reset();  // while both folders are ours
  for (RecordWriter& writer : writers) writer.close();
}

}  // namespace gnomon
