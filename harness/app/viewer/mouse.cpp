#include "app/viewer/mouse.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>

namespace gnomon::viewer {

namespace {

/// The handle of the light's size that lies nearest, within reach and nearer than the light's own handle; nothing else.
std::optional<std::size_t> size_at(glm::dvec2 cursor, const GrabTargets& targets) {
  double nearest = Gesture::size_distance * targets.scale;
  if (targets.light) nearest = std::min(nearest, glm::distance(*targets.light, cursor));
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < targets.sizes.size(); ++k) {
    if (!targets.sizes[k] || glm::distance(*targets.sizes[k], cursor) >= nearest) continue;
    nearest = glm::distance(*targets.sizes[k], cursor);
    found = k;
  }
  return found;
}

}  // namespace

void Gesture::press(int button, int modifiers, glm::dvec2 cursor, double now, const GrabTargets& targets) {
  if (kind_ != DragKind::nothing) return move(cursor, now);
  const bool is_left = button == GLFW_MOUSE_BUTTON_LEFT, is_shift = modifiers & GLFW_MOD_SHIFT,
             is_line = is_left && modifiers & GLFW_MOD_CONTROL;
  button_ = button;
  pressed_ = now;
  scale_ = targets.scale;
  pressed_at_ = cursor_ = cursor;
  grab_offset_ = glm::dvec2(0);
  may_click_ = is_vertical_ = false;
  if (is_line) {
    kind_ = DragKind::waiting;
    drag_kind_ = DragKind::line;
  } else if (const auto size = size_at(cursor, targets); is_left && size) {
    kind_ = DragKind::size;
    size_ = *size;
    grab_offset_ = *targets.sizes[*size] - cursor;
  } else if (is_left && targets.light && glm::distance(*targets.light, cursor) <= light_distance * scale_) {
    kind_ = DragKind::light;
    is_vertical_ = is_shift;
    grab_offset_ = *targets.light - cursor;
  } else if (is_left && !is_shift && targets.divider && std::abs(*targets.divider - cursor.x) <= divider_distance * scale_) {
    kind_ = DragKind::divider;
    grab_offset_ = {*targets.divider - cursor.x, 0};
  } else if (is_left || button == GLFW_MOUSE_BUTTON_MIDDLE || button == GLFW_MOUSE_BUTTON_RIGHT) {
    kind_ = DragKind::waiting;
    may_click_ = is_left && !is_shift;
    drag_kind_ = button == GLFW_MOUSE_BUTTON_RIGHT ? DragKind::look : may_click_ ? DragKind::orbit : DragKind::pan;
  }
}

void Gesture::move(glm::dvec2 cursor, double now) {
  if (kind_ == DragKind::nothing) return;
  cursor_ = cursor;
  const bool is_still = glm::distance(cursor, pressed_at_) <= click_distance * scale_ && now - pressed_ <= click_seconds;
  if (kind_ == DragKind::waiting && !is_still) kind_ = drag_kind_;
}

std::optional<glm::dvec2> Gesture::release(int button, glm::dvec2 cursor, double now) {
  move(cursor, now);
  if (kind_ == DragKind::nothing || button != button_) return std::nullopt;
  const bool is_click = kind_ == DragKind::waiting && may_click_;
  kind_ = DragKind::nothing;
  return is_click ? std::optional(pressed_at_) : std::nullopt;
}

}  // namespace gnomon::viewer
