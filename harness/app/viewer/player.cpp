// Which frame of an animation is shown.
#include "app/viewer/player.h"

#include <algorithm>
#include <cmath>

namespace gnomon::viewer {

void Player::go_to(int frame, double now) {
  frame_ = begun_frame_ = std::clamp(frame, 0, last_frame());
  begun_ = now;
}

void Player::step(double frames) {
  is_playing_ = false;
  // A key that is held makes parts of a step. A whole one is a key that was pressed.
  step_rest_ = std::abs(frames) >= 1 ? frames : step_rest_ + frames;
  const double whole = std::trunc(step_rest_);
  step_rest_ -= whole;
  frame_ = std::clamp(frame_ + static_cast<int>(std::clamp<double>(whole, -last_frame(), last_frame())), 0, last_frame());
}

void Player::play(double now) {
  if (!path_) return;
  is_playing_ = true;
  go_to(frame_ == last_frame() ? 0 : frame_, now);
}

bool Player::advance(double now) {
  if (!is_playing_) return false;
  const int before = frame_, last = last_frame();
  const double passed = std::max(0.0, std::floor((now - begun_) * path_->frame_rate));
  if (begun_frame_ + passed < last) {
    frame_ = begun_frame_ + static_cast<int>(passed);
  } else if (loops && last > 0) {
    // The last frame of what goes round is the first one again.
    const double rounds = std::fmod(begun_frame_ + passed, last);
    go_to(static_cast<int>(rounds), begun_ + passed / path_->frame_rate);
  } else {
    frame_ = last;
    is_playing_ = false;
  }
  return frame_ != before;
}

std::optional<double> Player::due() const {
  if (!is_playing_) return std::nullopt;
  return begun_ + (frame_ + 1 - begun_frame_) / path_->frame_rate;
}

}  // namespace gnomon::viewer
