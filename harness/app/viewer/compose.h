#pragma once
#include <algorithm>
#include <string_view>

#include "app/viewer/picture_parts.h"
#include "measure/picture/shading.h"  // received_light, for Frame::received

namespace gnomon::viewer {

/// How two sides share the picture.
enum class Layout { left, right, split, flicker };
/// What a side's part of the picture shows.
enum class Paint {
  shaded,      ///< the scene, shaded with the side's mask
  mask,        ///< visibility as gray
  difference,  ///< the signed difference to the reference, or to the other side
  kinds,       ///< false dark and false lit pixels of T against the reference, over the dimmed scene
  causes,      ///< the cause of each wrong pixel of T, over the dimmed scene
  classes,     ///< the class of each pixel
};

/// One row a layout or paint: id as flags and files spell it, the name that the window shows, what it shows.
struct ModeRow {
  std::string_view id, title, sentence;
};
inline constexpr ModeRow layout_rows[] = {
    {"left", "Left", "The left side alone."},
    {"right", "Right", "The right side alone."},
    {"split", "Split", "The left side left of the divider, the right side right of it."},
    {"flicker", "Flicker", "Both sides in turn, so that what differs moves."},
};
inline constexpr ModeRow paint_rows[] = {
    {"shaded", "Shaded", "The scene in the light that the side's mask lets through."},
    {"mask", "Mask", "Visibility as gray: white lit, black umbra, between them the penumbra."},
    {"difference", "Difference", "Where the side is darker or lighter than the reference, or than the other side."},
    {"kinds", "Error kinds",
     "Tested pixels that are dark or lit where the reference is not; under a light with area how much darker or lighter they "
     "are: the color is stronger from 1, 3, 10 and 30 % on."},
    {"causes", "Causes", "Why each wrong tested pixel is wrong."},
    {"classes", "Classes", "What kind of question each pixel is; only tested ones count."},
};

/// What the paint `difference` compares a side with.
enum class Against { reference, other_side };
inline constexpr ModeRow against_rows[] = {
    {"reference", "Reference", "The side minus the reference."},
    {"other_side", "Other side", "The side minus the other one."},
};
/// How it shows that.
struct DifferenceScale {
  Against against = Against::reference;
  double full = 1;        ///< where the colors end, one of difference_scales
  bool is_plain = false;  ///< the very colors of the scale, not as dark as the dimmed scene
  bool operator==(const DifferenceScale&) const = default;
};
using ChannelSpans = std::array<std::span<const float>, std::tuple_size_v<ChannelMasks>>;
inline ChannelSpans spans_of(const ChannelMasks& masks) { return {masks[0], masks[1], masks[2]}; }

/// What one side brings. Everything may be missing (null); what is there may be of an older frame than the other side's.
struct ComposeSide {
  std::shared_ptr<const Frame> frame;   ///< of `mask`; null where the side has no answer yet
  std::span<const float> mask;          ///< mask_width * mask_height; another size counts as missing
  int mask_width = 0, mask_height = 0;  ///< fewer than the frame's while the reference is refined
  const Verdict* verdict = nullptr;     ///< of this very answer; one of another frame counts as missing
  const LayerPicture* layer = nullptr;  ///< shown over the paint, even when it is of an older frame
  ChannelSpans channels = {};           ///< in color, each of the mask's size; shown instead by shaded and mask
};

struct Composition {
  int width = 0, height = 0;  ///< of the picture, in screen pixels; frames that are smaller are magnified, nearest pixel
  Layout layout = Layout::split;
  Paint paint = Paint::shaded;
  double divider = 0.5;           ///< of the width; pixels left of it are the left side's
  bool flicker_is_right = false;  ///< the side that flicker shows now
  float layer_opacity = 0.8f;     ///< 0 .. 1
  DifferenceScale difference = {};
  bool shows_contours = false;  ///< of the sides' masks and of the reference's; see contours.h
  ComposeSide sides[2] = {};
  /// The newest reference: its classes and error kinds are shown before a verdict is there; null: only those of the verdicts.
  const ReferenceState* reference = nullptr;
};

/// Fills `rgba` (width * height, bytes R, G, B, 255 in memory order) on all threads. With layout left, paint shaded and a full
/// frame it is the picture that `shade` makes, and with paint mask that of `draw_mask`, to the byte. Both are in color where
/// the side has channels; other paints are not. A side without a frame is the background; a paint that needs what is not there
/// yet (mask, classes, causes, the other side's answer for the same frame) shows the dimmed scene alone. Contours lie over the
/// paint, in pixels of the frame. A layer hides the paint by its opacity, but not where it shows its own background at the
/// frame's. In layout split a light line with dark edges, four pixels in all, lies over the divider.
void compose(const Composition& composition, std::span<std::uint32_t> rgba);

/// What the colors of a picture mean: for the legend in the window.
struct LegendEntry {
  Color color;
  std::string name;             ///< "false dark"
  std::optional<double> share;  ///< nothing where it means nothing or is not counted yet
  std::string_view of;          ///< what it is a share of: "of tested pixels"
};
/// A bar of colors with numbers below it, for paints that show a quantity.
struct LegendBar {
  struct Mark {
    double at;  ///< 0 .. 1 along the bar
    std::string words;
  };
  std::vector<Color> colors;  ///< from the left
  std::vector<Mark> marks;
};
/// Of differences from minus to plus the full scale; of masks from 0 to 1 under a light with area. Nothing for other paints.
std::optional<LegendBar> legend_bar(const Composition& composition, int side);
/// Those of the paint; of kinds and causes the ones that occur, the largest share first. Counts pixels: for every new
/// composition, not for every picture of a window at rest.
std::vector<LegendEntry> legend(const Composition& composition, int side);
/// A number of a verdict: its name, its meaning, and its text, empty where it is not defined.
struct Tally {
  const char *name, *sentence;
  std::string (*words)(const Verdict&);
};
/// Those of the numbers' panel for a frame: the error and what it is read against first.
std::span<const Tally> tallies(const Frame* frame);
/// The swatches of a debug layer.
std::vector<LegendEntry> layer_legend(const LayerPicture& layer);
/// "false dark 0.31 % of tested pixels".
std::string words(const LegendEntry& entry);

inline const char* side_name(int side) { return side == 0 ? "left" : "right"; }

/// Which side shows picture column x (from the left, in pixels): 0 or 1.
int side_at(const Composition& composition, double x);

/// The frame's pixel that picture pixel (x, y) shows on a side; nothing outside the picture and without a frame.
std::optional<std::size_t> frame_pixel(const Composition& composition, int side, int x, int y);

/// Everything that the magnifier shows of one pixel of a side: name and value, in order.
struct PixelFact {
  std::string name, value;
};
/// Pixel (x, y) of the picture. Class, cause, mask of both sides and of the reference, mesh, triangle, position, normal, cosine
/// of the light, distance to the light; and of the side's own explanation of this pixel, where one is given: covered, taps
/// (stored and measured distance along the light's ray, and whether the tap is dark: see "taps at fault" in docs/causes.md),
/// bias, texel width, element, outline error, formula. What is not computed is left out. Empty outside the picture and without
/// a frame.
std::vector<PixelFact> pixel_facts(const Composition& composition, int side, int x, int y, const ReferenceState* reference,
                                   const Explanation* explanation);

// What composing, legend and magnifier share.

/// Index of the nearest of `few` cells to cell `k` of `many` over the same length.
inline int nearest_cell(int k, int many, int few) {
  return static_cast<int>((2 * static_cast<std::int64_t>(k) + 1) * few / (2 * static_cast<std::int64_t>(many)));
}

/// Whether there is a frame and both are it.
inline bool is_same(const std::shared_ptr<const Frame>& a, const std::shared_ptr<const Frame>& b) { return a && a == b; }

/// Whether the side has a mask of its stated size.
inline bool has_mask(const ComposeSide& side) {
  return side.frame && side.mask_width > 0 && side.mask_height > 0 &&
         side.mask.size() == static_cast<std::size_t>(side.mask_width) * side.mask_height;
}

/// Whether the side has a mask with a pixel for each of its frame's.
inline bool has_full_mask(const ComposeSide& side) {
  return has_mask(side) && side.mask_width == side.frame->gbuffer.width && side.mask_height == side.frame->gbuffer.height;
}

/// Whether its mask is in color.
inline bool has_channels(const ComposeSide& side) {
  const auto is_there = [&](std::span<const float> mask) { return mask.size() == side.mask.size(); };
  return has_mask(side) && std::ranges::any_of(side.channels, is_there) &&
         std::ranges::all_of(side.channels, [&](std::span<const float> mask) { return mask.empty() || is_there(mask); });
}

/// Index in its mask of pixel (x, y) of a frame of that size. It has a mask.
inline std::size_t mask_index(const ComposeSide& side, const GBuffer& gbuffer, int x, int y) {
  const int row = nearest_cell(y, gbuffer.height, side.mask_height);
  return static_cast<std::size_t>(row) * side.mask_width + nearest_cell(x, gbuffer.width, side.mask_width);
}
/// Its visibility at that place in a channel, which is dark where no light is of it.
inline float channel_at(const ComposeSide& side, std::size_t channel, std::size_t index) {
  return side.channels[channel].empty() ? 0 : side.channels[channel][index];
}
/// Its visibility at pixel (x, y) of the frame: in color the mean of the channels.
inline float visibility_at(const ComposeSide& side, const GBuffer& gbuffer, int x, int y) {
  return side.mask[mask_index(side, gbuffer, x, y)];
}

/// The side's verdict when it is whole and of the side's frame and mask; else null.
const Verdict* verdict_of(const ComposeSide& side);

/// A reference with classes of the side's frame: that of its verdict, the newest, or that of the other side's verdict; else
/// null.
const ReferenceState* reference_of(const Composition& composition, int side);

/// The reference of the side's frame as if it were a side, the share that the side estimates where that is computed; coarse
/// while it is refined. Without a mask where there is none.
ComposeSide reference_side(const Composition& composition, int side);

/// The standard error of each of its pixels; empty under lights without area, and until it is computed.
std::span<const float> reference_error(const Composition& composition, int side);

/// What the side's mask is judged by, with the causes of the verdict where requested and sought. Nothing without a full mask or
/// a reference, or before the causes are found.
std::optional<Evidence> evidence_of(const Composition& composition, int side, bool with_causes);

}  // namespace gnomon::viewer
