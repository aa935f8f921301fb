#include "measure/run/live.h"

#include <gnomon/error.h>

#include <array>
#include <optional>

#include "measure/run/context.h"
#include "measure/run/rows.h"
#include "measure/run/run.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

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

  std::vector<PendingRow> rows;
  for (const Job& job : jobs)
    for (std::size_t side = 0; side < sides.size(); ++side) {
      PendingRow row;
      row.job = job;
      row.side = side;
      rows.push_back(std::move(row));
    }
  const Json now = machine_context(options.worker.threads);
  const std::string mark = content_hash(fmt::format("{} {}", options.out.string(), json_text(now))).substr(0, 16);
  std::optional<ScratchFolder> scratch(ScratchFolder::at(options.out / ".scratch"));
  const auto contexts = [&] {
    std::vector<Json> by_side{context_of(build, options.worker.threads), machine_context(options.worker.threads)};
    for (Json& context : by_side) {
      // Pairs are judged as if nothing differed but the program: one load for both.
      context["load_average"] = by_side[0]["load_average"];
      context["side_by_side"] = mark;
    }
    return by_side;
  };
  const auto keep = [&](const BatchDone& batch) {
    for (const PendingRow& row : batch.rows) writers[row.side].append(row.record);
  };
  run_rows(std::move(rows), {options.suite, library, sides, scratch->path(), contexts, keep}, progress);
  scratch.reset();  // while both folders are ours
  for (RecordWriter& writer : writers) writer.close();
}

}  // namespace gnomon
