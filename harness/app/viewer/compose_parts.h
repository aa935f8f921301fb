#pragma once
#include "app/viewer/compose.h"

namespace gnomon::viewer {

// What composing, legend and magnifier share.

/// Index of the nearest of `few` cells to cell `k` of `many` over the same length.
inline int nearest_cell(int k, int many, int few) {
  return static_cast<int>((2 * static_cast<std::int64_t>(k) + 1) * few / (2 * static_cast<std::int64_t>(many)));
}

/// Whether there is a frame and both are it.
inline bool is_same(const std::shared_ptr<const Frame>& a, const std::shared_ptr<const Frame>& b) { return a && a == b; }

/// Whether the side has a mask of the size that it says.
inline bool has_mask(const ComposeSide& side) {
  return side.frame && side.mask_width > 0 && side.mask_height > 0 &&
         side.mask.size() == static_cast<std::size_t>(side.mask_width) * side.mask_height;
}

/// Whether the side has a mask with a pixel for each of its frame's.
inline bool has_full_mask(const ComposeSide& side) {
  return has_mask(side) && side.mask_width == side.frame->gbuffer.width && side.mask_height == side.frame->gbuffer.height;
}

/// Its visibility at pixel (x, y) of a frame of that size. It has a mask.
inline float visibility_at(const ComposeSide& side, const GBuffer& gbuffer, int x, int y) {
  const int row = nearest_cell(y, gbuffer.height, side.mask_height);
  return side.mask[static_cast<std::size_t>(row) * side.mask_width + nearest_cell(x, gbuffer.width, side.mask_width)];
}

/// The side's verdict when it is whole and of the side's frame and mask; else null.
const Verdict* verdict_of(const ComposeSide& side);

/// A reference with classes of the side's frame: that of its verdict, the newest, or that of the other side's verdict; else
/// null.
const ReferenceState* reference_of(const Composition& composition, int side);

/// What the side's mask is judged by, with the causes of the verdict when asked for and known. Nothing without a full mask or
/// a reference.
std::optional<Evidence> evidence_of(const Composition& composition, int side, bool with_causes);

}  // namespace gnomon::viewer
