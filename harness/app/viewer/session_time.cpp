// Which time of a scene that moves is shown.
#include <algorithm>

#include "app/viewer/session.h"
#include "app/viewer/window.h"
#include "measure/scene/motion.h"
#include "measure/scene/names.h"
#include "measure/scene/time_reference.h"

namespace gnomon::viewer {

/// At the animation's first frame.
Player Session::player_of(const std::string& animation) const {
  Player player(find_path(*scene(), animation, selection_.light, selection_.view));
  player.loops = player_.loops;
  return player;
}

/// Makes the selection follow the player.
void Session::take_time() {
  selection_.at = player_.pose();
  mark_moving();
}

void Session::choose_animation(const std::string& name) {
  Player chosen = name.empty() ? Player() : player_of(name);
  chosen.loops = player_.loops;
  player_ = std::move(chosen);
  take_time();
}

/// In a scene that was just loaded: the frame where it is the same scene with other settings, and still has the animation. Else
/// it is at rest.
void Session::renew_animation(bool is_same_scene) {
  const std::string name = player_.animation();
  const int frame = player_.frame();
  const auto& motion = scene()->motion;
  const bool is_there = is_same_scene && !name.empty() && motion && find_named(motion->animations, name);
  const bool loops = player_.loops;
  player_ = is_there ? player_of(name) : Player();
  player_.loops = loops;
  player_.go_to(frame, 0);
  selection_.at = player_.pose();
}

/// Whether there is something to play; else says why not. At rest the first animation begins.
bool Session::has_animation() {
  if (!scene()) return false;
  if (!scene()->motion || scene()->motion->animations.empty()) {
    const bool is_still = without_time(loaded_->reference) != loaded_->reference;
    say(is_still ? "this scene has no animation: it is a still" : "this scene has no animation", true);
    return false;
  }
  return true;
}

void Session::flip_playing() {
  if (!has_animation()) return;
  if (player_.is_playing()) return player_.pause();
  if (player_.is_at_rest()) choose_animation(scene()->motion->animations.front().name);
  player_.play(Window::now());
  take_time();
}

void Session::step_frames(double count) {
  if (!has_animation()) return;
  if (player_.is_at_rest()) return choose_animation(scene()->motion->animations.front().name);
  player_.step(count);
  take_time();
}

void Session::go_to_frame(int frame) {
  player_.go_to(frame, Window::now());
  take_time();
}

void Session::play_on() {
  if (!player_.is_playing()) return;
  player_.advance(Window::now());
  take_time();
}

std::optional<double> Session::frame_left() const {
  if (!player_.due()) return std::nullopt;
  return std::max(0.0, *player_.due() - Window::now());
}

bool Session::show_still() {
  const std::optional<RowPose> before = selection_.at;
  if (before) selection_.at = as_still(*before);
  return selection_.at != before;
}

}  // namespace gnomon::viewer
