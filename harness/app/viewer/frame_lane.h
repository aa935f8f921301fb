#pragma once
#include "app/viewer/reference_lane.h"
#include "app/viewer/side_lane.h"

namespace gnomon::viewer {

/// How many times smaller than the picture frames are in each direction while something moves: as little as keeps them in time,
/// and no more than helps.
class PreviewDivisor {
 public:
  explicit PreviewDivisor(int first) : value_(first) {}
  int value() const { return value_; }
  /// A frame of that size took so long, with its answers.
  void took(double ms);
  /// Drops the times of earlier frames, because something else moves.
  void forget() { ms_ = {}; }
  /// A frame of full size would take so long. The first frames are small enough for that, unless frames have been timed.
  void expect(double full_ms);

 private:
  static constexpr int largest = 8;
  int next() const;
  int value_;
  std::array<double, largest + 1> ms_{};  ///< a mean by divisor; 0 is unknown
};

/// Makes frames of what is selected; smaller ones while something moves, so that they keep up.
class FrameLane : public Lane {
 public:
  FrameLane(Board& board, std::array<SideLane, 2>& sides, ReferenceLane& reference)
      : Lane(board), sides_(sides), reference_(reference) {}

 private:
  Work next() override;
  double full_ms() const;
  void make_frame(const Selection& selection, std::uint64_t number);
  void make_picture(const Selection& selection, const Frame* before, int divisor, Frame& frame);
  void wait_for_sides(std::uint64_t frame);

  std::array<SideLane, 2>& sides_;      ///< called under the lock
  ReferenceLane& reference_;            ///< called under the lock
  std::uint64_t failed_selection_ = 0;  ///< the last one that no frame could be made for
  std::uint64_t frame_count_ = 0;
  PosedCopies copies_;
  PreviewDivisor camera_divisor_{2}, light_divisor_{1};  ///< while these move
};

}  // namespace gnomon::viewer
