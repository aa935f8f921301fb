#pragma once
#include "app/viewer/board.h"

namespace gnomon::viewer {

/// Measures the left side's error against samples at the frame at rest, by a worker of its own, so that the side's has nothing
/// to take back.
class CurveLane : public Lane {
 public:
  explicit CurveLane(Board& board) : Lane(board, 5) {}
  /// Before the selection changes: drops a curve that was selected with something else than the next one has.
  void drop_curve_before(const Selection& next);
  void interrupt() {
    if (worker_) worker_->interrupt();
  }

 private:
  Work next() override;
  void measure(const std::shared_ptr<const Verdict>& verdict, const SideSelection& side, std::uint64_t ticket);

  std::unique_ptr<WorkerClient> worker_;  ///< set and taken under the lock; destroyed without it, which takes a while
  std::uint64_t begun_ = 0;               ///< the `curve` of the selection that was measured last
  std::uint64_t ticket_ = 0;              ///< raised to drop a curve
};

}  // namespace gnomon::viewer
