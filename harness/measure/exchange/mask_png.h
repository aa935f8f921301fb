#pragma once
#include <gnomon/alpha_mask.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// A PNG of 8 bits a channel, 1 gray, 2 gray and alpha, 3 color, 4 color and alpha: texel after texel, the top row first. Not
/// compressed.
std::vector<std::byte> png_of(int width, int height, int channels, std::span<const std::uint8_t> texels);

/// A PNG of gray and alpha, 8 bits each, white throughout: alpha is 255 where the mask is solid, 0 in its holes. Not
/// compressed.
std::vector<std::byte> mask_png(const AlphaMask& mask);

}  // namespace gnomon
