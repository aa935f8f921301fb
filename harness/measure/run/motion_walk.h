#pragma once
#include "measure/row/contender_worker.h"
#include "measure/run/timing.h"

namespace gnomon {

/// The order in which a row's frames are timed: from 0 on 1, 2, .., F-1, F-2, .., 0, 1, ..: neighbors alone, so that every step
/// is one of the motion.
class FrameOrder {
 public:
  explicit FrameOrder(int frames) : frames_(frames) {}
  int next();

 private:
  int frames_, now_ = 0, step_ = 1;
};

/// What the frames of a row of which the geometry moves require of a worker, each made once: the scene is posed for it, and its
/// G-buffer is in the cache.
class MotionFrames {
 public:
  MotionFrames(SceneRun& run, RowFrame first, Truth truth) : run_(run), first_(std::move(first)), truth_(truth) {}
  const FrameRequest& request(int number);
  int count() const { return first_.count(); }

 private:
  SceneRun& run_;
  RowFrame first_;
  Truth truth_;
  std::map<int, FrameRequest> requests_;
};

/// Milliseconds of the stages of a frame in which the geometry moved, one call each.
struct MotionTime {
  double update = 0, relight = 0, resolve = 0;
  OtherClocks update_clocks = {};
  double sum() const { return update + relight + resolve; }
};
/// Goes to the frame, untimed, and does its stages. Throws Error, which names the frame, where the technique does not support
/// it.
MotionTime timed_motion(WorkerClient& worker, const FrameRequest& request, int number);

/// Frames that a sample averages where one takes `ms`: as many calls as iterations_for says, and where that is cheap, 0.2 s, up
/// to four, for one frame is one pose.
int motion_iterations(double ms);

/// One worker's walk over the frames of a row. Each sample is the mean over some frames in a row.
class MotionWalk {
 public:
  /// `time` does the stages of a frame. The walk goes on in `order`, which outlives it.
  MotionWalk(FrameOrder& order, std::function<MotionTime(int number)> time) : order_(order), time_(std::move(time)) {}

  /// So many frames without a sample, fewer where they take long. Returns the time of the fastest, milliseconds.
  double warm_up(int warmups);
  /// The task that takes the samples of one process. Its own samples are those of update.
  TimingTask task(int repetitions, int iterations);

  std::vector<double> relight, resolve;  ///< milliseconds, one for each sample of the task
  OtherSamples update;                   ///< of update by other clocks
  double seconds = 0;                    ///< that the task took, also untimed

 private:
  double add_sample(int frames);

  FrameOrder& order_;
  std::function<MotionTime(int)> time_;
};

}  // namespace gnomon
