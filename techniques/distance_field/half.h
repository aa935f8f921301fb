#pragma once
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>

// Half floats (IEEE 754 binary16) in memory, as an R16F texture holds them. No infinities, no not-a-numbers.
namespace gnomon::distance_field {

/// The nearest one, of two the one that ends in an even bit. |value| < 65520.
inline std::uint16_t to_half(float value) {
  assert(std::abs(value) < 65520);
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const std::uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;
  constexpr std::uint32_t least_normal = 113u << 23;  // 2^-14
  if (magnitude < least_normal) {
    // Multiples of 2^-24, which is the last bit of a float beside one half: the addition rounds.
    const float sum = std::bit_cast<float>(magnitude) + 0.5f;
    return static_cast<std::uint16_t>(sign | (std::bit_cast<std::uint32_t>(sum) - std::bit_cast<std::uint32_t>(0.5f)));
  }
  const std::uint32_t even = magnitude >> 13 & 1;
  return static_cast<std::uint16_t>(sign | (magnitude - (112u << 23) + 0xfffu + even) >> 13);
}

/// Exact.
inline float from_half(std::uint16_t half) {
  const std::uint32_t bits = half;
  const float magnitude = std::bit_cast<float>((bits & 0x7fffu) << 13) * 0x1p112f;
  return bits & 0x8000u ? -magnitude : magnitude;
}

using FourBits = std::uint32_t __attribute__((vector_size(16)));
using FourFloats = float __attribute__((vector_size(16)));

/// Two halves that are next to one another in memory, the first one in the lower bits.
inline std::uint32_t pair_at(const std::uint16_t* halves) {
  static_assert(std::endian::native == std::endian::little);
  std::uint32_t pair;
  std::memcpy(&pair, halves, sizeof pair);
  return pair;
}

/// Four at a time, each in the lower bits of its lane.
inline FourFloats from_halves(FourBits halves) {
  return std::bit_cast<FourFloats>((halves & 0x7fffu) << 13 | (halves & 0x8000u) << 16) * 0x1p112f;
}

}  // namespace gnomon::distance_field
