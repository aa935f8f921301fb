#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>

#include "app/viewer/engine.h"
#include "measure/worker/worker_client.h"

namespace gnomon::viewer {

using Work = std::function<void()>;
using Clock = std::chrono::steady_clock;

/// What the lanes of an engine exchange. Any thread reads the constants; "the lock" is `mutex`, and guards what follows it.
struct Board {
  Board(WorkerOptions the_workers, double timeout, std::function<void()> on_change)
      : workers(std::move(the_workers)), timeout_seconds(timeout), changed(std::move(on_change)) {}

  /// Changes the state under the lock; then wakes the lanes and calls `changed`.
  template <class Change>
  void change(const Change& change) {
    {
      const std::lock_guard lock(mutex);
      change(state);
      wake_lanes();
    }
    changed();
  }
  /// Under the lock: something changed, so every lane looks for work again.
  void wake_lanes();
  /// Writes a G-buffer for the workers; the file is removed with the last owner of its name.
  std::shared_ptr<const std::filesystem::path> write_shared(const GBuffer& gbuffer);
  /// Starts a worker whose files have this name in `scratch`.
  std::unique_ptr<WorkerClient> start_worker(const std::string& name) const {
    return std::make_unique<WorkerClient>(workers, scratch.path() / name, timeout_seconds);
  }
  /// Ends a worker of a lane, if there is one: takes it under the lock, and destroys it without it, which takes a while.
  void end(std::unique_ptr<WorkerClient>& worker);

  const WorkerOptions workers;
  const double timeout_seconds;
  const std::function<void()> changed;
  const ScratchFolder scratch = ScratchFolder::in_memory("gnomon-view");
  std::atomic<std::uint64_t> gbuffer_count = 0;  ///< files written for the workers so far
  std::size_t lane_count = 0;                    ///< fixed before the first of them runs

  std::mutex mutex;
  std::condition_variable news;
  bool stop = false;
  std::set<const void*> idle;  ///< the lanes that have found no work since the last change
  Selection selection;
  EngineState state;
};

/// A thread of the engine with its own work. The public functions of a lane are for other threads, which hold the lock. All
/// else belongs to its own thread, which takes the lock to change what those functions use.
class Lane {
 public:
  /// A lane of a higher niceness must not hold up the others.
  explicit Lane(Board& board, int niceness = 0) : board_(board), niceness_(niceness) { ++board.lane_count; }
  virtual ~Lane() = default;
  /// The body of its thread, called without the lock: does its work, waits for news when there is none, and returns when the
  /// engine stops. When no lane has work, the state is finished.
  void serve();

 protected:
  /// Under the lock: the most urgent thing to do, which is then done without the lock; empty when there is nothing.
  virtual Work next() = 0;

  Board& board_;

 private:
  const int niceness_;
};

/// The name of a file that is removed with the last owner of the name.
std::shared_ptr<const std::filesystem::path> owned_file(const std::filesystem::path& file);

/// What a worker is to answer at a frame.
FrameRequest request_at(const Frame& frame);

/// Work on TBB that another thread may make give up.
class Interruptible {
 public:
  /// Work under a ticket is given up at the next call of `give_up`, also when it has not begun by then.
  std::uint64_t ticket() const {
    const std::lock_guard lock(mutex_);
    return ticket_;
  }
  /// Does the work unless it was given up. Returns whether it was done to its end; its results are void otherwise.
  bool run(std::uint64_t ticket, const Work& work);
  void give_up();

 private:
  mutable std::mutex mutex_;
  std::uint64_t ticket_ = 0;
  std::function<void()> cancel_;  ///< of the work under way; empty: there is none
};

}  // namespace gnomon::viewer
