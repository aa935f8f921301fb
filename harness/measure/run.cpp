#include "measure/run.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <regex>
#include <set>

#include "measure/context.h"
#include "measure/paths.h"
#include "measure/row.h"
#include "measure/timing.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// One row on its way: its record, and the seat that works for it.
struct Row {
  Job job;
  Record record;
  std::size_t contender = 0;  ///< index into SceneBatch::contenders_
  bool over = false;          ///< unsupported or failed: nothing more to do
};

/// Rows of one scene. Every process of every contender serves all its lights and views, so that setup and build are paid
/// once per process; a contender that fails gets a new worker for its next row.
class SceneBatch {
 public:
  SceneBatch(SceneRun& run, const RunOptions& options, std::vector<Row>& rows, Progress& progress)
      : run_(run), options_(options), rows_(rows), progress_(progress) {
    for (Row& row : rows_) {
      const auto same = [&](const Contender& c) { return c.name() == row.job.contender.name(); };
      row.contender =
          static_cast<std::size_t>(std::find_if(contenders_.begin(), contenders_.end(), same) - contenders_.begin());
      if (row.contender == contenders_.size()) contenders_.push_back(row.job.contender);
    }
  }

  void execute() {
    for (int process = 0; process < options_.suite.processes; ++process) {
      open_seats();
      std::set<std::size_t> built;  // contenders whose setup and build are timed in this process
      for (const auto& [light, view] : places()) {
        std::vector<Row*> group;
        for (Row& row : rows_)
          if (!row.over && row.job.light == light && row.job.view == view) group.push_back(&row);
        time_group(group, process, built);
      }
      seats_.clear();
    }
  }

 private:
  /// Lights and views in order of first appearance.
  std::vector<std::pair<std::string, std::string>> places() const {
    std::vector<std::pair<std::string, std::string>> result;
    for (const Row& row : rows_) {
      const std::pair place(row.job.light, row.job.view);
      if (std::find(result.begin(), result.end(), place) == result.end()) result.push_back(place);
    }
    return result;
  }

  void fail(Row& row, const std::string& reason) {
    row.over = true;
    row.record.status = Status::failed;
    row.record.reason = reason;
    seats_[row.contender].reset();
  }

  bool needed(std::size_t contender) const {
    return std::any_of(rows_.begin(), rows_.end(), [&](const Row& row) { return row.contender == contender && !row.over; });
  }

  /// Opens all seats at once: loading is untimed and may share the cores.
  void open_seats() {
    seats_.resize(contenders_.size());
    for (std::size_t c = 0; c < contenders_.size(); ++c)
      if (needed(c)) {
        seats_[c] = std::make_unique<Seat>(run_, contenders_[c], options_.worker);
        seats_[c]->open_begin();
      }
    for (std::size_t c = 0; c < contenders_.size(); ++c) {
      if (!seats_[c]) continue;
      try {
        seats_[c]->open_end();
      } catch (const WorkerFailure& failure) {
        for (Row& row : rows_)
          if (row.contender == c && !row.over) fail(row, failure.what());
      }
    }
  }

  /// The seat of a row; a new one when the last one failed in an earlier row.
  Seat& seat_of(Row& row) {
    std::unique_ptr<Seat>& seat = seats_[row.contender];
    if (!seat) {
      seat = std::make_unique<Seat>(run_, contenders_[row.contender], options_.worker);
      seat->open_begin();
      seat->open_end();
    }
    return *seat;
  }

