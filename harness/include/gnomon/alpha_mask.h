#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace gnomon {

/// Which parts of a mesh are there: a bit for each texel, made once, so that every technique and every reference sees the very
/// same holes. A point of a triangle is solid where the bit of the texel that holds its place is set: nearest, level 0. So what
/// is solid is a finite set of polygons.
///
/// Column of a place: floor(width * u), row: floor(height * v), then `wrap` in integers. Row 0 is the first row of the image.
class AlphaMask {
 public:
  enum class Wrap : std::uint32_t { repeat, mirror, clamp };
  static constexpr int most_texels = 16384;  ///< of a side

  AlphaMask() = default;
  /// `alpha` has width * height bytes, row after row, and is linear. A texel is solid where byte / 255 * factor >= cutoff, all
  /// in float32, as shaders have it. With `scale` k > 1 the mask is made k times finer by bilinear alpha at the centers of its
  /// texels: edges then follow the isoline of the cutoff. Throws Error on sizes out of 1 .. most_texels, a cutoff or a factor
  /// outside 0 .. 1, and another number of bytes.
  AlphaMask(int width, int height, std::span<const std::uint8_t> alpha, float factor = 1, float cutoff = 0.5f,
            Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat, int scale = 1);

  /// Everything that a mask holds. Its bits do not follow from its alpha, which is rounded where the scale is not 1.
  struct Parts {
    int width = 0, height = 0;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    float factor = 1, cutoff = 0.5f;
    std::vector<std::uint32_t> bits;
    std::vector<std::uint8_t> alpha;
  };
  /// A stored mask. Throws Error where the parts are none of a mask.
  explicit AlphaMask(Parts parts);

  int width() const { return width_; }
  int height() const { return height_; }
  Wrap wrap_u() const { return wrap_u_; }
  Wrap wrap_v() const { return wrap_v_; }
  float factor() const { return factor_; }
  float cutoff() const { return cutoff_; }
  /// 32-bit words of a row of bits.
  int words() const { return (width_ + 31) / 32; }
  /// Rows of bits; bit x & 31 of word x / 32 is column x, set where the texel is solid.
  std::span<const std::uint32_t> bits() const { return bits_; }
  /// One byte a texel of the finer mask: what the bits were made of, for techniques that filter alpha.
  std::span<const std::uint8_t> alpha() const { return alpha_; }

  /// Of a texel in 0 .. width - 1, 0 .. height - 1.
  bool is_solid(int column, int row) const { return bits_[std::size_t(row) * words() + column / 32] >> (column & 31) & 1; }
  /// Of any texel, wrapped.
  bool is_solid_wrapped(std::int64_t column, std::int64_t row) const {
    return is_solid(wrapped(column, width_, wrap_u_), wrapped(row, height_, wrap_v_));
  }
  /// The share of texels that are solid.
  double coverage() const { return static_cast<double>(solid_) / (static_cast<double>(width_) * height_); }
  std::size_t bytes() const { return bits_.size() * 4 + alpha_.size(); }

  /// -1 becomes size - 1, 0 and 0 when repeated, mirrored and clamped.
  static int wrapped(std::int64_t place, int size, Wrap wrap) {
    if (wrap == Wrap::clamp) return static_cast<int>(place < 0 ? 0 : place >= size ? size - 1 : place);
    const std::int64_t period = wrap == Wrap::mirror ? 2 * std::int64_t(size) : size;
    std::int64_t rest = place % period;
    if (rest < 0) rest += period;
    return static_cast<int>(rest < size ? rest : period - 1 - rest);
  }

 private:
  int width_ = 0, height_ = 0;
  Wrap wrap_u_ = Wrap::repeat, wrap_v_ = Wrap::repeat;
  float factor_ = 1, cutoff_ = 0.5f;
  std::size_t solid_ = 0;  ///< texels
  std::vector<std::uint32_t> bits_;
  std::vector<std::uint8_t> alpha_;
};

}  // namespace gnomon
