#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "measure/picture/shading.h"

namespace gnomon::viewer {

// Colors of the composed picture: bytes R, G, B, 255 in memory order.

inline std::uint32_t pack(const Color& c) {
  return std::bit_cast<std::uint32_t>(std::array<std::uint8_t, 4>{c[0], c[1], c[2], 255});
}
inline std::uint32_t pack_gray(std::uint8_t level) { return pack({level, level, level}); }

/// A share as 256ths; none where it is no number.
inline std::uint32_t weight_of(float share) {
  return share > 0 ? static_cast<std::uint32_t>(std::min(share, 1.0f) * 256 + 0.5f) : 0;
}

/// So many 256ths of `above`, the rest of `below`, rounded; two channels at a time, each in 16 bits.
inline std::uint32_t mixed(std::uint32_t below, std::uint32_t above, std::uint32_t weight) {
  constexpr std::uint32_t every_other = 0x00ff00ff, half = 0x00800080;
  const auto pair = [&](std::uint32_t b, std::uint32_t a) { return b * (256 - weight) + a * weight + half; };
  return ((pair(below & every_other, above & every_other) >> 8) & every_other) |
         (pair((below >> 8) & every_other, (above >> 8) & every_other) & ~every_other);
}

}  // namespace gnomon::viewer
