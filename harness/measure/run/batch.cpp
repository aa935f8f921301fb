#include "measure/run/batch.h"

#include <deque>

#include "measure/notice.h"
#include "measure/row/measure_row.h"
#include "measure/run/motion_walk.h"
#include "measure/run/timing.h"

namespace gnomon {

namespace {

/// Rows of one scene. Every process of every contender serves all its lights and views, so that setup and build are paid
/// once per process; a contender that fails gets a new worker for its next row.
class Batch {
 public:
  Batch(SceneRun& run, const Suite& suite, std::span<const Side> sides, std::vector<PendingRow>& rows, Progress& progress,
        const std::function<void()>& ran)
      : run_(run), suite_(suite), sides_(sides), rows_(rows), progress_(progress), ran_(ran) {
    for (PendingRow& row : rows_) {
      if (const int done = row.over ? suite_.processes : std::min(row.processes, suite_.processes); done > 0)
        progress_.advance(done);
      const auto same = [&](const PendingRow* known) {
        return known->side == row.side && known->job.contender.name() == row.job.contender.name();
      };
      row.contender = static_cast<std::size_t>(std::ranges::find_if(contenders_, same) - contenders_.begin());
      if (row.contender == contenders_.size()) contenders_.push_back(&row);
    }
  }

  /// The processes that every row gets.
  void execute() {
    for (process_ = 0; process_ < suite_.processes; ++process_) execute_process();
    for (PendingRow& row : rows_)
      if (!row.over) row.record.stop = "fixed";
  }

  /// More processes for rows whose intervals are too wide, until none is or the budget is spent. Rows of one job on both sides
  /// get the same number, interleaved as before. Returns the seconds that they took.
  double refine(double budget) {
    const auto start = std::chrono::steady_clock::now();
    const auto spent = [&] { return seconds_since(start); };
    double last = 0;  // what the last process took: the next one must fit, too
    for (; process_ < most_processes(suite_) && spent() + last < budget && want_more(); ++process_) {
      const double before = spent();
      execute_process();
      last = spent() - before;
    }
    want_more();
    for (PendingRow& row : rows_)
      if (!row.over) row.record.stop = row.is_wanted ? "budget" : "target";
    return spent();
  }

 private:
  void execute_process() {
    if (std::ranges::none_of(rows_, [this](const PendingRow& row) { return is_due(row); })) return;
    start_workers();
    builds_.clear();
    for (std::vector<PendingRow*>& group : timed_groups(rows_)) {
      std::erase_if(group, [this](const PendingRow* row) { return !is_due(*row); });
      if (!group.empty()) time_group(group);
    }
    workers_.clear();
    ran_();
  }

  /// Marks the rows that need another process. Returns whether there are any.
  bool want_more() {
    std::set<std::string> jobs;
    for (const PendingRow& row : rows_)
      if (!row.over && !is_narrow(row.record, suite_.interval)) jobs.insert(row.job.hash);
    for (PendingRow& row : rows_) row.is_wanted = jobs.contains(row.job.hash);
    return std::ranges::any_of(rows_, [](const PendingRow& row) { return row.is_wanted && !row.over; });
  }

  /// Whether the row takes part in the process that runs now.
  bool is_due(const PendingRow& row) const { return row.is_wanted && !row.over && row.processes <= process_; }

  /// Removes the numbers of a row that is not ok, which would be taken for results, and its pictures.
  void give_up(PendingRow& row, Status status) {
    row.over = true;
    progress_.advance(std::max(0, suite_.processes - process_));
    remove_pictures(row.record, sides_[row.side].out);
    forget_results(row.record);
    row.record.status = status;
  }

  void fail(PendingRow& row, const std::string& reason) {
    give_up(row, Status::failed);
    row.record.reason = reason;
    workers_[row.contender].reset();
  }

  /// Does some work of a row, whose seconds are the row's; an exception costs this row alone. Returns whether it was done.
  template <class Work>
  bool attempt(PendingRow& row, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    bool is_done = false;
    try {
      work();
      is_done = true;
    } catch (const std::exception& failure) {
      fail(row, message_of(failure));
    }
    row.record.seconds = row.record.seconds.value_or(0) + seconds_since(start);
    return is_done;
  }

  ContenderWorker& worker_of(const PendingRow& row) const {
    if (!workers_[row.contender]) throw Error("its worker has ended in another row");
    return *workers_[row.contender];
  }

  /// Starts a worker for every contender, all at once: loading is untimed and may share the cores.
  void start_workers() {
    workers_.resize(contenders_.size());
    const auto each = [&](const auto& does) {
      for (std::size_t c = 0; c < contenders_.size(); ++c) try {
          does(c);
        } catch (const std::exception& failure) {
          for (PendingRow& row : rows_)
            if (row.contender == c && is_due(row)) fail(row, message_of(failure));
        }
    };
    each([&](std::size_t c) {
      const auto needs_it = [&](const PendingRow& row) { return row.contender == c && is_due(row); };
      if (std::ranges::any_of(rows_, needs_it)) workers_[c] = loading_worker(c);
    });
    each([&](std::size_t c) {
      if (workers_[c]) workers_[c]->end_load();
    });
  }

