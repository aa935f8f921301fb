#include "measure/run/run.h"

#include <charconv>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/pattern.h"
#include "measure/record/scene_place.h"
#include "measure/run/batch.h"
#include "measure/run/estimate.h"
#include "measure/run/run_file.h"
#include "measure/run/unfinished.h"
#include "measure/scene/blob.h"
#include "measure/worker/machine_context.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

void refuse_records(const fs::path& out, std::string_view advice) {
  const fs::path records = records_file(out);
  if (fs::exists(records) && !fs::is_empty(records))
    throw Error("output folder {} holds records already: {}", out.string(), advice);
}

/// Whether a picture has the temporary name that some process gave it, .PROCESS.part.png: other files with a dot are not ours.
bool is_unfinished(const std::string& name) {
  const std::size_t end = name.find_first_not_of("0123456789", 1);
  return name.starts_with(".") && end != name.npos && end > 1 && name.substr(end).starts_with(".part");
}

/// A run that was killed may have left half a picture under a temporary name. Only the owner of the folder may clean it.
void remove_unfinished_pictures(const fs::path& out) {
  std::error_code ignored;
  for (const char* kind : {"masks", "errors", "shaded"})
    if (const fs::path folder = out / kind; fs::is_directory(folder))
      for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (is_unfinished(entry.path().filename().string())) fs::remove(entry.path(), ignored);
  remove_left_over_parts(out / "frames");
}

/// How rows are run, and what is done with them.
struct RowsPlan {
  const Suite& suite;
  SceneLibrary& scenes;
  std::span<const Side> sides;
  const fs::path& out;  ///< files on their way from workers lie in its folder `.scratch`
  /// The contexts of the records of a batch, by side; called when the batch starts.
  std::function<std::vector<Json>()> contexts;
  /// Takes a batch whose rows are complete, and the seconds beside the rows by process; none where its scene is not fetched.
  std::function<void(const std::vector<PendingRow>& batch, std::optional<double> opening)> done;
  std::function<bool()> is_over = {};    ///< called before each batch: whether the rest is not run; empty: all are
  UnfinishedRows* unfinished = nullptr;  ///< where rows wait for the rest of their processes; none where nothing is resumed
};

/// Keeps the rows of a batch as they are after a process. Where they cannot be written, a stop costs more, and no result.
void keep_unfinished(const RowsPlan& plan, std::span<const PendingRow> batch, Progress& progress) {
  if (!plan.unfinished) return;
  try {
    plan.unfinished->write(batch);
  } catch (const Error& error) {
    progress.say(error.what());
  }
}

