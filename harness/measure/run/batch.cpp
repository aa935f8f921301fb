#include "measure/run/batch.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <set>

#include "measure/run/enough.h"
#include "measure/run/timing.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// Rows of one scene. Every process of every contender serves all its lights and views, so that setup and build are paid
/// once per process; a contender that fails gets a new worker for its next row.
class Batch {
 public:
  Batch(SceneRun& run, std::span<const Side> sides, std::vector<Row>& rows, Progress& progress)
      : run_(run), sides_(sides), rows_(rows), progress_(progress) {
    for (Row& row : rows_) {
      const auto same = [&](const Entrant& e) { return e.side == row.side && e.contender.name() == row.job.contender.name(); };
      row.contender = static_cast<std::size_t>(std::find_if(entrants_.begin(), entrants_.end(), same) - entrants_.begin());
      if (row.contender == entrants_.size()) entrants_.push_back({row.job.contender, row.side});
    }
  }

  /// The processes that every row gets.
  void execute() {
    for (process_ = 0; process_ < run_.suite.processes; ++process_) execute_process();
    for (Row& row : rows_)
      if (!row.over) row.record.stop = "fixed";
  }

  /// More processes for rows whose intervals are too wide, until none is or the budget is spent. Rows of one job on both sides
  /// get the same number, interleaved as before. Answers the seconds that they took.
  double refine(double budget) {
    const auto start = Clock::now();
    const auto spent = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    double last = 0;  // what the last process took: the next one must fit, too
    for (; process_ < most_processes(run_.suite) && spent() + last < budget && want_more(); ++process_) {
      const double before = spent();
      execute_process();
      last = spent() - before;
    }
    want_more();
    for (Row& row : rows_)
      if (!row.over) row.record.stop = row.is_wanted ? "budget" : "target";
    return spent();
  }

 private:
  /// A contender on one side.
  struct Entrant {
    Contender contender;
    std::size_t side = 0;
  };

  void execute_process() {
    open_seats();
    build_ms_.clear();
    for (const std::string& place : places()) {
      std::vector<Row*> group;
      for (Row& row : rows_)
        if (row.is_wanted && !row.over && place_of(row) == place) group.push_back(&row);
      time_group(group);
    }
    seats_.clear();
  }