  std::unique_ptr<ContenderWorker> loading_worker(std::size_t contender) {
    const PendingRow& of = *contenders_[contender];
    auto worker =
        std::make_unique<ContenderWorker>(run_, of.job.contender.technique, of.job.contender.settings, sides_[of.side].worker);
    worker->begin_load();
    return worker;
  }

  void time_group(const std::vector<PendingRow*>& group) {
    for (PendingRow* row : group) {
      progress_.step(fmt::format("{} (process {}{})", row->job.title(), process_ + 1,
                                 process_ < suite_.processes ? fmt::format("/{}", suite_.processes) : ""));
      attempt(*row, [&] { prepare(*row); });
    }
    for (const Stage stage : timed_stages) time_stage(group, stage);
    time_motion(group);
    if (process_ == 0) count_times(group);
    time_floors(group);
    for (PendingRow* row : group)
      if (!row->over && process_ < suite_.processes) progress_.advance(1);
  }

  /// The times that programs count are of all frames that they drew in the first process.
  void count_times(const std::vector<PendingRow*>& group) {
    for (PendingRow* row : group) try {
        if (!row->over) workers_[row->contender]->count_times_again(row->record);
      } catch (const std::exception& failure) {
        fail(*row, message_of(failure));
      }
  }

  /// The bare passes of the frame, each once for all rows of a side that name it, and the state of the card after them.
  void time_floors(const std::vector<PendingRow*>& group) {
    std::map<std::pair<std::size_t, std::string>, Record::FloorTimes> known;
    for (PendingRow* row : group) {
      if (row->over) continue;
      const bool is_done = attempt(*row, [&] {
        ContenderWorker& worker = *workers_[row->contender];
        if (const std::string& pass = worker.floor(); !pass.empty()) {
          const auto [times, is_new] = known.try_emplace({row->side, pass});
          if (is_new) times->second = floor_times(worker.client(), suite_.repetitions);
          Record::FloorTimes& all = row->record.floor ? *row->record.floor : row->record.floor.emplace();
          all.pass = pass;
          all.ms.insert(all.ms.end(), times->second.ms.begin(), times->second.ms.end());
          all.device_ms.insert(all.device_ms.end(), times->second.device_ms.begin(), times->second.device_ms.end());
        }
        worker.note_card(row->record);
      });
      if (!is_done) known.clear();
    }
  }

  /// Goes to the row's frame; in the first process also checks support, takes the answer and scores it.
  void prepare(PendingRow& row) {
    if (std::unique_ptr<ContenderWorker>& failed = workers_[row.contender]; !failed) {  // in an earlier row
      failed = loading_worker(row.contender);
      failed->end_load();
    }
    ContenderWorker& worker = *workers_[row.contender];
    if (!row.job.times) run_.go_to_rest();
    const RowFrame frame = first_frame(row.job, run_.scene);
    const Support support = worker.go(frame, suite_.truth);
    if (process_ == 0 || !support) {
      row.record.support = support.kind();
      row.record.reason = support.why();
    }
    if (!support) return give_up(row, Status::unsupported);
    const ContenderWorker::SetupTime setup = worker.setup_time();
    row.record.times(Stage::setup).push_back({setup.ms});
    if (const auto device = setup.other_clocks.device) row.record.device_times(Stage::setup).push_back({*device});
    if (const auto harness = setup.other_clocks.harness) row.record.harness_times(Stage::setup).push_back({*harness});
    row.record.iterations["setup"] = 1;
    if (process_ > 0) return;
    std::optional<RowFrames> kept;
    if (frame.path && suite_.pictures == Suite::Pictures::all) kept.emplace(row.record, sides_[row.side].out, frame.count());
    const auto measured = measure(row.record, run_, worker, frame, kept ? &*kept : nullptr);
    if (!measured) return give_up(row, Status::unsupported);
    if (suite_.pictures != Suite::Pictures::none) write_mask(row.record, *measured, sides_[row.side].out);
    if (suite_.pictures != Suite::Pictures::all) return;
    // What was measured last, and is shown, is the last frame.
    RowFrame last = frame;
    last.number = frame.count() - 1;
    run_.go_to(last);
    write_pictures(row.record, run_.scene, *measured, sides_[row.side].out);
    run_.go_to(frame);
  }

  /// Contender, objects, and the animation with its frames, over which meshes have their reach: equal for rows whose builds are
  /// the same work.
  using Build = std::tuple<std::size_t, std::size_t, std::string>;
  Build build_of(const PendingRow& row) const {
    return {row.contender, workers_[row.contender]->object_count(), row.job.times ? row.job.path + " " + row.job.motion() : ""};
  }

