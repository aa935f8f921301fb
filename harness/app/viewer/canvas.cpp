// From what the engine knows to the picture.
#include "app/viewer/canvas.h"

#include "app/viewer/compose.h"

namespace gnomon::viewer {

namespace {

ComposeSide compose_side(const SideState& side, const EngineState& state) {
  ComposeSide result;
  result.frame = state.frame;  // without an answer it is the scene, dimmed
  if (side.layer) result.layer = side.layer.get();
  if (side.is_reference) {
    if (!state.reference) return result;
    result.frame = state.reference->frame;
    result.mask = state.reference->mask;
    result.mask_width = state.reference->width;
    result.mask_height = state.reference->height;
    return result;
  }
  if (!side.answer) return result;
  result.frame = side.answer->frame;
  result.mask = side.answer->mask;
  result.mask_width = result.frame->gbuffer.width;
  result.mask_height = result.frame->gbuffer.height;
  if (side.verdict && side.verdict->answer == side.answer) result.verdict = side.verdict.get();
  return result;
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
  return std::tuple(c.width, c.height, c.layout, c.paint, c.divider, c.flicker_is_right, c.layer_opacity);
}

}  // namespace

bool Canvas::is_outdated(const EngineState& state) const { return !is_made_ || parts_of(state) != parts_of(state_); }

bool Canvas::compose(const Session& session, const EngineState& state, const PixelRect& place) {
  Composition next{.width = place.width,
                   .height = place.height,
                   .layout = session.layout,
                   .paint = session.paint,
                   .divider = session.divider,
                   .flicker_is_right = session.flicker_is_right,
                   .layer_opacity = session.layer_opacity,
                   .sides = {}};
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

}  // namespace gnomon::viewer
