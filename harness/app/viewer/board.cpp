// How the threads of an engine run and wait for each other.
#include "app/viewer/board.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <tbb/task_group.h>
#include <unistd.h>

namespace gnomon::viewer {

namespace fs = std::filesystem;

void Board::wake_lanes() {
  ++state.number;
  state.is_finished = false;
  idle.clear();
  news.notify_all();
}

std::shared_ptr<const fs::path> Board::write_shared(const GBuffer& gbuffer) {
  const fs::path file = scratch.path() / fmt::format("{}.gbuffer", ++gbuffer_count);
  write_gbuffer(file, gbuffer);
  return owned_file(file);
}

void Board::end(std::unique_ptr<WorkerClient>& worker) {
  std::unique_ptr<WorkerClient> gone;  // outlives the lock
  const std::lock_guard lock(mutex);
  gone = std::move(worker);
}

void Lane::serve() {
  if (niceness_ > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), niceness_);
  std::unique_lock lock(board_.mutex);
  while (!board_.stop) {
    if (const Work work = next()) {
      lock.unlock();
      work();
      lock.lock();
      continue;
    }
    board_.idle.insert(this);
    if (!board_.state.is_finished && board_.idle.size() == board_.lane_count) {
      board_.state.is_finished = true;
      ++board_.state.number;
      lock.unlock();
      board_.changed();
      lock.lock();
      if (!board_.idle.contains(this) || board_.stop) continue;
    }
    board_.news.wait(lock);
  }
}

std::shared_ptr<const fs::path> owned_file(const fs::path& file) {
  return {new fs::path(file), [](const fs::path* path) {
            std::error_code ignored;
            fs::remove(*path, ignored);
            delete path;
          }};
}

FrameRequest request_at(const Frame& frame) {
  const GBuffer& g = frame.gbuffer;
  const std::span<const Light> lights = frame.all_lights();
  return {.gbuffer_file = *frame.file,
          .width = g.width,
          .height = g.height,
          .truth = g.truth,
          .seen = FreeLightAndView{{lights.begin(), lights.end()}, g.view},
          .pose = frame.pose};
}

bool Interruptible::run(std::uint64_t ticket, const Work& work) {
  tbb::task_group_context context(tbb::task_group_context::isolated);
  tbb::task_group group(context);
  {
    const std::lock_guard lock(mutex_);
    if (ticket != ticket_) return false;
    cancel_ = [&] { context.cancel_group_execution(); };
  }
  struct Done {
    Interruptible& self;
    ~Done() {
      const std::lock_guard lock(self.mutex_);
      self.cancel_ = nullptr;
    }
  } const done{*this};
  return group.run_and_wait(work) != tbb::canceled;
}

void Interruptible::give_up() {
  const std::lock_guard lock(mutex_);
  ++ticket_;
  if (cancel_) cancel_();
}

}  // namespace gnomon::viewer
