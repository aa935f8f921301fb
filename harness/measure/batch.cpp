#include "measure/batch.h"

#include <algorithm>
#include <chrono>
#include <map>

#include "measure/timing.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// Rows of one scene. Every process of every contender serves all its lights and views, so that setup and build are paid
/// once per process; a contender that fails gets a new worker for its next row.
class Batch {
 public:
  Batch(SceneRun& run, const WorkerOptions& worker, const fs::path& out, std::vector<Row>& rows, Progress& progress)
      : run_(run), worker_(worker), out_(out), rows_(rows), progress_(progress) {
    for (Row& row : rows_) {
      const auto same = [&](const Contender& c) { return c.name() == row.job.contender.name(); };
      row.contender =
          static_cast<std::size_t>(std::find_if(contenders_.begin(), contenders_.end(), same) - contenders_.begin());
      if (row.contender == contenders_.size()) contenders_.push_back(row.job.contender);
    }
  }

  void execute() {
    for (process_ = 0; process_ < run_.suite.processes; ++process_) {
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
    progress_.advance(run_.suite.processes - process_);
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
          seats_[c] = std::make_unique<Seat>(run_, contenders_[c], worker_);
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
      seat = std::make_unique<Seat>(run_, contenders_[row.contender], worker_);
      seat->open_begin();
      seat->open_end();
    }
    return *seat;
  }

  void time_group(const std::vector<Row*>& group) {
    for (Row* row : group) {
      progress_.step(fmt::format("{} (process {}/{})", row->job.title(), process_ + 1, run_.suite.processes));
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
    const Support support = seat.go(light, view, run_.suite.truth);
    if (process_ == 0) {
      row.record.support = support.kind();
      row.record.reason = support.why();
    }
    if (!support) {
      row.record.status = Status::unsupported;
      row.over = true;
      progress_.advance(run_.suite.processes - process_);
      return;
    }
    row.record.times(Stage::setup).push_back({seat.setup_ms()});
    if (process_ > 0) return;
    write_pictures(row.record, run_, measure(row.record, run_, seat), out_);
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
    for (int k = 0; k < run_.suite.warmups && sum < 300; ++k) sum += last = seat.time(stage);
    TimingTask task;
    task.repetitions = last > 500 ? 1 : run_.suite.repetitions;
    task.iterations = std::clamp(static_cast<int>(1 / std::max(last, 1e-3)), 1, 50);
    task.milliseconds = [&seat, stage] { return seat.time(stage); };
    return task;
  }

  SceneRun& run_;
  const WorkerOptions& worker_;
  const fs::path& out_;
  std::vector<Row>& rows_;
  Progress& progress_;
  std::vector<Contender> contenders_;
  std::vector<std::unique_ptr<Seat>> seats_;
  int process_ = 0;
  /// By contender: build as timed in this process at its first light, which it does not depend on.
  std::map<std::size_t, std::vector<double>> build_ms_;
};

}  // namespace

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

void run_batch(SceneRun& run, const WorkerOptions& worker, const fs::path& out, std::vector<Row>& rows, Progress& progress) {
  Batch(run, worker, out, rows, progress).execute();
}

}  // namespace gnomon
