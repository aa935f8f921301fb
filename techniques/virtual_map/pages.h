#pragma once
#include <gnomon/kit/maps/light_camera.h>

#include <cstdint>
#include <span>
#include <vector>

// The virtual image of a light's face: levels, pages, and which of them a picture asks for.
namespace gnomon::virtual_map {

/// Texels along a side of level 0. A texel's coordinate in float32 rounds three times, by 2^-7 texel at most: another doubling
/// would make edges of pages visible.
inline constexpr int finest_side = 1 << 17;
/// What a fit keeps free on each side, texels of level 0: for rounding. One texel answers, so nothing beside it is read.
inline constexpr int fit_margin = 2;

/// Which page of which level of which face. Zero is none. Shaders make the same word (shaders.h).
struct PageAddress {
  static constexpr std::uint32_t none = 0;
  std::uint32_t word = none;

  static PageAddress of(int face, int level, const glm::ivec2& page) {
    return {1u << 31 | std::uint32_t(face) << 26 | std::uint32_t(level) << 22 | std::uint32_t(page.y) << 11 |
            std::uint32_t(page.x)};
  }
  int face() const { return word >> 26 & 7; }
  int level() const { return word >> 22 & 15; }
  glm::ivec2 page() const { return {word & 2047, word >> 11 & 2047}; }
  /// The one that holds it, so many levels up, but no higher than `top`.
  PageAddress raised(int levels, int top) const {
    const int to = std::min(level() + levels, top);
    return of(face(), to, page() >> (to - level()));
  }
  auto operator<=>(const PageAddress&) const = default;
};

/// The level that is one page.
int top_level(int page_size);

/// The camera of level 0: fitted to the scene, its texels as wide as high.
LightCamera finest_camera(const Light& light, const MeshBoxes& boxes);
/// Of a face of it: one whose texels have 2^level times the side.
LightImage at_level(LightImage image, int level);

/// The pages that are drawn, in rising order; a page's place here is its slot.
struct PageTable {
  std::vector<PageAddress> pages{};
  std::size_t asked_count = 0;  ///< before levels were raised
  int raised = 0;               ///< levels that all of them were raised by, to find room

  /// Of a page that is drawn.
  std::uint32_t slot(PageAddress address) const;
  int level_count() const;
};

/// The pages that pixels ask for. Of more than there is room for all levels are raised until they fit; six always do.
PageTable pages_of(std::span<const std::uint32_t> asked, std::size_t room, int top);

}  // namespace gnomon::virtual_map
