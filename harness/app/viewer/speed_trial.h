#pragma once
#include "app/viewer/session.h"

namespace gnomon::viewer {

/// How many pictures a second this machine shows. Four situations, one after the other, each begun when all is finished: both
/// sides do resolve again for each picture; the light moves; the camera moves; the camera moves with frames of full size. A
/// step is taken when the left side has answered the one before, while that is drawn. Only pictures with a new answer count.
class SpeedTrial {
 public:
  explicit SpeedTrial(double seconds) : seconds_(seconds) {}

  /// Before the selection is sent to the engine.
  void steer(Session& session, const EngineState& state, bool is_finished, double now);
  /// A picture of this state was presented.
  void presented(const EngineState& state, double now);
  bool is_over() const { return situation_ == std::size(titles); }
  /// What was measured, for the terminal.
  std::string table() const;

 private:
  static constexpr const char* titles[] = {"at rest, resolved again", "light moves", "camera moves",
                                           "camera moves, full frames"};
  struct Measured {
    double seconds = 0;        ///< that it was measured for
    std::vector<double> gaps;  ///< ms from one picture to the next
    int width = 0, height = 0;
    std::vector<double> relight, resolve;  ///< ms of the left side
  };
  void step(Session& session);
  static std::shared_ptr<const Frame> left_frame(const EngineState& state);
  bool is_answered(const EngineState& state) const;

  const double seconds_;
  std::size_t situation_ = 0;
  bool is_running_ = false;
  double start_ = 0, last_picture_ = 0;
  std::uint64_t step_frame_ = 0, step_answer_ = 0;  // what was newest when the last step was taken
  bool has_stepped_ = false;
  std::pair<std::uint64_t, std::uint64_t> shown_;  // frame and answer of the last picture that counted
  View view_;
  Light light_;
  int steps_ = 0;
  Measured rows_[std::size(titles)];
};

}  // namespace gnomon::viewer
