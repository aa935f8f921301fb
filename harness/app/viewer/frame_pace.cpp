#include "app/viewer/frame_pace.h"

#include <algorithm>
#include <utility>

namespace gnomon::viewer {

void FramePace::need(int count) { left_ = std::max(left_, count); }

double FramePace::next(bool is_waiting) const {
  constexpr double waiting_seconds = 1 / 25.0;
  return begun_ + std::max(is_waiting ? waiting_seconds : least_seconds, 2 * cost_);
}

void FramePace::begin(double now) {
  begun_ = now;
  --left_;
}

void FrameRate::note(std::uint64_t number, double now) {
  if (number > 0 && std::exchange(last_, number) != number) times_.push_back(now);
  while (!times_.empty() && times_.front() < now - 1) times_.pop_front();
}

}  // namespace gnomon::viewer
