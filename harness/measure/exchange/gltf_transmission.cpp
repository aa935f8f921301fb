#include "measure/exchange/gltf_transmission.h"

#include <algorithm>
#include <cmath>

#include "measure/scene/byte_shares.h"

namespace gnomon {

namespace {

std::uint8_t nearest_byte(const ByteShares& shares, double share) {
  const auto above = std::ranges::lower_bound(shares, share);
  if (above == shares.begin()) return 0;
  if (above == shares.end()) return 255;
  const auto byte = above - shares.begin();
  return static_cast<std::uint8_t>(*above - share < share - *(above - 1) ? byte : byte - 1);
}

}  // namespace

GltfTransmission gltf_transmission(const Transmission& transmission) {
  GltfTransmission result;
  const bool is_colored = transmission.is_colored();
  if (transmission.is_constant()) {
    if (is_colored)
      result.color = transmission.at(0, 0);
    else
      result.factor = transmission.at(0, 0).x;
    return result;
  }
  const ByteShares& shares = is_colored ? srgb_shares() : linear_shares();
  result.channels = transmission.channels();
  for (const float value : transmission.values()) {
    const std::uint8_t byte = nearest_byte(shares, value);
    result.bytes.push_back(byte);
    result.rounding = std::max(result.rounding, std::abs(double(static_cast<float>(shares[byte])) - double(value)));
  }
  return result;
}

}  // namespace gnomon