  /// Warms one stage of every row up, then times all of them interleaved.
  void time_stage(const std::vector<PendingRow*>& group, Stage stage) {
    std::vector<TimingTask> tasks;
    std::vector<PendingRow*> owners;
    std::deque<OtherSamples> others;  // of each task
    for (PendingRow* row : group) {
      if (row->over) continue;
      if (const auto known = builds_.find(build_of(*row)); stage == Stage::build && known != builds_.end()) {
        add_samples(row->record, Stage::build, known->second);
        row->record.iterations["build"] = static_cast<std::uint64_t>(known->second.iterations);
        // Relight and resolve at the first frame are those after a build; the frames of a row before left updates behind.
        if (row->job.times) attempt(*row, [&] { worker_of(*row).client().time(Stage::build); });
        continue;
      }
      if (attempt(*row, [&] { tasks.push_back(warm_up(*row, stage, others.emplace_back())); })) owners.push_back(row);
      others.resize(tasks.size());
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
      tasks[k].others = std::move(others[k]);
      if (stage == Stage::build) builds_[build_of(*owners[k])] = tasks[k];
      add_samples(owners[k]->record, stage, tasks[k]);
    }
  }

  /// Times the frames of rows whose geometry moves, interleaved; afterwards they are at their first frame again.
  void time_motion(const std::vector<PendingRow*>& group) {
    if (!group.front()->job.times || std::ranges::all_of(group, &PendingRow::over)) return;
    const RowFrame first = first_frame(group.front()->job, run_.scene);
    MotionFrames frames(run_, first, suite_.truth);
    std::map<std::size_t, FrameOrder> orders;  // by contender, whose worker is at one frame for all its rows
    std::deque<MotionWalk> walks;
    std::vector<TimingTask> tasks;
    std::vector<PendingRow*> owners;
    for (PendingRow* row : group) {
      if (row->over) continue;
      FrameOrder& order = orders.try_emplace(row->contender, frames.count()).first->second;
      walks.emplace_back(order, [&frames, row, this](int number) {
        return timed_motion(worker_of(*row).client(), frames.request(number), number);
      });
      if (attempt(*row, [&] { tasks.push_back(warm_up(*row, walks.back())); }))
        owners.push_back(row);
      else
        walks.pop_back();
    }
    time_interleaved(tasks);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
      PendingRow& row = *owners[k];
      *row.record.seconds += walks[k].seconds;
      if (!tasks[k].failure.empty()) {
        fail(row, tasks[k].failure);
        continue;
      }
      tasks[k].others = std::move(walks[k].update);
      add_samples(row.record, Stage::update, tasks[k]);
      row.record.moving_times(Stage::relight).push_back(std::move(walks[k].relight));
      row.record.moving_times(Stage::resolve).push_back(std::move(walks[k].resolve));
      attempt(row, [&] { worker_of(row).go(first, suite_.truth); });
    }
  }

  /// Warm-ups, fewer when they take long; their time decides how often to repeat. `others` will get the other clocks' times.
  /// Stages over 0.5 s are timed once per process.
  TimingTask warm_up(PendingRow& row, Stage stage, OtherSamples& others) {
    WorkerClient& worker = workers_[row.contender]->client();
    const double least = warmed_up_ms(worker, stage, suite_.warmups);
    TimingTask task;
    task.repetitions = least > 500 ? 1 : suite_.repetitions;
    // The first process decides how many calls a repetition averages, so that all repetitions of the row are alike.
    std::uint64_t& iterations = row.record.iterations[std::string(name(stage))];
    if (iterations == 0) iterations = static_cast<std::uint64_t>(iterations_for(least));
    task.iterations = static_cast<int>(iterations);
    task.milliseconds = [&worker, stage, &others](int count) {
      const double ms = worker.time(stage, count);
      const OtherClocks& clocks = worker.other_clocks();
      if (clocks.device) others.device.push_back(*clocks.device / count);
      if (clocks.harness) others.harness.push_back(*clocks.harness / count);
      return ms;
    };
    return task;
  }

  /// The same of a walk over frames, whose steps are the iterations.
  TimingTask warm_up(PendingRow& row, MotionWalk& walk) {
    const double slowest = walk.warm_up(suite_.warmups);
    std::uint64_t& iterations = row.record.iterations["update"];
    if (iterations == 0) iterations = static_cast<std::uint64_t>(motion_iterations(row.job, slowest));
    return walk.task(slowest > 500 ? 1 : suite_.repetitions, static_cast<int>(iterations));
  }

  SceneRun& run_;
  const Suite& suite_;
  std::span<const Side> sides_;
  std::vector<PendingRow>& rows_;
  Progress& progress_;
  const std::function<void()>& ran_;
  std::vector<const PendingRow*> contenders_;              ///< the first row of each contender on each side
  std::vector<std::unique_ptr<ContenderWorker>> workers_;  ///< by contender; null when it failed or none is needed
  int process_ = 0;
  /// Build as timed in this process at the contender's first light, which it does not depend on.
  std::map<Build, TimingTask> builds_;
};

}  // namespace

double run_batch(SceneRun& run, const Suite& suite, std::span<const Side> sides, std::vector<PendingRow>& rows,
                 Progress& progress, double budget, const std::function<void()>& ran) {
  Batch batch(run, suite, sides, rows, progress, ran);
  batch.execute();
  return suite.interval > 0 ? batch.refine(budget) : 0;
}

}  // namespace gnomon
