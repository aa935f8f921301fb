#pragma once
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
  difference,  ///< where the two sides differ, over the dimmed scene: darker here, lighter here
  kinds,       ///< false dark and false lit pixels of T against the reference, over the dimmed scene
  causes,      ///< the cause of each wrong pixel of T, over the dimmed scene
  classes,     ///< the class of each pixel
};

/// One row a layout or paint: id as flags and files spell it, the name that the window shows, what it shows.
struct ModeRow {
  std::string_view id, title, sentence;
};
std::span<const ModeRow> layout_rows();
std::span<const ModeRow> paint_rows();

/// What one side brings. Everything may be missing (null); what is there may be of an older frame than the other side's.
struct ComposeSide {
  std::shared_ptr<const Frame> frame;   ///< of `mask`; null where the side has no answer yet
  std::span<const float> mask;          ///< mask_width * mask_height; another size counts as missing
  int mask_width = 0, mask_height = 0;  ///< fewer than the frame's while the reference is refined
  const Verdict* verdict = nullptr;     ///< of this very answer; one of another frame counts as missing
  const LayerPicture* layer = nullptr;  ///< shown over the paint, even when it is of an older frame
};

struct Composition {
  int width = 0, height = 0;  ///< of the picture, in screen pixels; frames that are smaller are magnified, nearest pixel
  Layout layout = Layout::split;
  Paint paint = Paint::shaded;
  double divider = 0.5;           ///< of the width; pixels left of it are the left side's
  bool flicker_is_right = false;  ///< the side that flicker shows now
  float layer_opacity = 0.8f;     ///< 0 .. 1
  ComposeSide sides[2] = {};
  /// The newest reference: its classes and error kinds are shown before a verdict is there; null: only those of the verdicts.
  const ReferenceState* reference = nullptr;
};

/// Fills `rgba` (width * height, bytes R, G, B, 255 in memory order) on all threads. With layout left, paint shaded and a full
/// frame it is the picture that `shade` makes, and with paint mask that of `draw_mask`, to the byte. A side without a frame is
/// the background; a paint that needs what is not there yet (mask, classes, causes, the other side's answer for the same frame)
/// shows the dimmed scene alone. Difference mixes its color in by how much the sides differ. A layer hides the paint by its
/// opacity, but not where it shows its own background at the frame's. In layout split a light line with dark edges, four
/// pixels in all, lies over the divider.
void compose(const Composition& composition, std::span<std::uint32_t> rgba);

/// What the colors of a picture mean: for the legend in the window.
struct LegendEntry {
  Color color;
  std::string name;             ///< "false dark"
  std::optional<double> share;  ///< nothing where it means nothing or is not known yet
  std::string_view of;          ///< what it is a share of: "of tested pixels"
};
/// Those of the paint; of kinds and causes the ones that occur. Counts pixels: for every new composition, not for every picture
/// of a window at rest.
std::vector<LegendEntry> legend(const Composition& composition, int side);
/// The swatches of a debug layer.
std::vector<LegendEntry> layer_legend(const LayerPicture& layer);
/// "false dark 0.31 % of tested pixels".
std::string words(const LegendEntry& entry);

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
/// bias, texel width, element, outline error, formula. What is not known is left out. Empty outside the picture and without a
/// frame.
std::vector<PixelFact> pixel_facts(const Composition& composition, int side, int x, int y, const ReferenceState* reference,
                                   const Explanation* explanation);

}  // namespace gnomon::viewer