/// Runs rows that have their job and side, scene by scene in the order of first appearance, in batches. Processes beyond the
/// suite's fixed ones share its budget: every batch may spend its part of what is left. Scenes are forgotten when done.
void run_rows(std::vector<PendingRow> rows, const RowsPlan& plan, Progress& progress) {
  const ScratchFolder scratch = ScratchFolder::at(plan.out / ".scratch");
  std::size_t rows_left = rows.size();
  double budget = plan.suite.budget;
  progress.expect(static_cast<double>(rows_left) * plan.suite.processes);
  std::vector<std::string> scenes;
  std::map<std::string, std::vector<PendingRow>> by_scene;
  for (PendingRow& row : rows) {
    const std::string scene = row.job.scene;
    if (!by_scene.contains(scene)) scenes.push_back(scene);
    by_scene[scene].push_back(std::move(row));
  }
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = plan.scenes.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene)
      run.emplace(*entry.scene, SceneRun::Options{.cache = cache_root() / "frames",
                                                  .scratch = scratch.path(),
                                                  .target = plan.suite.target,
                                                  .timeout = plan.suite.timeout,
                                                  .watch = shown_on(progress, scene),
                                                  .truth_over = plan.suite.truth_over});
    auto hash_of = [&, with_motion = std::map<std::vector<std::string>, std::string>()](const Job& job) mutable {
      if (!job.times) return run->frames.scene_hash(job.lights);
      std::string& hash = with_motion[job.lights];
      return hash.empty() ? hash = scene_hash(*entry.scene, job.lights, WithMotion::yes) : hash;
    };
    for (std::vector<PendingRow>& batch : split(std::move(by_scene[scene]))) {
      if (plan.is_over && plan.is_over()) return;
      const std::vector<Json> contexts = plan.contexts();
      if (run) run->go_to_rest();  // from where the last row has left it
      for (PendingRow& row : batch) {
        row.record = start_record(row.job, plan.suite, run ? &*entry.scene : nullptr, contexts[row.side]);
        if (run) {
          row.record.context["scene_hash"] = hash_of(row.job);
          row.record.context["frames"] = frame_version();
          if (const auto path = path_to_scene(plan.sides[row.side].out, plan.scenes.place_of(scene)))
            row.record.context["scene_file"] = *path;
          if (plan.unfinished) plan.unfinished->go_on(row);
        } else {
          row.record.status = Status::unsupported;
          row.record.reason = entry.missing;
          progress.advance(plan.suite.processes);
        }
      }
      std::optional<double> opening;
      if (run) {
        const auto opened = std::chrono::steady_clock::now();
        double seconds = 0;  // of the rows in an earlier run
        for (const PendingRow& row : batch) seconds += row.record.seconds.value_or(0);
        const double allowance = budget * static_cast<double>(batch.size()) / static_cast<double>(rows_left);
        const auto ran = [&] { keep_unfinished(plan, batch, progress); };
        budget -= run_batch(*run, plan.suite, plan.sides, batch, progress, allowance, ran);
        opening = share_overhead(batch, seconds + seconds_since(opened));
      }
      rows_left -= batch.size();
      plan.done(batch, opening);
    }
    plan.scenes.forget(scene);
  }
  keep_unfinished(plan, {}, progress);
}

}  // namespace

std::vector<Job> select_jobs(const RunOptions& options, std::vector<Job> jobs) {
  if (!options.filter.empty() && !jobs.empty()) {
    const Pattern pattern(options.filter, "is no regular expression");
    const std::string first = jobs.front().title();
    std::erase_if(jobs, [&](const Job& job) { return !pattern.is_in(job.title()); });
    if (jobs.empty()) throw Error("--filter {} matches no row; the first row reads '{}'", options.filter, first);
  }
  // By the hash, so that machines which have fetched other scenes deal the same jobs alike.
  std::erase_if(jobs, [&](const Job& job) {
    std::uint32_t number = 0;
    std::from_chars(job.hash.data(), job.hash.data() + 8, number, 16);
    return number % static_cast<std::uint32_t>(options.shard_count) != static_cast<std::uint32_t>(options.shard_index);
  });
  return jobs;
}

namespace {

/// The folder, made where it is not there and refused where its records are not continued.
const fs::path& claimed(const RunOptions& options) {
  make_folder(options.out, "output folder");
  if (!options.resume) refuse_records(options.out, "continue them with --resume, or name another --out");
  return options.out;
}

}  // namespace

OpenRun::OpenRun(const RunOptions& options, SceneLibrary& library, std::span<const Job> suite, std::span<const Job> jobs,
                 Progress& progress)
    : options_(options), library_(library), writer_(claimed(options)) {
  claimed(options);  // from here on no other run changes its rows; one may have ended just now
  if (options.resume) earlier_ = earlier_rows(options, library, suite, jobs);
  for (const std::string& note : earlier_.notes) progress.say(note);
  add_to_run_file(options, machine_context(options.worker.threads), library, jobs);
  if (earlier_.is_changed) writer_.replace(earlier_.kept);
  for (const Record& record : earlier_.dropped) remove_pictures(record, options.out);
  remove_unfinished_pictures(options.out);
  std::set<std::string> waiting;  // jobs of the suite that may go on where a run was killed
  if (options.resume)
    for (const Job& job : suite)
      if (!earlier_.done.contains(job.hash)) waiting.insert(job.hash);
  unfinished_.emplace(options.out, options.suite, waiting, options.retry_failed);
}