  /// Marks the rows that need another process; whether there are any.
  bool want_more() {
    std::set<std::string> jobs;
    for (const Row& row : rows_)
      if (!row.over && !is_narrow(row.record, run_.suite.interval)) jobs.insert(row.job.hash);
    for (Row& row : rows_) row.is_wanted = jobs.contains(row.job.hash);
    return std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.is_wanted && !row.over; });
  }

  /// Rows of one place are timed together.
  static std::string place_of(const Row& row) {
    return fmt::format("{} {} {}x{} {}", row.job.light, row.job.view, row.job.width, row.job.height, row.job.path);
  }

  /// In order of first appearance.
  std::vector<std::string> places() const {
    std::vector<std::string> result;
    for (const Row& row : rows_)
      if (std::string place = place_of(row); std::find(result.begin(), result.end(), place) == result.end())
        result.push_back(std::move(place));
    return result;
  }

  /// Numbers of a row that is not ok would be taken for results: they go, and so do its pictures.
  void give_up(Row& row, Status status) {
    row.over = true;
    progress_.advance(std::max(0, run_.suite.processes - process_));
    remove_pictures(row.record, sides_[row.side].out);
    forget_results(row.record);
    row.record.status = status;
  }

  void fail(Row& row, const std::string& reason) {
    give_up(row, Status::failed);
    row.record.reason = reason;
    seats_[row.contender].reset();
  }

  bool needed(std::size_t contender) const {
    return std::any_of(rows_.begin(), rows_.end(),
                       [&](const Row& row) { return row.contender == contender && row.is_wanted && !row.over; });
  }

  /// Opens all seats at once: loading is untimed and may share the cores.
  void open_seats() {
    seats_.resize(entrants_.size());
    for (std::size_t c = 0; c < entrants_.size(); ++c)
      if (needed(c)) {
        try {
          seats_[c] = fresh_seat(c);
          seats_[c]->open_begin();
        } catch (const std::exception& failure) {
          fail_all(c, failure.what());
        }
      }
    for (std::size_t c = 0; c < entrants_.size(); ++c) {
      if (!seats_[c]) continue;
      try {
        seats_[c]->open_end();
      } catch (const std::exception& failure) {
        fail_all(c, failure.what());
      }
    }
  }

  std::unique_ptr<Seat> fresh_seat(std::size_t contender) {
    const Entrant& entrant = entrants_[contender];
    return std::make_unique<Seat>(run_, entrant.contender, sides_[entrant.side].worker);
  }

  void fail_all(std::size_t contender, const std::string& reason) {
    for (Row& row : rows_)
      if (row.contender == contender && row.is_wanted && !row.over) fail(row, reason);
  }

  /// The seat of a row; a new one when the last one failed in an earlier row.
  Seat& seat_of(Row& row) {
    std::unique_ptr<Seat>& seat = seats_[row.contender];
    if (!seat) {
      seat = fresh_seat(row.contender);
      seat->open_begin();
      seat->open_end();
    }
    return *seat;
  }

  void time_group(const std::vector<Row*>& group) {
    for (Row* row : group) {
      progress_.step(fmt::format("{} (process {}{})", row->job.title(), process_ + 1,
                                 process_ < run_.suite.processes ? fmt::format("/{}", run_.suite.processes) : ""));
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
      if (!row->over && process_ < run_.suite.processes) progress_.advance(1);
  }

  /// Goes to the row's frame; in the first process also asks for support, takes the answer and scores it.
  void prepare(Row& row) {
    Seat& seat = seat_of(row);
    const Standpoint place = run_.place(row.job);
    const Support support = seat.go(place, run_.suite.truth);
    if (process_ == 0 || !support) {
      row.record.support = support.kind();
      row.record.reason = support.why();
    }
    if (!support) return give_up(row, Status::unsupported);
    row.record.times(Stage::setup).push_back({seat.setup_ms()});
    row.record.iterations["setup"] = 1;
    if (process_ > 0) return;
    if (const auto measured = measure(row.record, run_, seat, place))
      write_pictures(row.record, run_, *measured, sides_[row.side].out);
    else
      give_up(row, Status::unsupported);
  }

  /// Warms one stage of every row up, then times all of them interleaved.
  void time_stage(const std::vector<Row*>& group, Stage stage) {
    std::vector<TimingTask> tasks;
    std::vector<Row*> owners;
    for (Row* row : group) {
      if (row->over) continue;
      if (stage == Stage::build && build_ms_.contains(row->contender)) {
        row->record.times(Stage::build).push_back(build_ms_[row->contender].samples);
        row->record.iterations["build"] = static_cast<std::uint64_t>(build_ms_[row->contender].iterations);
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
      if (stage == Stage::build) build_ms_[owners[k]->contender] = {tasks[k].samples, tasks[k].iterations};
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
    // The first process says how many calls a repetition averages, so that all repetitions of the row are alike.
    std::uint64_t& iterations = row.record.iterations[std::string(name(stage))];
    if (iterations == 0) iterations = static_cast<std::uint64_t>(std::clamp(1 / std::max(last, 1e-3), 1.0, 50.0));
    task.iterations = static_cast<int>(iterations);
    task.milliseconds = [&seat, stage] { return seat.time(stage); };
    return task;
  }

  SceneRun& run_;
  std::span<const Side> sides_;
  std::vector<Row>& rows_;
  Progress& progress_;
  std::vector<Entrant> entrants_;
  std::vector<std::unique_ptr<Seat>> seats_;
  int process_ = 0;
  /// By contender: build as timed in this process at its first light, which it does not depend on.
  struct BuildTimes {
    std::vector<double> samples;
    int iterations = 1;
  };
  std::map<std::size_t, BuildTimes> build_ms_;
};

}  // namespace

std::vector<std::vector<Row>> split(std::vector<Row> rows) {
  std::size_t sides = 1;
  std::vector<std::string> names;
  for (const Row& row : rows) {
    sides = std::max(sides, row.side + 1);
    if (const std::string name = row.job.contender.name(); std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  const std::size_t most_contenders = 16 / sides;
  std::vector<std::vector<Row>> batches((names.size() + most_contenders - 1) / most_contenders);
  for (Row& row : rows) {
    const auto place =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), row.job.contender.name()) - names.begin());
    batches[place * batches.size() / names.size()].push_back(std::move(row));
  }
  return batches;
}

double run_batch(SceneRun& run, std::span<const Side> sides, std::vector<Row>& rows, Progress& progress, double budget) {
  Batch batch(run, sides, rows, progress);
  batch.execute();
  return run.suite.interval > 0 ? batch.refine(budget) : 0;
}

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

}  // namespace gnomon
