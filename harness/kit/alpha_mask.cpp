#include <gnomon/alpha_mask.h>
#include <gnomon/error.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon {

namespace {

/// Bilinear alpha, 0 .. 255, between the centers of texels.
float bilinear(std::span<const std::uint8_t> alpha, int width, int height, AlphaMask::Wrap wrap_u, AlphaMask::Wrap wrap_v,
               double x, double y) {
  const double left = std::floor(x - 0.5), top = std::floor(y - 0.5), s = x - 0.5 - left, t = y - 0.5 - top;
  const auto at = [&](int dx, int dy) -> double {
    const int column = AlphaMask::wrapped(static_cast<std::int64_t>(left) + dx, width, wrap_u);
    const int row = AlphaMask::wrapped(static_cast<std::int64_t>(top) + dy, height, wrap_v);
    return alpha[std::size_t(row) * width + column];
  };
  return static_cast<float>((1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1)));
}

std::size_t solid_texels(std::span<const std::uint32_t> bits) {
  std::size_t solid = 0;
  for (const std::uint32_t word : bits) solid += static_cast<std::size_t>(std::popcount(word));
  return solid;
}

}  // namespace

AlphaMask::AlphaMask(int width, int height, std::span<const std::uint8_t> alpha, float factor, float cutoff, Wrap wrap_u,
                     Wrap wrap_v, int scale)
    : wrap_u_(wrap_u), wrap_v_(wrap_v), factor_(factor), cutoff_(cutoff) {
  const auto need_side = [&](const char* what, std::int64_t texels) {
    if (texels < 1 || texels > most_texels)
      throw Error("a mask's {} of {} texels is not within 1 .. {}", what, texels, most_texels);
  };
  if (scale < 1 || scale > most_texels) throw Error("a mask's scale of {} is not within 1 .. {}", scale, most_texels);
  need_side("width", width);
  need_side("height", height);
  need_side("width", std::int64_t(width) * scale);
  need_side("height", std::int64_t(height) * scale);
  if (alpha.size() != std::size_t(width) * height)
    throw Error("a mask of {} x {} texels has {} bytes of alpha, not {}", width, height, alpha.size(),
                std::size_t(width) * height);
  if (!(factor >= 0 && factor <= 1)) throw Error("a mask's factor of {} is not within 0 .. 1", factor);
  if (!(cutoff >= 0 && cutoff <= 1)) throw Error("a mask's cutoff of {} is not within 0 .. 1", cutoff);
  width_ = width * scale;
  height_ = height * scale;
  bits_.resize(std::size_t(words()) * height_);
  alpha_.resize(std::size_t(width_) * height_);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t i = std::size_t(y) * width_ + x;
      const float value = scale == 1 ? static_cast<float>(alpha[i])
                                     : bilinear(alpha, width, height, wrap_u, wrap_v, (x + 0.5) / scale, (y + 0.5) / scale);
      alpha_[i] = static_cast<std::uint8_t>(std::lround(value));
      if (value / 255 * factor >= cutoff) bits_[std::size_t(y) * words() + x / 32] |= 1u << (x & 31);
    }
  solid_ = solid_texels(bits_);
}

AlphaMask::AlphaMask(Parts parts)
    : width_(parts.width),
      height_(parts.height),
      wrap_u_(parts.wrap_u),
      wrap_v_(parts.wrap_v),
      factor_(parts.factor),
      cutoff_(parts.cutoff),
      bits_(std::move(parts.bits)),
      alpha_(std::move(parts.alpha)) {
  for (const int texels : {width_, height_})
    if (texels < 1 || texels > most_texels)
      throw Error("a stored mask's side of {} texels is not within 1 .. {}", texels, most_texels);
  for (const Wrap wrap : {wrap_u_, wrap_v_})
    if (wrap > Wrap::clamp) throw Error("a stored mask's wrap of {} is not within 0 .. 2", static_cast<std::uint32_t>(wrap));
  for (const float share : {factor_, cutoff_})
    if (!(share >= 0 && share <= 1)) throw Error("a stored mask's factor or cutoff of {} is not within 0 .. 1", share);
  const std::size_t words_wanted = std::size_t(words()) * height_, texels = std::size_t(width_) * height_;
  if (bits_.size() != words_wanted || alpha_.size() != texels)
    throw Error("a stored mask of {} x {} texels has {} words of bits and {} bytes of alpha, not {} and {}", width_, height_,
                bits_.size(), alpha_.size(), words_wanted, texels);
  const std::uint32_t beyond = width_ % 32 == 0 ? 0 : ~0u << width_ % 32;  // of a row's last word
  for (int y = 0; y < height_; ++y)
    if ((bits_[std::size_t(y + 1) * words() - 1] & beyond) != 0)
      throw Error("a stored mask of {} texels a row has solid ones behind the end of row {}", width_, y);
  solid_ = solid_texels(bits_);
}

}  // namespace gnomon
