#pragma once
#include "app/viewer/compose.h"
#include "app/viewer/noisy_mask.h"
#include "measure/picture/signed_color.h"

namespace gnomon::viewer {

/// The contours of one mask over its frame's pixels, drawn as lines of a width in a casing: a pixel is covered by how near the
/// contour passes. That distance follows from its visibility and the differences to its neighbors. Contours are of one surface:
/// pixels of the background, pixels that face away from the light's center, and neighbors of another mesh do not count.
///
/// Contours of noise would cover whole penumbrae: where the mask is noisy they are those of its mean, one line for hundreds.
class Contours {
 public:
  /// `side` has a mask, and outlives this. Broad ones lie below others, so that both are seen where they coincide.
  Contours(const ComposeSide& side, const ContourInk& ink, bool is_broad);

  /// How near the middle of pixel (x, y) the nearest contour passes, in pixels; infinity where there is none.
  float distance(int x, int y) const;
  /// Whether the contour there is that of the mean.
  bool is_of_mean(int x, int y) const { return !noise_.is_noisy.empty() && noise_.is_noisy[index(x, y)]; }
  /// Over columns `first` up to `last` of row y, whose colors (R, G, B, 255 in memory order) begin with column 0.
  void paint(int y, int first, int last, std::span<std::uint32_t> colors) const;

 private:
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * gbuffer_.width + x; }

  const ComposeSide& side_;
  const GBuffer& gbuffer_;
  std::uint32_t core_, casing_;
  float half_core_, half_casing_;  ///< of their widths, pixels
  NoisyMask noise_;
};

}  // namespace gnomon::viewer
