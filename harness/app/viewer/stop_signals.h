#pragma once
#include <atomic>
#include <functional>
#include <thread>

namespace gnomon::viewer {

/// While it lives, SIGTERM, SIGINT and SIGHUP ask the program to end instead of ending it, so that workers and scratch files go
/// with it. The second of a kind ends it. Those that were ignored stay ignored. One at a time.
class StopSignals {
 public:
  /// `asked` is called from a thread of its own, after `is_asked` has become true.
  explicit StopSignals(std::function<void()> asked);
  ~StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  bool is_asked() const { return is_asked_; }

 private:
  std::atomic<bool> is_asked_ = false;
  std::thread thread_;
};

}  // namespace gnomon::viewer
