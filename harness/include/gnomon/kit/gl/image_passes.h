#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

// Passes over images of floats, for maps that are filtered before they are read (variance, moments, exponentials): blurred,
// halved again and again, summed up. An image is a texture of one, two or four numbers a texel: float32 (R32F, RG32F, RGBA32F),
// float16 (R16F, RG16F, RGBA16F), 16 bits for 0 .. 1 (R16, RG16, RGBA16), and for sums whole numbers of 32 bits (R32UI, RG32UI,
// RGBA32UI); each channel and each layer is treated by itself. Values are to be finite: what is not spreads, and 0 times it is
// NaN. What is below 2^-126 may count as 0. Errors are those of float32; whatever has 16 bits is computed in float32 and
// rounded where it is stored, by up to `stored_rounding` more.
//
// `setup` compiles for one kind of image; `run` takes those, of any size. Drivers compile once more at the first use, llvmpipe
// for sides and numbers of layers that are powers of two apart from others: `warm_up`, which ends a technique's setup, keeps
// that out of its stages where it sees images of the size of those to come. All are compute programs: they leave the house
// state, and what they wrote is there for whatever comes next.

/// What the programs of a pass are compiled for.
struct ImageKind {
  GLenum format = GL_RGBA32F;
  bool has_layers = false;  ///< an array, be it of one layer
};

/// What storing rounds off at most: 2^-16 where 16 bits hold 0 .. 1, the share 2^-10 of a float16, and 2^-24 where it is below
/// 2^-14 (twice a half of the last bit, since drivers may round toward 0); 0 for 32 bits.
struct StoredRounding {
  double absolute = 0, share = 0;
};
StoredRounding stored_rounding(GLenum format);

/// Texels of one layer.
struct LayerRectangle {
  int layer = 0;
  PixelRectangle texels;
  bool operator==(const LayerRectangle&) const = default;
};

/// Every texel becomes a weighted mean of the (2 radius + 1)^2 around it, first along rows, then along columns. Beyond the
/// border the texel at the border counts. The weights are those of `blur_weights`. Source: Donnelly and Lauritzen 2006, who
/// blur a variance map in this way. Error: below (2 radius + 3) * 2^-23 of the largest absolute value in the window (2 radius
/// + 3 roundings of 2^-24 in each of two passes). Of 16 bits two stores round.
class Blur {
 public:
  enum class Weights { box, gaussian };
  static constexpr int most_radius = 32;  ///< texels

  /// Compiles for one radius, in texels, 1 .. most_radius; throws Error outside. Takes longer for larger ones: with the first
  /// use on llvmpipe 0.06 s (R32F, 4 texels) to 0.5 s (RGBA32F, 32 texels).
  void setup(const ImageKind& kind, Weights weights, int radius);
  /// Level 0 of `to`, which may be `from`, gets level 0 of `from` blurred. When it has another size it is made new, with one
  /// level.
  void run(const Texture& from, Texture& to);
  /// The same of these texels alone; `to`, of that size, keeps the others, and is not `from`. Of `from`, texels up to the
  /// radius beside them are read. Each texel is computed as in a whole image. Rectangles begin and end at multiples of a tile
  /// or at the border.
  void run(const Texture& from, const Texture& to, std::span<const LayerRectangle> within);
  static constexpr int tile_width = 128, tile_height = 32;  ///< texels
  /// Of the image between the two passes, as large as the last one that was blurred.
  std::size_t bytes() const { return between_.bytes; }

 private:
  /// `layers` of them from that of the rectangle on.
  void run_along(bool x, const Texture& from, const Texture& to, const LayerRectangle& first, int layers) const;

  ImageKind kind_;
  int radius_ = 0;
  Program rows_, columns_;
  Texture between_;
};

/// Of the texel itself and of those 1 .. radius away: w[0] + 2 (w[1] + w[2] + ...) = 1, up to rounding. Box: all the same.
/// Gaussian: exp(-d^2 / 2 s^2) at whole d with s = radius / 2 texels; what lies beyond (5 % of a Gaussian) is left out.
std::vector<float> blur_weights(Blur::Weights weights, int radius);

/// Levels of an image down to a single texel: 1 + floor(log2(longer side)).
int level_count(int width, int height);

/// Levels 1, 2, ... of a texture from its level 0: each texel is the mean of two by two of the level above. Of an odd number
/// of rows or columns the last texel takes the last three, so that each texel counts, if less than its share; of a single one
/// the only one. Source: Donnelly and Lauritzen 2006, who read means of areas from such levels. Error of level k: below
/// k * 2^-21 of the mean absolute value below the texel (at most eight roundings of 2^-24 a level). Absolute values up to
/// 2^124. Of 16 bits each level is stored, and so rounded, once more.
class MipChain {
 public:
  void setup(const ImageKind& kind);
  /// Makes all levels that the texture has but the first.
  void run(const Texture& texture) const;

 private:
  void make_level(const Texture& texture, int level) const;

  ImageKind kind_;
  Program body_, edge_;
};

/// Summed-area table: each texel becomes the sum of all texels at most as far right and at most as far down, itself included
/// (row 0 is that of glTexSubImage's first). With S(x, y) the table and 0 outside, the sum over columns a+1 .. b and rows
/// c+1 .. d is S(b, d) - S(a, d) - S(b, c) + S(a, c). Source: Crow 1984; for shadow maps Lauritzen 2007. Error of a texel:
/// below 2^-21 times the sum of the absolute values that it adds up, whatever the size, since rows and columns are summed with
/// compensation (Kahan 1965). An `offset` that lies in the middle of the values makes that sum, and so the error, smaller
/// (Hensley et al. 2005): it is taken off every texel first; add it times the area to what the table says.
///
/// Small areas of a large image are differences of large sums: of 1024 x 1024 values in 0 .. 1 a float32 sum is off by 2^-24 of
/// up to 2^20, a sixteenth of one value. Sums of whole numbers are exact modulo 2^32, and so is each difference that is less
/// than that, however large the sums: an image of uint holds values times 2^32 over the largest area that will be queried
/// (Lauritzen 2007). They have no offset; 16 bits are too few.
class SummedAreaTable {
 public:
  void setup(const ImageKind& kind);
  /// Level 0 of `to`, which may be `from`, gets the sums of level 0 of `from`. When it has another size it is made new, with
  /// one level.
  void run(const Texture& from, Texture& to, const glm::vec4& offset = glm::vec4(0)) const;

 private:
  ImageKind kind_;
  Program rows_, columns_;
};

}  // namespace gnomon
