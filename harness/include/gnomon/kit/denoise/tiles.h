#pragma once
#include <gnomon/kit/denoise/filters.h>

namespace gnomon {

// Parts of the shadow denoiser of FidelityFX (AMD, 2021): tiles that need no filter, the local mean that holds the history, and
// moments over frames. Its passes are GuidedFilter with tile_rule, levels 0 .. 2; the output of level 0 is its history.

/// What a pixel has from frame to frame.
struct TileMoments {
  float mean = 0, squares = 0;  ///< by Welford 1962
  float length = 0;             ///< frames; lowered where the history does not fit
};

/// What one pixel's frame decides, from the values of the real channel. A twin channel takes the same numbers.
struct TileStep {
  TileMoments moments;
  float variance = 0;
  float blend = 1;          ///< of the current frame
  float low = 0, high = 0;  ///< history is held between them

  /// The history clamped, then blended: linear in `current` and, inside the interval, in `history`.
  float blended(float current, float history) const noexcept;
};

/// `mean` is the local mean of the current values, of variance mean - mean^2; `history` the value of the frame before.
TileStep tile_step(const TileMoments& before, float current, float mean, float history) noexcept;

/// V^max(1.2 - variance, 1), the last step of the original. It darkens on purpose: 0.5 becomes 0.435.
float darkened(float value, float variance) noexcept;

/// Tiles of 8x8 pixels, words of 8x4 pixels, and local means by 17 taps exp(-3 i^2 / 81) both ways.
class TileMap {
 public:
  /// From shares that were asked, 0 .. 1: num / den. Reuses its memory at the same size. Throws Error on sizes that do not
  /// agree.
  void make(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators);
  /// Whether all pixels that count in the 3 x 6 words around the tile of pixel (x, y) are lit, or all dark. One whose
  /// denominator is 0 is neither.
  bool is_uniform(int x, int y) const { return uniform_[static_cast<std::size_t>(y / 8) * tile_columns_ + x / 8] != 0; }
  /// Of each pixel, row-major: the ratio of sums of numerators and denominators under the 17 x 17 taps, pixels that count
  /// alone; 1 where there is none.
  std::span<const float> mean() const { return mean_; }
  /// 0 on pixels of uniform tiles, 1 on others: `strength` of GuidedFilter.
  std::span<const float> strength() const { return strength_; }
  std::size_t bytes() const;

 private:
  void mark(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators);
  void average(const FilterGuides& guides, std::span<const float> numerators, std::span<const float> denominators);

  int tile_columns_ = 0, word_rows_ = 0;
  UnsetVector<std::uint32_t> lit_, dark_;  ///< words: bit 8 * row + column: the pixel is at least partly so
  UnsetVector<std::uint8_t> uniform_;      ///< of tiles
  UnsetVector<float> top_, bottom_;        ///< numerators and denominators with margins, 0 where a pixel does not count
  UnsetVector<float> across_top_, across_bottom_, mean_, strength_;
};

}  // namespace gnomon
