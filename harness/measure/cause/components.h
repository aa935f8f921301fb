#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

inline constexpr std::uint32_t no_component = 0xffffffffu;

/// Connected sets of pixels.
struct Components {
  std::vector<std::uint32_t> of;    ///< number of each pixel's component, from 0; no_component where it has none
  std::vector<std::uint32_t> size;  ///< pixels of each component
};

/// 8-connected pixels with equal keys are one component; pixels whose key is `none` belong to nothing.
Components connect(std::span<const std::uint32_t> keys, std::uint32_t none, int width, int height);

}  // namespace gnomon
