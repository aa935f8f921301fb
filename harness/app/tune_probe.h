#pragma once
#include "analysis/tune_replay.h"
#include "app/app.h"
#include "measure/row/contender_worker.h"
#include "measure/run/run.h"

namespace gnomon::app {

/// What `gnomon tune` is to do.
struct TunePlan {
  std::vector<TuneSpace> spaces;
  TuneGoal goal;
  /// What is kept out of the choice beside scenes, which are left out in turn: lights and views by seed.
  bool holds_out_places = false;
  std::uint64_t seed = 1;
  std::optional<double> budget = {};  ///< seconds of the search
  int processes = 0;                  ///< of finalists; 0: 5, and 15 of those that are tied
  RunOptions run;                     ///< its suite has scenes, lights, views and sizes; contenders are the search's
  bool is_quiet = false;
};

/// Masks of many settings of one technique by one worker, which keeps what a setting does not spoil, and whose driver keeps
/// compiled shaders: milliseconds each, where a row takes a fresh process that compiles all of them. Their times count for
/// nothing but to tell what is too slow by far.
class TuneProbe {
 public:
  /// The plan must outlive it.
  TuneProbe(const TunePlan& plan, const TuneSpace& space, SceneLibrary& library);

  struct Answer {
    Support support = Support::full();  ///< where it is none there are no numbers
    KeptGrid::Numbers numbers = {};
    double constant_error = 0;  ///< of the best constant mask
  };
  /// Throws WorkerFailure.
  Answer ask(const std::string& settings, const Job& place);
  /// Milliseconds of what `ask` was answered for last.
  struct Times {
    double relight_ms = 0, resolve_ms = 0;
  };
  /// Of one call of each, of resolve the shorter of two: the first one with other shaders makes the driver compile.
  /// Throws WorkerFailure.
  Times times();
  /// The same after a further call of each: the shorter ones of all. Throws WorkerFailure.
  Times times_again();
  /// After a failure: the next question goes to a fresh worker.
  void forget() { on_scene_.reset(); }

 private:
  struct OnScene {
    OnScene(const Scene& scene, const SceneRun::Options& options, const std::string& technique, const std::string& settings,
            const WorkerOptions& workers)
        : run(scene, options), worker(run, technique, settings, workers) {
      worker.begin_load();
      worker.end_load();
    }
    SceneRun run;
    ContenderWorker worker;
  };

  const TunePlan& plan_;
  const TuneSpace& space_;
  SceneLibrary& library_;
  ScratchFolder scratch_;
  std::string scene_;
  std::unique_ptr<OnScene> on_scene_;
  Times times_;  ///< of the last relight, which other settings may leave as it is, and of the last resolve
};

}  // namespace gnomon::app
