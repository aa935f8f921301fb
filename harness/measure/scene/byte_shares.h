#pragma once
#include <array>
#include <cmath>

namespace gnomon {

// The share, 0 .. 1, that each byte of an image stands for, in double.
using ByteShares = std::array<double, 256>;

/// Of a linear channel: byte / 255.
inline const ByteShares& linear_shares() {
  static const ByteShares shares = [] {
    ByteShares all{};
    for (int byte = 0; byte < 256; ++byte) all[byte] = byte / 255.0;
    return all;
  }();
  return shares;
}

/// Of a channel of an sRGB color: the linear share. Source: IEC 61966-2-1.
inline const ByteShares& srgb_shares() {
  static const ByteShares shares = [] {
    ByteShares all{};
    for (int byte = 0; byte < 256; ++byte) {
      const double share = byte / 255.0;
      all[byte] = share <= 0.04045 ? share / 12.92 : std::pow((share + 0.055) / 1.055, 2.4);
    }
    return all;
  }();
  return shares;
}

}  // namespace gnomon
