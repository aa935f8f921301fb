#pragma once
#include <algorithm>
#include <cstdint>
#include <deque>
#include <utility>

namespace gnomon::viewer {

/// When the window draws its next frame. Times are seconds. The window leaves the processor to the workers at least half of the
/// time, and more of it while their answer is what is waited for.
class FramePace {
 public:
  static constexpr int settling = 3;                 ///< frames that Dear ImGui needs after an event until nothing changes
  static constexpr double least_seconds = 1 / 60.0;  ///< from one frame to the next

  /// The window draws at least so many more frames.
  void need(int count) { left_ = std::max(left_, count); }
  int left() const { return left_; }
  /// When the next frame may be drawn. `is_waiting`: something moves, and there is no new answer to show yet.
  double next(bool is_waiting) const {
    constexpr double waiting_seconds = 1 / 25.0;
    return begun_ + std::max(is_waiting ? waiting_seconds : least_seconds, 2 * cost_);
  }
  /// Around drawing one.
  void begin(double now) {
    begun_ = now;
    --left_;
  }
  void end(double now) { cost_ = now - begun_; }

 private:
  int left_ = settling;
  double begun_ = 0, cost_ = 0;
};

/// How many frames with a new answer were shown within the last second.
class FrameRate {
 public:
  /// What is shown now: the number of its frame, 0 for none.
  void note(std::uint64_t number, double now) {
    if (number > 0 && std::exchange(last_, number) != number) times_.push_back(now);
    while (!times_.empty() && times_.front() < now - 1) times_.pop_front();
  }
  std::size_t count() const { return times_.size(); }

 private:
  std::deque<double> times_;
  std::uint64_t last_ = 0;
};

}  // namespace gnomon::viewer
