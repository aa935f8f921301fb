// From the engine's state to the picture, and the mouse over it. Events are taken one by one, each with the place where it
// happened, so that a gesture that begins and ends between two frames counts, too.
#include "app/viewer/picture_view.h"

#include <algorithm>

#include "app/viewer/light_size.h"

namespace gnomon::viewer {

namespace {

ComposeSide compose_side(const SideState& side, const EngineState& state) {
  const LayerPicture* const layer = side.layer.get();
  if (side.is_reference && state.reference) {
    const ReferenceState& r = *state.reference;
    return {.frame = r.frame,
            .mask = r.mask,
            .mask_width = r.width,
            .mask_height = r.height,
            .layer = layer,
            .channels = spans_of(r.channels)};
  }
  if (side.is_reference || !side.answer) return {.frame = state.frame, .mask = {}, .layer = layer};  // the scene, dimmed
  const Verdict* const verdict = side.verdict && side.verdict->answer == side.answer ? side.verdict.get() : nullptr;
  const std::shared_ptr<const Frame>& frame = side.answer->frame;
  const int width = frame->gbuffer.width, height = frame->gbuffer.height;
  return {frame, side.answer->mask, width, height, verdict, layer, spans_of(side.answer->channels)};
}

/// What the picture is made from, as far as the state has it.
std::array<const void*, 8> parts_of(const EngineState& state) {
  const auto &left = state.sides[0], &right = state.sides[1];
  const bool is_one_missing = (!left.answer && !left.is_reference) || (!right.answer && !right.is_reference);
  return {left.answer.get(),     left.verdict.get(),
          left.layer.get(),      right.answer.get(),
          right.verdict.get(),   right.layer.get(),
          state.reference.get(), is_one_missing || !state.reference ? state.frame.get() : nullptr};
}

/// What the person has chosen of a composition.
auto choices_of(const Composition& c) {
  return std::tuple(c.width, c.height, c.layout, c.paint, c.divider, c.flicker_is_right, c.layer_opacity, c.difference.against,
                    c.difference.full, c.difference.is_plain, c.shows_contours);
}

/// What a session has chosen for a picture of this size, without what is computed.
Composition chosen_by(const Session& session, int width, int height) {
  return {.width = width,
          .height = height,
          .layout = session.layout,
          .paint = session.paint,
          .divider = session.divider,
          .flicker_is_right = session.flicker_is_right,
          .layer_opacity = session.layer_opacity,
          .difference = session.difference,
          .shows_contours = session.shows_contours,
          .sides = {}};
}

}  // namespace

bool Canvas::shows_choices_of(const Session& session) const {
  return choices_of(chosen_by(session, composition_.width, composition_.height)) == choices_of(composition_);
}

bool Canvas::is_outdated(const EngineState& state) const { return !is_made_ || parts_of(state) != parts_of(state_); }

bool Canvas::compose(const Session& session, const EngineState& state, const PixelRect& place) {
  Composition next = chosen_by(session, place.width, place.height);
  if (!is_outdated(state) && choices_of(next) == choices_of(composition_)) return false;
  state_ = state;
  for (int side = 0; side < 2; ++side) next.sides[side] = compose_side(state_.sides[side], state_);
  next.reference = state_.reference.get();
  composition_ = std::move(next);
  pixels_.resize(static_cast<std::size_t>(place.width) * place.height);
  viewer::compose(composition_, pixels_);
  for (int side = 0; side < 2; ++side) legends_[side] = legend(composition_, side);
  is_made_ = true;
  return true;
}

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

std::vector<std::optional<glm::dvec2>> shown_sizes(const Session& session, const Composition& composition) {
  std::vector<std::optional<glm::dvec2>> places;
  if (!session.scene() || composition.width <= 0) return places;
  const Camera camera(shown_view(session, composition), composition.width, composition.height);
  for (const SizeHandle& handle : size_handles(camera, session.selection().light))
    places.push_back(project(camera, handle.place));
  return places;
}

GrabTargets PictureView::targets(const Composition& shown, const Session& session, double scale) const {
  GrabTargets targets{.light = {}, .divider = {}, .scale = scale, .sizes = shown_sizes(session, shown)};
  if (const auto handle = shown_handle(session, shown, scale)) targets.light = handle->shown;
  if (shown.layout == Layout::split) targets.divider = shown.divider * shown.width;
  return targets;
}

void PictureView::drag(const Composition& shown, Session& session) {
  const DragKind kind = gesture_.kind();
  if (kind == DragKind::divider) session.divider = std::clamp(gesture_.grabbed().x / shown.width, 0.0, 1.0);
  if (kind == DragKind::line) session.profile = ProfileLine{gesture_.pressed_at(), gesture_.cursor()};
  if (kind == DragKind::divider || kind == DragKind::line || !gesture_.is_drag()) return;
  if (kind == DragKind::size) {
    if (camera_) session.set_light(drag_size(*camera_, light_, gesture_.size(), gesture_.grabbed()));
  } else if (kind != DragKind::light)
    session.set_view((kind == DragKind::orbit  ? orbit
                      : kind == DragKind::look ? look
                                               : pan)(view_, gesture_.moved(), shown.height));
  else if (session.scene() && camera_)
    session.set_light(drag_light(*session.scene(), light_, *camera_, gesture_.grabbed() + beside_, gesture_.is_vertical()));
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
    const bool is_free = is_inside && gesture_.kind() == DragKind::nothing;
    if (event.kind == WindowEvent::Kind::focus_lost) gesture_.cancel();
    if (event.kind == WindowEvent::Kind::wheel && is_free) {
      session.set_view(zoom(session.selection().view, event.wheel));
      session.mark_moving();
    }
    if (event.kind == WindowEvent::Kind::motion) {
      gesture_.move(p, now);
      drag(shown, session);
    }
    if (event.kind != WindowEvent::Kind::button) continue;
    if (!event.is_pressed) {
      if (const auto clicked = gesture_.release(event.code, p, now)) session.pick(glm::ivec2(glm::floor(*clicked)));
    } else if (is_free) {
      view_ = session.selection().view;
      light_ = session.selection().light;
      camera_.emplace(shown_view(session, shown), shown.width, shown.height);
      if (const auto handle = shown_handle(session, shown, scale)) beside_ = handle->at - handle->shown;
      gesture_.press(event.code, event.modifiers, p, now, targets(shown, session, scale));
    }
  }
  handle_ = gesture_.kind();
  if (handle_ != DragKind::nothing || !mouse_) return;
  Gesture probe;
  probe.press(0, 0, *mouse_, now, targets(shown, session, scale));
  if (probe.kind() != DragKind::waiting) handle_ = probe.kind();
}

}  // namespace gnomon::viewer
