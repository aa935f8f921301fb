#include "app/viewer/compose_parts.h"

namespace gnomon::viewer {

namespace {

constexpr ModeRow layouts[] = {
    {"left", "Left", "The left side alone."},
    {"right", "Right", "The right side alone."},
    {"split", "Split", "The left side left of the divider, the right side right of it."},
    {"flicker", "Flicker", "Both sides in turn, so that what differs moves."},
};

constexpr ModeRow paints[] = {
    {"shaded", "Shaded", "The scene in the light that the side's mask lets through."},
    {"mask", "Mask", "Visibility as gray: white lit, black umbra."},
    {"difference", "Difference", "Where the side is darker or lighter than the other one."},
    {"kinds", "Error kinds", "Tested pixels that are dark or lit where the reference is not."},
    {"causes", "Causes", "Why each wrong tested pixel is wrong."},
    {"classes", "Classes", "What kind of question each pixel is; only tested ones count in the wrong rate."},
};

bool is_whole(const ReferenceState& reference) {
  if (!reference.frame) return false;
  const std::size_t size = reference.frame->gbuffer.size();
  return reference.mask.size() == size && reference.classes.size() == size;
}

}  // namespace

std::span<const ModeRow> layout_rows() { return layouts; }
std::span<const ModeRow> paint_rows() { return paints; }

const Verdict* verdict_of(const ComposeSide& side) {
  const Verdict* const v = side.verdict;
  if (!v || !v->answer || !v->reference || !has_full_mask(side)) return nullptr;
  return is_same(v->answer->frame, side.frame) && is_same(v->reference->frame, side.frame) && is_whole(*v->reference) ? v
                                                                                                                      : nullptr;
}

const ReferenceState* reference_of(const Composition& composition, int side) {
  const auto& frame = composition.sides[side].frame;
  if (const Verdict* const own = verdict_of(composition.sides[side])) return own->reference.get();
  if (composition.reference && is_same(composition.reference->frame, frame) && is_whole(*composition.reference))
    return composition.reference;
  const Verdict* const other = verdict_of(composition.sides[1 - side]);
  return other && is_same(other->reference->frame, frame) ? other->reference.get() : nullptr;
}

std::optional<Evidence> evidence_of(const Composition& composition, int side, bool with_causes) {
  const ComposeSide& s = composition.sides[side];
  const ReferenceState* const reference = reference_of(composition, side);
  if (!reference || !has_full_mask(s)) return std::nullopt;
  Evidence evidence{.width = s.mask_width,
                    .height = s.mask_height,
                    .classes = reference->classes,
                    .reference = reference->mask,
                    .mask = s.mask,
                    .causes = {}};
  if (!with_causes) return evidence;
  const Verdict* const verdict = verdict_of(s);
  if (!verdict || verdict->causes.size() != s.mask.size()) return std::nullopt;
  evidence.causes = verdict->causes;
  return evidence;
}

}  // namespace gnomon::viewer
