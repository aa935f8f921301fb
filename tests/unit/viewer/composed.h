#pragma once
#include <gtest/gtest.h>

#include <bit>

#include "hand_made_frame.h"

// What `compose` makes of hand-made frames, as pixels and bytes.
namespace composed_pixels {
using namespace gnomon;
using namespace gnomon::viewer;
using hand_made_frame::Rgb;

inline std::vector<std::uint32_t> composed(const Composition& c) {
  std::vector<std::uint32_t> rgba(static_cast<std::size_t>(c.width) * c.height, 0x01020304);
  compose(c, rgba);
  return rgba;
}

/// The bytes of `composed` without alpha, which is 255.
inline std::vector<std::uint8_t> bytes_of(const Composition& c) {
  std::vector<std::uint8_t> rgb;
  for (const std::uint32_t pixel : composed(c)) {
    const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(pixel);
    EXPECT_EQ(bytes[3], 255);
    rgb.insert(rgb.end(), bytes.begin(), bytes.begin() + 3);
  }
  return rgb;
}

inline std::vector<Rgb> pixels_of(const Composition& c) {
  const std::vector<std::uint8_t> bytes = bytes_of(c);
  std::vector<Rgb> pixels;
  for (std::size_t i = 0; i < bytes.size(); i += 3) pixels.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
  return pixels;
}

}  // namespace composed_pixels
