#pragma once
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "app/viewer/engine.h"
#include "measure/scratch_folder.h"
#include "measure/worker/worker_client.h"

namespace gnomon::viewer {

/// Work on TBB that another thread may make give up.
class Interruptible {
 public:
  /// What is done under a ticket is given up at the next call of `give_up`, also when it has not begun by then.
  std::uint64_t ticket() const {
    const std::lock_guard lock(mutex_);
    return ticket_;
  }
  /// Does the work unless it was given up; answers whether it was done to its end. What it left is worth nothing otherwise.
  bool run(std::uint64_t ticket, const std::function<void()>& work);
  void give_up();

 private:
  mutable std::mutex mutex_;
  std::uint64_t ticket_ = 0;
  std::function<void()> cancel_;  ///< what is being done; empty: nothing is
};

/// How many times smaller than the picture frames are while something moves, in each direction: as little as keeps them in
/// time, and no more than helps.
class PreviewDivisor {
 public:
  explicit PreviewDivisor(int first) : value_(first) {}
  int value() const { return value_; }
  /// A frame of that size took so long, with its answers.
  void took(double ms);
  /// What frames took says nothing any more: something else moves.
  void forget();
  /// A frame of full size would take so long: the first ones are as small as that asks for, unless it is known better.
  void expect(double full_ms);

 private:
  static constexpr int largest = 8;
  int next() const;
  int value_;
  std::array<double, largest + 1> ms_{};  ///< a mean by divisor; 0 is unknown
};

/// The threads of an engine, each with work of its own.
enum Lane { loading, framing, refining, measuring, left_side, right_side, lane_count };

/// All that the threads of an engine share. Each asks under the lock for its next piece of work, does it without the lock, and
/// waits for news when there is none; when none of them has work, all is finished.
struct Engine::Body {
  using Clock = std::chrono::steady_clock;
  using Work = std::function<void()>;

  Body(WorkerOptions the_workers, double timeout, std::function<void()> on_change);
  ~Body();

  /// Changes the state under the lock; then wakes the other threads and calls `changed`.
  template <class Change>
  void change(const Change& change) {
    {
      const std::lock_guard lock(mutex);
      change(state);
      wake_threads();
    }
    changed();
  }
  /// Under the lock: something changed, so every thread looks for work again.
  void wake_threads();
  void serve(Lane lane);
  Work next(Lane lane);

  // Each looks, under the lock, for work of its thread.
  Work next_scene();
  Work next_frame();
  Work next_reference();
  Work next_curve();

  void drop_curve_before(const Selection& next);
  void measure_curve(const std::shared_ptr<const Verdict>& verdict, const SideSelection& side, std::uint64_t ticket);
  double full_ms() const;
  void make_frame(const Selection& selection, std::uint64_t number);
  void wait_for_sides(std::uint64_t frame);
  std::shared_ptr<const ReferenceState> known_reference(const Frame& frame, const Light& light);
  void remember(const Frame& frame, const Light& light, std::shared_ptr<const ReferenceState> reference);
  std::vector<float> trace_light(const Frame& frame, const GBuffer& pixels, int step, const Light& light);
  void find_classes(const Frame& frame, const Light& light, ReferenceState& reference);
  void find_nearest(const Frame& frame, const Light& light, std::shared_ptr<Frame>& mesh_frame, ReferenceState& reference);
  void trace_reference(const std::shared_ptr<const Frame>& frame, bool is_moving, std::uint64_t ticket);
  void complete_reference(ReferenceState reference, std::uint64_t ticket);
  std::shared_ptr<const ReferenceState> publish(ReferenceState reference);
  /// Writes a G-buffer for the workers; the file is removed with the last owner of its name.
  std::shared_ptr<const std::filesystem::path> write_shared(const GBuffer& gbuffer);

  const WorkerOptions workers;
  const double timeout_seconds;
  const std::function<void()> changed;
  const ScratchFolder scratch = ScratchFolder::in_memory("gnomon-view");

  mutable std::mutex mutex;
  std::condition_variable news;
  bool stop = false;
  bool is_idle[lane_count] = {};
  Selection selection;
  EngineState state;

  std::shared_ptr<LoadedScene> offered;          ///< before the first selection; the loading thread's then
  std::string tried_scene;                       ///< the scene that was loaded last, or could not be
  std::atomic<std::uint64_t> gbuffer_count = 0;  ///< files written for the workers so far

  // Of the thread that makes frames.
  std::uint64_t failed_selection = 0;  ///< the last one that no frame could be made for; guarded by the lock
  std::uint64_t frame_count = 0;
  PreviewDivisor camera_divisor{2}, light_divisor{1};  ///< while these move

  // Of the thread that refines.
  struct KnownReference {
    std::shared_ptr<const LoadedScene> loaded;
    std::vector<std::byte> light_and_view;
    Truth truth;
    std::shared_ptr<const ReferenceState> reference;  ///< under one light, without its frame
  };
  std::deque<KnownReference> known_references;  ///< the newest first
  struct TracedMask {
    Light light;
    std::vector<float> mask;
  };
  std::shared_ptr<const void> traced_pixels;  ///< of the G-buffer that the next ones are of
  /// Under several lights, each: what stays where it is need not be traced again. By name, and every how many-th pixel.
  std::map<std::pair<std::string, int>, TracedMask> traced_masks;
  std::uint64_t refined = 0;  ///< the last frame that there is nothing left to do for
  double rays_per_ms = 0;
  Interruptible refinement;
  tbb::task_arena half_the_cores{std::max(1, tbb::this_task_arena::max_concurrency() / 2)};

  // Of the thread that measures curves; guarded by the lock.
  std::unique_ptr<WorkerClient> curve_worker;
  std::uint64_t begun_curve = 0, curve_ticket = 0;

  class Side;
  std::unique_ptr<Side> sides[2];
  std::vector<std::thread> threads;
};

}  // namespace gnomon::viewer