void OpenRun::add_rows(std::span<const Job> jobs, const Round& round) {
  std::vector<PendingRow> rows;
  for (const Job& job : jobs) rows.push_back({.job = job, .record = {}});
  const Side side{options_.worker, options_.out};
  const auto contexts = [&] { return std::vector{machine_context(options_.worker.threads)}; };
  const auto keep = [&](const std::vector<PendingRow>& batch, std::optional<double> opening) {
    std::vector<RowCost> costs;
    for (const PendingRow& row : batch) {
      writer_.append(row.record);
      if (opening) costs.push_back(cost_of(row.record, round.suite.warmups, *opening));
      if (round.seen) round.seen(row.record);
    }
    try {
      own_history().add(costs);
    } catch (const Error& error) {  // estimates get worse, results do not
      round.progress.say(error.what());
    }
  };
  run_rows(std::move(rows),
           {.suite = round.suite,
            .scenes = library_,
            .sides = {&side, 1},
            .out = options_.out,
            .contexts = contexts,
            .done = keep,
            .is_over = round.is_over,
            .unfinished = &*unfinished_},
           round.progress);
}

RunSummary run_suite(const RunOptions& options, SceneLibrary& library, Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const SuiteJobs suite = expand_jobs(options.suite, library, options.worker);
  std::vector<Job> jobs = select_jobs(options, suite.jobs);
  OpenRun run(options, library, suite.jobs, jobs, progress);
  RunSummary summary;
  summary.left_out = suite.left_out;
  summary.done_before = std::erase_if(jobs, [&](const Job& job) { return run.earlier().done.contains(job.hash); });
  const auto count = [&](const Record& record) {
    ++(record.status == Status::ok ? summary.ok : record.status == Status::failed ? summary.failed : summary.unsupported);
  };
  run.add_rows(jobs, {options.suite, progress, count});
  run.close();
  summary.seconds = seconds_since(start);
  return summary;
}

void run_live(const RunOptions& options, const std::string& base_program, SceneLibrary& library, Progress& progress) {
  std::array<Side, 2> sides{Side{options.worker, options.out / "base"}, Side{options.worker, options.out / "contender"}};
  sides[0].worker.program = base_program;
  const Json base = context_of_program(sides[0].worker);
  const std::vector<Job> jobs = select_jobs(options, expand_jobs(options.suite, library, options.worker).jobs);
  const auto refuse = [&] {
    for (const Side& side : sides) refuse_records(side.out, "name another --out");
  };
  refuse();
  for (const Side& side : sides) make_folder(side.out, "output folder");
  std::array<RecordWriter, 2> writers{RecordWriter(sides[0].out), RecordWriter(sides[1].out)};
  refuse();  // of a run that ended just now
  for (const Side& side : sides) {
    RunOptions of_side = options;
    of_side.out = side.out;
    add_to_run_file(of_side, &side == &sides[0] ? base : machine_context(options.worker.threads), library, jobs);
  }
  std::vector<PendingRow> rows;
  for (const Job& job : jobs)
    for (const std::size_t side : {0, 1}) rows.push_back({.job = job, .record = {}, .side = side});
  const int threads = options.worker.threads;
  const std::string now = json_text(machine_context(threads));
  const std::string mark = content_hash(fmt::format("{} {}", options.out.string(), now)).substr(0, 16);
  const auto contexts = [&] {
    std::vector<Json> by_side{machine_context(threads), machine_context(threads)};
    for (const char* key : {"version", "commit", "build", "build_type", "compiler", "flags", "libraries", "technique_sources"})
      if (base.contains(key)) by_side[0][key] = base[key];
    for (Json& context : by_side) {
      // Pairs are judged as if nothing differed but the program: one load for both.
      context["load_average"] = by_side[0]["load_average"];
      context["side_by_side"] = mark;
    }
    return by_side;
  };
  const auto keep = [&](const std::vector<PendingRow>& batch, std::optional<double>) {
    for (const PendingRow& row : batch) writers[row.side].append(row.record);
  };
  run_rows(std::move(rows), {options.suite, library, sides, options.out, contexts, keep}, progress);
  for (RecordWriter& writer : writers) writer.close();
}

}  // namespace gnomon
