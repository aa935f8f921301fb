// The mouse over the picture. Events are taken one by one, each with the place where it happened, so that a gesture that begins
// and ends between two frames counts, too.
#include "app/viewer/picture_view.h"

#include <gnomon/kit/camera.h>

#include <algorithm>
#include <cmath>

#include "app/viewer/style.h"

namespace gnomon::viewer {

const Frame* shown_frame(const Composition& composition) {
  const Frame* newest = nullptr;
  for (const ComposeSide& side : composition.sides)
    if (side.frame && (!newest || side.frame->number > newest->number)) newest = side.frame.get();
  return newest;
}

View shown_view(const Session& session, const Composition& composition) {
  const Frame* const newest = shown_frame(composition);
  return newest ? newest->gbuffer.view : session.selection().view;
}

std::optional<Handle> shown_handle(const Session& session, const Composition& composition, double scale) {
  if (!session.scene() || composition.width <= 0) return std::nullopt;
  const Camera camera(shown_view(session, composition), composition.width, composition.height);
  return light_handle(camera, light_place(*session.scene(), session.selection().light), handle_margin * scale);
}

GrabTargets PictureView::targets(const Composition& shown, const Session& session, double scale) const {
  GrabTargets targets{.light = {}, .divider = {}, .scale = scale};
  if (const auto handle = shown_handle(session, shown, scale)) targets.light = handle->shown;
  if (shown.layout == Layout::split) targets.divider = shown.divider * shown.width;
  return targets;
}

void PictureView::drag(const Composition& shown, Session& session) {
  const glm::dvec2 moved = gesture_.moved();
  switch (gesture_.kind()) {
    case DragKind::nothing:
    case DragKind::waiting:
      return;
    case DragKind::divider:
      session.divider = std::clamp(gesture_.grabbed().x / shown.width, 0.0, 1.0);
      return;
    case DragKind::orbit:
      session.set_view(orbit(view_, moved, shown.height));
      break;
    case DragKind::look:
      session.set_view(look(view_, moved, shown.height));
      break;
    case DragKind::pan:
      session.set_view(pan(view_, moved, shown.height));
      break;
    case DragKind::light:
      if (session.scene() && camera_)
        session.set_light(drag_light(*session.scene(), light_, *camera_, gesture_.grabbed() + beside_, gesture_.is_vertical()));
      break;
  }
  session.mark_moving();
}

void PictureView::use(std::span<const WindowEvent> events, const PixelRect& place, const Composition& shown, bool is_covered,
                      double scale, Session& session) {
  const double now = Window::now();
  // The window may have become smaller under a mouse that rests.
  if (mouse_ && (mouse_->x >= place.width || mouse_->y >= place.height)) mouse_.reset();
  for (const WindowEvent& event : events) {
    const glm::dvec2 p = event.place - glm::dvec2(place.x, place.y);
    const bool is_inside = place.holds(event.place) && !is_covered;
    mouse_ = is_inside ? std::optional(p) : std::nullopt;
    switch (event.kind) {
      case WindowEvent::Kind::key:
        break;
      case WindowEvent::Kind::focus_lost:
        gesture_.cancel();
        break;
      case WindowEvent::Kind::wheel:
        if (!is_inside || gesture_.kind() != DragKind::nothing) break;
        session.set_view(zoom(session.selection().view, event.wheel));
        session.mark_moving();
        break;
      case WindowEvent::Kind::motion:
        gesture_.move(p, now);
        drag(shown, session);
        break;
      case WindowEvent::Kind::button:
        if (!event.is_pressed) {
          if (const auto clicked = gesture_.release(event.code, p, now)) session.pick(glm::ivec2(glm::floor(*clicked)));
        } else if (is_inside && gesture_.kind() == DragKind::nothing) {
          view_ = session.selection().view;
          light_ = session.selection().light;
          camera_.emplace(shown_view(session, shown), shown.width, shown.height);
          if (const auto handle = shown_handle(session, shown, scale)) beside_ = handle->at - handle->shown;
          gesture_.press(event.code, event.modifiers, p, now, targets(shown, session, scale));
        }
        break;
    }
  }
  handle_ = gesture_.kind();
  if (handle_ != DragKind::nothing || !mouse_) return;
  Gesture probe;
  probe.press(0, 0, *mouse_, now, targets(shown, session, scale));
  if (probe.kind() != DragKind::waiting) handle_ = probe.kind();
}

}  // namespace gnomon::viewer
