#pragma once
#include <gnomon/scene.h>

#include <optional>
#include <string>

#include "measure/scene/posed_scene.h"

namespace gnomon::viewer {

/// The frame of an animation that is shown, and how it goes on. Times of the clock are seconds.
class Player {
 public:
  /// At rest: no animation is shown.
  Player() = default;
  /// The animation's first frame, paused. The path moves geometry.
  explicit Player(Path path) : path_(std::move(path)) {}

  bool is_at_rest() const { return !path_; }
  std::string animation() const { return path_ ? path_->name : ""; }
  int frame() const { return frame_; }
  int last_frame() const { return path_ ? path_->frame_count - 1 : 0; }
  /// Of the shown frame, with the times of all frames; nothing at rest.
  std::optional<RowPose> pose() const { return path_ ? pose_at(*path_, frame_) : std::nullopt; }

  /// To a frame of the animation, the nearest where there is none of that number. It goes on from there where it plays.
  void go_to(int frame, double now);
  /// So many frames on, or back, and pauses. Less than one is made up for by the next call.
  void step(double frames);

  bool is_playing() const { return is_playing_; }
  /// In real time from the shown frame on, or from the first where the last one is shown.
  void play(double now);
  void pause() { is_playing_ = false; }
  /// Where it plays, to the frame of this moment, whatever lies between. At the last frame it stops, or begins anew where it
  /// loops. Whether the frame is another one.
  bool advance(double now);
  /// When another frame is due; nothing while it does not play.
  std::optional<double> due() const;

  bool loops = false;

 private:
  std::optional<Path> path_;
  int frame_ = 0;
  double step_rest_ = 0;
  bool is_playing_ = false;
  int begun_frame_ = 0;  ///< shown at `begun_`
  double begun_ = 0;
};

}  // namespace gnomon::viewer
