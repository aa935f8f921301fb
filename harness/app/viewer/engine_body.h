#pragma once
#include <tbb/task_group.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "app/viewer/engine.h"

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
  template <class Work>
  bool run(std::uint64_t ticket, const Work& work) {
    tbb::task_group_context context(tbb::task_group_context::isolated);
    tbb::task_group group(context);
    {
      const std::lock_guard lock(mutex_);
      if (ticket != ticket_) return false;
      running_ = &context;
    }
    struct Done {
      Interruptible& self;
      ~Done() {
        const std::lock_guard lock(self.mutex_);
        self.running_ = nullptr;
      }
    } const done{*this};
    return group.run_and_wait(work) != tbb::canceled;
  }
  void give_up() {
    const std::lock_guard lock(mutex_);
    ++ticket_;
    if (running_) running_->cancel_group_execution();
  }

 private:
  mutable std::mutex mutex_;
  std::uint64_t ticket_ = 0;
  tbb::task_group_context* running_ = nullptr;
};

/// A folder in memory where there is one, for what goes to the workers and comes from them; removed at the end. Folders of
/// viewers that were killed are removed at the start.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  const std::filesystem::path path;
};

/// How many times smaller than the picture frames are while something moves, in each direction: as little as keeps them in
/// time, and no more than helps.
class Divisor {
 public:
  explicit Divisor(int first) : value_(first) {}
  int value() const { return value_; }
  /// A frame of that size took so long, with its answers.
  void took(double ms);
  /// What frames took says nothing any more: something else moves.
  void forget();

 private:
  static constexpr int largest = 4;
  int next() const;
  int value_;
  std::array<double, largest + 1> ms_{};  ///< a mean by divisor; 0 is unknown
};

/// What a light and a view are made of, to tell them apart and for workers.
std::vector<std::byte> stand_bytes(const Light& light, const View& view);

/// The threads of an engine.
enum Lane { loading, framing, refining, left_side, right_side, lane_count };

/// All that the threads of an engine share. Each asks under the lock for its next piece of work, does it without the lock, and
/// waits for news when there is none; when none of them has work, all is finished.
struct Engine::Body {
  using Clock = std::chrono::steady_clock;
  using Work = std::function<void()>;

  Body(WorkerOptions the_workers, double timeout, std::function<void()> on_change);
  ~Body();

  /// Changes the state under the lock and tells everybody.
  template <class Change>
  void change(const Change& change) {
    {
      const std::lock_guard lock(mutex);
      change(state);
      stir();
    }
    changed();
  }
  /// Under the lock: something changed, so everybody looks for work.
  void stir();
  void serve(Lane lane);
  Work next(Lane lane);

  // Each looks, under the lock, for work of its thread.
  Work next_scene();
  Work next_frame();
  Work next_reference();

  void make_frame(const Wish& wish, std::uint64_t number);
  void wait_for_sides(std::uint64_t frame);
  void trace_reference(const std::shared_ptr<const Frame>& frame, std::uint64_t ticket);
  void complete_reference(ReferenceState reference, std::uint64_t ticket);
  std::shared_ptr<const ReferenceState> publish(ReferenceState reference);
  /// Writes a G-buffer for the workers; the file goes with the last owner of its name.
  std::shared_ptr<const std::filesystem::path> share(const GBuffer& gbuffer);

  const WorkerOptions workers;
  const double timeout_seconds;
  const std::function<void()> changed;
  const ScratchFolder scratch;

  mutable std::mutex mutex;
  std::condition_variable news;
  bool stop = false;
  bool is_idle[lane_count] = {};
  Wish wish;
  EngineState state;

  std::shared_ptr<LoadedScene> offered;   ///< before the first wish; the loading thread's then
  std::string tried_scene;                ///< the last one that loading was about
  std::atomic<std::uint64_t> shared = 0;  ///< files that were shared so far

