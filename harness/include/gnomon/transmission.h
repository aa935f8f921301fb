#pragma once
#include <gnomon/alpha_mask.h>

namespace gnomon {

/// What part of the light the triangles of a mesh let through, straight and thin: no refraction, no Fresnel, no scattering. A
/// number for each texel, float32, made once at load, so that every technique and every reference multiplies the very same
/// numbers. Nearest, level 0: the texel that holds a place counts, column floor(width * u), row floor(height * v), then `wrap`
/// in integers, as of AlphaMask.
///
/// 1: the triangle is not there. 0: it is opaque, exactly.
class Transmission {
 public:
  using Wrap = AlphaMask::Wrap;
  static constexpr int most_texels = AlphaMask::most_texels;        ///< of a side
  static constexpr std::size_t most_values = std::size_t{1} << 26;  ///< texels times channels

  /// The same everywhere: red, green, blue. Throws Error on a number outside 0 .. 1.
  explicit Transmission(const glm::vec3& everywhere);
  /// `values` has width * height * channels numbers, texel after texel, row after row; one channel or three. Where all texels
  /// are equal one is kept, and where the three channels are equal everywhere one channel. Throws Error on sides out of
  /// 1 .. most_texels, more than most_values, another number of values, and a value outside 0 .. 1.
  Transmission(int width, int height, int channels, std::vector<float> values, Wrap wrap_u = Wrap::repeat,
               Wrap wrap_v = Wrap::repeat);

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  Wrap wrap_u() const { return wrap_u_; }
  Wrap wrap_v() const { return wrap_v_; }
  std::span<const float> values() const { return values_; }
  bool is_constant() const { return width_ == 1 && height_ == 1; }
  bool is_colored() const { return channels_ == 3; }

  /// Of a texel in 0 .. width - 1, 0 .. height - 1.
  glm::vec3 at(int column, int row) const {
    const float* value = &values_[(std::size_t(row) * width_ + column) * channels_];
    return channels_ == 1 ? glm::vec3(value[0]) : glm::vec3(value[0], value[1], value[2]);
  }
  /// Of any texel, wrapped.
  glm::vec3 at_wrapped(std::int64_t column, std::int64_t row) const {
    return at(AlphaMask::wrapped(column, width_, wrap_u_), AlphaMask::wrapped(row, height_, wrap_v_));
  }
  std::size_t bytes() const { return values_.size() * sizeof(float); }
  bool operator==(const Transmission&) const = default;

 private:
  int width_ = 1, height_ = 1, channels_ = 1;
  Wrap wrap_u_ = Wrap::repeat, wrap_v_ = Wrap::repeat;
  std::vector<float> values_;
};

}  // namespace gnomon