  void time_group(const std::vector<Row*>& group, int process, std::set<std::size_t>& built) {
    for (Row* row : group) {
      progress_.step(fmt::format("{} (process {}/{})", row->job.title(), process + 1, options_.suite.processes));
      const auto start = Clock::now();
      try {
        prepare(*row, process);
      } catch (const WorkerFailure& failure) {
        fail(*row, failure.what());
      } catch (const Error& error) {
        fail(*row, error.what());
      }
      const double spent = std::chrono::duration<double>(Clock::now() - start).count();
      row->record.seconds = row->record.seconds.value_or(0) + spent;
      if (row->over) progress_.advance(options_.suite.processes - process);
    }
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) time_stage(group, stage, built);
    for (Row* row : group)
      if (!row->over) {
        built.insert(row->contender);
        progress_.advance(1);
      }
  }

  /// Goes to the row's frame; in the first process also asks for support, takes the answer and scores it.
  void prepare(Row& row, int process) {
    Seat& seat = seat_of(row);
    const std::size_t light = run_.light_index(row.job.light), view = run_.view_index(row.job.view);
    const Support support = seat.go(light, view, options_.suite.truth);
    if (process == 0) {
      row.record.support = support.kind();
      row.record.reason = support.why();
      note_gl(row.record, seat);
    }
    if (!support) {
      row.record.status = Status::unsupported;
      row.over = true;
      return;
    }
    row.record.times(Stage::setup).push_back({seat.setup_ms()});
    if (process > 0) return;
    score(row.record, run_, seat.answer(&row.record), options_.out);
    const Truth other = options_.suite.truth == Truth::shape ? Truth::mesh : Truth::shape;
    if (run_.scene.has_curved_shapes()) {
      seat.go(light, view, other);
      row.record.metrics[other] = measure_metrics(tally(seat.answer(nullptr).evidence()));
      seat.go(light, view, options_.suite.truth);
    } else {
      row.record.metrics[other] = row.record.metrics[options_.suite.truth];
    }
    row.record.status = Status::ok;
  }

  static void note_gl(Record& record, const Seat& seat) {
    if (seat.gl().is_null()) return;
    record.context["gl_renderer"] = seat.gl()["renderer"];
    record.context["gl_version"] = seat.gl()["version"];
    const Json& reply = seat.frame_reply();
    if (reply.contains("input_bytes")) record.gl = {reply["input_bytes"], reply["upload_ms"]};
  }

  /// Warms one stage of every row up, then times all of them interleaved.
  void time_stage(const std::vector<Row*>& group, Stage stage, const std::set<std::size_t>& built) {
    std::vector<TimingTask> tasks;
    std::vector<Row*> owners;
    for (Row* row : group) {
      if (row->over) continue;
      if (stage == Stage::build && built.contains(row->contender)) {
        copy_build(*row);
        continue;
      }
      const auto start = Clock::now();
      try {
        tasks.push_back(warm_up(*row, stage));
        owners.push_back(row);
      } catch (const WorkerFailure& failure) {
        fail(*row, failure.what());
      }
      *row->record.seconds += std::chrono::duration<double>(Clock::now() - start).count();
    }
    time_interleaved(tasks);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      if (!tasks[k].failure.empty()) {
        fail(*owners[k], tasks[k].failure);
        continue;
      }
      double spent = 0;
      for (const double ms : tasks[k].samples) spent += ms / 1000 * tasks[k].iterations;
      *owners[k]->record.seconds += spent;
      owners[k]->record.times(stage).push_back(std::move(tasks[k].samples));
    }
  }

  /// The build of this process was timed at the contender's first light: it does not depend on the light.
  void copy_build(Row& row) {
    for (const Row& other : rows_)
      if (&other != &row && other.contender == row.contender && !other.record.times(Stage::build).empty()) {
        row.record.times(Stage::build).push_back(other.record.times(Stage::build).back());
        return;
      }
  }

  /// Warm-ups, fewer when they take long; they also say how often to repeat. Stages over 0.5 s are timed once per process.
  TimingTask warm_up(Row& row, Stage stage) {
    Seat& seat = *seats_[row.contender];
    double last = 0, sum = 0;
    for (int k = 0; k < options_.suite.warmups && sum < 300; ++k) sum += last = seat.time(stage);
    TimingTask task;
    task.repetitions = last > 500 ? 1 : options_.suite.repetitions;
    task.iterations = std::clamp(static_cast<int>(1 / std::max(last, 1e-3)), 1, 50);
    task.milliseconds = [&seat, stage] { return seat.time(stage); };
    return task;
  }

  SceneRun& run_;
  const RunOptions& options_;
  std::vector<Row>& rows_;
  Progress& progress_;
  std::vector<Contender> contenders_;
  std::vector<std::unique_ptr<Seat>> seats_;
};

/// A scene's rows in batches of at most so many contenders: all workers of a batch live at once and each holds the scene, so a
/// long sweep takes turns. Contenders of one batch are interleaved.
std::vector<std::vector<Row>> split(std::vector<Row> rows) {
  constexpr std::size_t contenders_at_once = 12;
  std::vector<std::string> names;
  std::vector<std::vector<Row>> batches;
  for (Row& row : rows) {
    const std::string name = row.job.contender.name();
    const auto place = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    if (place == names.size()) names.push_back(name);
    batches.resize(std::max(batches.size(), place / contenders_at_once + 1));
    batches[place / contenders_at_once].push_back(std::move(row));
  }
  return batches;
}

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
  RecordWriter writer(options.out);
  remove_leftovers(options.out);
  RunSummary summary;
  std::set<std::string> done;
  if (options.resume && fs::exists(records_file(options.out)))
    for (const Record& record : read_records(options.out)) done.insert(record.job);

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
  const Json context = machine_context(options.worker.threads);
  progress.expect(static_cast<double>(jobs.size() - summary.done_before) * options.suite.processes);
  const ScratchFolder scratch(options.out / ".scratch");
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = library.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene) run.emplace(scene, *entry.scene, options.suite, cache_root() / "frames", scratch.path);
    for (std::vector<Row>& batch : split(std::move(rows[scene]))) {
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
      if (run) SceneBatch(*run, options, batch, progress).execute();
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
