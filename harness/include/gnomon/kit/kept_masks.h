#pragma once
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// The masks of many points of a light, for questions about single pixels afterwards: a bit for each pixel where a mask is
/// hard, else 16 bits.
class KeptMasks {
 public:
  void clear() { masks_.clear(); }
  bool empty() const { return masks_.empty(); }
  void add(std::span<const float> mask) {
    Mask& kept = masks_.emplace_back();
    bool is_hard = true;
    for (const float value : mask) is_hard = is_hard && (value == 0 || value == 1);
    if (is_hard) {
      kept.bits.assign((mask.size() + 63) / 64, 0);
      for (std::size_t i = 0; i < mask.size(); ++i) kept.bits[i / 64] |= std::uint64_t{mask[i] == 1} << i % 64;
    } else {
      kept.levels.reserve(mask.size());
      for (const float value : mask) kept.levels.push_back(static_cast<std::uint16_t>(std::lround(value * 65535)));
    }
  }
  /// To 1 / 131070.
  double at(std::size_t mask, std::size_t pixel) const {
    const Mask& kept = masks_[mask];
    if (kept.levels.empty()) return static_cast<double>(kept.bits[pixel / 64] >> pixel % 64 & 1);
    return kept.levels[pixel] / 65535.0;
  }

 private:
  struct Mask {
    std::vector<std::uint64_t> bits;
    std::vector<std::uint16_t> levels;
  };
  std::vector<Mask> masks_;
};

}  // namespace gnomon