  // Of the thread that makes frames.
  std::vector<std::byte> stand;   ///< of the newest frame; guarded by the lock
  std::uint64_t failed_wish = 0;  ///< the last one that no frame could be made for; guarded by the lock
  std::uint64_t frame_count = 0;
  Divisor camera_divisor{2}, light_divisor{1};  ///< while these move

  // Of the thread that refines.
  struct Kept {
    std::shared_ptr<const LoadedScene> loaded;
    std::vector<std::byte> stand;
    Truth truth;
    std::shared_ptr<const ReferenceState> reference;  ///< without its frame
  };
  std::deque<Kept> kept;      ///< the newest first
  std::uint64_t refined = 0;  ///< the last frame that there is nothing left to do for
  double rays_per_ms = 0;
  Interruptible refinement;

  class Side;
  std::unique_ptr<Side> sides[2];
  std::vector<std::thread> threads;
};

/// One side's worker and how far it is. Everything is of the side's own thread, but for `interrupt` and what the lock guards.
class Engine::Body::Side {
 public:
  Side(Body& body, int index) : body_(body), index_(index) {}

  /// Under the lock: the most urgent thing to do, empty when there is nothing.
  Work next();
  /// Under the lock: the wish changes; a worker that nobody waits for any more is given up.
  void outdated_by(const Wish& wish);
  /// Under the lock: causes of an older frame are given up.
  void new_frame() { causes_.give_up(); }
  /// Under the lock: whether it has answered, or will not answer, about the frame.
  bool is_through(std::uint64_t frame) const;
  void interrupt();

 private:
  struct Seated {
    std::shared_ptr<const LoadedScene> loaded;
    std::string technique;
    int attempt = 0;
    friend bool operator==(const Seated&, const Seated&) = default;
  };
  Seated seat_of(const Wish& wish) const;
  Json ask(const std::string& words, const Json& request, double least_timeout = 0);
  void start(const Seated& seated, const std::string& settings);
  void set(const std::string& settings);
  void go(const std::shared_ptr<const Frame>& frame);
  void answer(const std::shared_ptr<const Frame>& frame, std::uint64_t repeat);
  void count(const std::shared_ptr<const SideAnswer>& answer);
  void draw_layer(const std::shared_ptr<const SideAnswer>& answer, const std::string& name);
  void explain_picked(const std::shared_ptr<const SideAnswer>& answer, std::optional<std::uint32_t> pixel);
  void judge(const std::shared_ptr<const SideAnswer>& answer, const std::shared_ptr<const ReferenceState>& reference);
  void find_reasons(const std::shared_ptr<const Verdict>& verdict, const std::shared_ptr<const ReferenceState>& truth);

  Json stand_at(const Frame& frame, const std::string& words);
  std::vector<float> resolve_mask(const Frame& frame, bool is_timed);
  std::vector<std::optional<Explanation>> explain(std::span<const std::uint32_t> pixels);
  Work guarded(std::function<void()> work);
  void fail(const std::string& why);
  std::filesystem::path file(const char* name) const;
  SideState& state() { return body_.state.sides[index_]; }

  Body& body_;
  const int index_;
  std::unique_ptr<Worker> worker_;  ///< put here and taken away under the lock; ended without it, which takes a while
  std::optional<Seated> seated_;    ///< what the worker has; kept when it failed
  std::string settings_;
  bool has_failed_ = false;
  bool is_given_up_ = false;  ///< something else was wished since it was seated, perhaps only for a moment
  int fresh_ = 0;             ///< stages up to date
  std::uint64_t frame_ = 0;   ///< the worker stands at it
  bool is_supported_ = false;
  Support support_ = Support::full();
  std::array<std::optional<double>, 4> stage_ms_;
  std::uint64_t repeat_ = 0;
  std::optional<Clock::time_point> since_;
  Interruptible causes_;
  friend class Engine;
};

}  // namespace gnomon::viewer
