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
    for (process_ = 0; process_ < options_.suite.processes; ++process_) {
      open_seats();
      build_ms_.clear();
      for (const auto& [light, view] : places()) {
        std::vector<Row*> group;
        for (Row& row : rows_)
          if (!row.over && row.job.light == light && row.job.view == view) group.push_back(&row);
        time_group(group);
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
    progress_.advance(options_.suite.processes - process_);
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
        try {
          seats_[c] = std::make_unique<Seat>(run_, contenders_[c], options_.worker);
          seats_[c]->open_begin();
        } catch (const std::exception& failure) {
          fail_all(c, failure.what());
        }
      }
    for (std::size_t c = 0; c < contenders_.size(); ++c) {
      if (!seats_[c]) continue;
      try {
        seats_[c]->open_end();
      } catch (const std::exception& failure) {
        fail_all(c, failure.what());
      }
    }
  }

  void fail_all(std::size_t contender, const std::string& reason) {
    for (Row& row : rows_)
      if (row.contender == contender && !row.over) fail(row, reason);
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

  void time_group(const std::vector<Row*>& group) {
    for (Row* row : group) {
      progress_.step(fmt::format("{} (process {}/{})", row->job.title(), process_ + 1, options_.suite.processes));
      const auto start = Clock::now();
      try {
        prepare(*row);
      } catch (const std::exception& failure) {
        fail(*row, failure.what());
      }
      const double spent = std::chrono::duration<double>(Clock::now() - start).count();
      row->record.seconds = row->record.seconds.value_or(0) + spent;
    }
    for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) time_stage(group, stage);
    for (Row* row : group)
      if (!row->over) progress_.advance(1);
  }

  /// Goes to the row's frame; in the first process also asks for support, takes the answer and scores it.
  void prepare(Row& row) {
    Seat& seat = seat_of(row);
    const std::size_t light = run_.light_index(row.job.light), view = run_.view_index(row.job.view);
    const Support support = seat.go(light, view, options_.suite.truth);
    if (process_ == 0) {
      row.record.support = support.kind();
      row.record.reason = support.why();
    }
    if (!support) {
      row.record.status = Status::unsupported;
      row.over = true;
      progress_.advance(options_.suite.processes - process_);
      return;
    }
    row.record.times(Stage::setup).push_back({seat.setup_ms()});
    if (process_ > 0) return;
    write_pictures(row.record, run_, measure(row.record, run_, seat), options_.out);
  }

  /// Warms one stage of every row up, then times all of them interleaved.
  void time_stage(const std::vector<Row*>& group, Stage stage) {
    std::vector<TimingTask> tasks;
    std::vector<Row*> owners;
    for (Row* row : group) {
      if (row->over) continue;
      if (stage == Stage::build && build_ms_.contains(row->contender)) {
        row->record.times(Stage::build).push_back(build_ms_[row->contender]);
        continue;
      }
      const auto start = Clock::now();
      try {
        tasks.push_back(warm_up(*row, stage));
        owners.push_back(row);
      } catch (const std::exception& failure) {
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
      if (stage == Stage::build) build_ms_[owners[k]->contender] = tasks[k].samples;
      owners[k]->record.times(stage).push_back(std::move(tasks[k].samples));
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
  int process_ = 0;
  /// By contender: build as timed in this process at its first light, which it does not depend on.
  std::map<std::size_t, std::vector<double>> build_ms_;
};

/// A scene's rows in batches of about equally many contenders: all workers of a batch live at once and each holds the scene, so
/// a long sweep takes turns. Contenders of one batch are interleaved.
std::vector<std::vector<Row>> split(std::vector<Row> rows) {
  constexpr std::size_t most_contenders = 16;
  std::vector<std::string> names;
  for (const Row& row : rows)
    if (const std::string name = row.job.contender.name(); std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  std::vector<std::vector<Row>> batches((names.size() + most_contenders - 1) / most_contenders);
  for (Row& row : rows) {
    const auto place =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), row.job.contender.name()) - names.begin());
    batches[place * batches.size() / names.size()].push_back(std::move(row));
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
