#pragma once
#include <gnomon/gbuffer.h>

#include <algorithm>

#include "measure/frame/classify.h"

namespace gnomon {

/// Whether a visibility counts as penumbra.
constexpr bool is_penumbra(float visibility) { return visibility > 0.02f && visibility < 0.98f; }

/// Neighborhoods of pixels, as far as they lie on one object that faces the light.
class PixelWindows {
 public:
  /// Without a G-buffer all is one object.
  PixelWindows(int width, int height, std::span<const PixelClass> classes, const GBuffer* gbuffer)
      : width_(width), height_(height), classes_(classes), gbuffer_(gbuffer) {}

  bool is_inside(int x, int y, int reach) const { return std::min({x, y, width_ - 1 - x, height_ - 1 - y}) >= reach; }
  bool is_one_object(std::size_t i, std::size_t j) const {
    return classes_[i] > PixelClass::F && classes_[j] > PixelClass::F && (!gbuffer_ || gbuffer_->mesh[i] == gbuffer_->mesh[j]);
  }
  /// Whether the square of side 2 * reach + 1 around pixel (x, y) is on one object.
  bool is_whole(int x, int y, int reach) const {
    if (!is_inside(x, y, reach)) return false;
    const std::size_t i = at(x, y);
    for (int dy = -reach; dy <= reach; ++dy)
      for (int dx = -reach; dx <= reach; ++dx)
        if (!is_one_object(i, at(x + dx, y + dy))) return false;
    return true;
  }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * width_ + x; }

  /// Slope per pixel of the plane that fits the 3 x 3 values best; the window must be inside.
  glm::dvec2 slope(std::span<const float> v, int x, int y) const {
    glm::dvec2 sum(0);
    for (int k = -1; k <= 1; ++k) {
      sum.x += static_cast<double>(v[at(x + 1, y + k)]) - v[at(x - 1, y + k)];
      sum.y += static_cast<double>(v[at(x + k, y + 1)]) - v[at(x + k, y - 1)];
    }
    return sum / 6.0;
  }
  /// Calls use(j) for the pixels of the square of side 2 * reach + 1 around pixel i that are tested and on the same object, i
  /// included.
  template <class Use>
  void for_tested(std::size_t i, int reach, const Use& use) const {
    const int x = static_cast<int>(i % width_), y = static_cast<int>(i / width_);
    for (int ny = std::max(0, y - reach); ny <= std::min(height_ - 1, y + reach); ++ny)
      for (int nx = std::max(0, x - reach); nx <= std::min(width_ - 1, x + reach); ++nx)
        if (const std::size_t j = at(nx, ny); classes_[j] == PixelClass::T && is_one_object(i, j)) use(j);
  }

 private:
  int width_, height_;
  std::span<const PixelClass> classes_;
  const GBuffer* gbuffer_;
};

}  // namespace gnomon
