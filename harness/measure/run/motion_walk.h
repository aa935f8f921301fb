#pragma once
#include "measure/run/jobs.h"
#include "measure/run/timing.h"

namespace gnomon {

/// Where a walk over the frames of a row is. It goes by single steps, 1, 2, .., F-1, F-2, .., 0, 1, ..: each is one of the
/// motion.
class FrameOrder {
 public:
  explicit FrameOrder(int frames) : frames_(frames) {}
  int now() const { return now_; }
  int next();
  /// The next step is forward from this frame, which is not the last.
  void jump_to(int frame) {
    now_ = frame;
    step_ = 1;
  }
  /// From frame to frame, one less than there are frames.
  int step_count() const { return frames_ - 1; }

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

/// Steps that a sample averages in a row of so many where one takes `ms`: as many as iterations_for says, and where that is
/// cheap, 0.2 s, up to four, for one step is one pose. At most all, or all of them forth and back, some times.
int motion_iterations(double ms, int step_count);
/// The same of a job. Of a technique that remembers frames all steps, for they cost what they do in their order.
int motion_iterations(const Job& job, double ms);

/// One worker's walk over the frames of a row. Each sample is the mean over steps that are spread evenly over the row; between
/// steps that do not follow one another it jumps, which takes its time and counts for nothing.
class MotionWalk {
 public:
  /// `time` does the stages of a frame. The walk goes on in `order`, which outlives it.
  MotionWalk(FrameOrder& order, std::function<MotionTime(int number)> time) : order_(order), time_(std::move(time)) {}

  /// So many steps without a sample, spread like those of one, fewer where they take long. Returns the time of the slowest,
  /// milliseconds, without the first one where there are more: it also finds memory and caches cold.
  double warm_up(int warmups);
  /// The task that takes the samples of one process. Its own samples are those of update.
  TimingTask task(int repetitions, int iterations);

  std::vector<double> relight, resolve;  ///< milliseconds, one for each sample of the task
  OtherSamples update;                   ///< of update by other clocks
  double seconds = 0;                    ///< that the task took, also untimed

 private:
  double add_sample(int steps);
  /// Step `k` of so many, by `shift`, 0 .. 1, of their distance behind the first.
  MotionTime step(int k, int steps, double shift);

  FrameOrder& order_;
  std::function<MotionTime(int)> time_;
  int repetitions_ = 1;
};

}  // namespace gnomon
