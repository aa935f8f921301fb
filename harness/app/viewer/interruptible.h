#pragma once
#include <tbb/task_group.h>

#include <cstdint>
#include <mutex>

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

}  // namespace gnomon::viewer
