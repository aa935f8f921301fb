#pragma once
#include <gnomon/gbuffer.h>

#include <algorithm>

namespace gnomon {

inline constexpr std::uint32_t no_component = 0xffffffffu;
inline constexpr std::uint32_t crack_size = 4;   ///< pixels that a crack has at most
inline constexpr std::uint32_t caster_size = 8;  ///< pixels that the shadow of a missing caster has at least

/// Connected sets of pixels.
struct Components {
  std::vector<std::uint32_t> of;    ///< number of each pixel's component, from 0; no_component where it has none
  std::vector<std::uint32_t> size;  ///< pixels of each component
};

/// 8-connected pixels with equal keys are one component; pixels whose key is `none` belong to nothing.
inline Components connect(std::span<const std::uint32_t> keys, std::uint32_t none, int width, int height) {
  Components result;
  result.of.assign(keys.size(), no_component);
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < keys.size(); ++seed) {
    if (keys[seed] == none || result.of[seed] != no_component) continue;
    const auto number = static_cast<std::uint32_t>(result.size.size());
    std::uint32_t size = 0;
    open.push_back(seed);
    result.of[seed] = number;
    while (!open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      ++size;
      const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
      for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
          const std::size_t j = static_cast<std::size_t>(ny) * width + nx;
          if (keys[j] != keys[seed] || result.of[j] != no_component) continue;
          result.of[j] = number;
          open.push_back(j);
        }
    }
    result.size.push_back(size);
  }
  return result;
}

/// 1 in every connected set of equal keys that has `caster_size` pixels or more and of whose darkness the mask has less than a
/// tenth. `darkness(i)` and `darkness_of_mask(i)` are summed over the set; no_mesh is the key of pixels in light.
template <class Darkness, class DarknessOfMask>
std::vector<std::uint8_t> missing_shadows(std::span<const std::uint32_t> keys, int width, int height, const Darkness& darkness,
                                          const DarknessOfMask& darkness_of_mask) {
  const Components shadows = connect(keys, no_mesh, width, height);
  std::vector<double> dark(shadows.size.size()), dark_in_mask(dark.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (shadows.of[i] == no_component) continue;
    dark[shadows.of[i]] += darkness(i);
    dark_in_mask[shadows.of[i]] += darkness_of_mask(i);
  }
  std::vector<std::uint8_t> missing(keys.size(), 0);
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (const std::uint32_t shadow = shadows.of[i]; shadow != no_component)
      missing[i] = shadows.size[shadow] >= caster_size && 10 * dark_in_mask[shadow] < dark[shadow];
  return missing;
}

}  // namespace gnomon
