#pragma once
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/parallel.h>

#include <bit>

// The virtual image of a light's face: levels, pages, and which of them a picture requests.
namespace gnomon::virtual_map {

/// Texels along a side of level 0. A texel's coordinate in float32 rounds three times, by 2^-7 texel at most: another doubling
/// would make edges of pages visible.
inline constexpr int finest_side = 1 << 17;
/// What a fit keeps free on each side, texels of level 0: for rounding. A look-up reads one texel and nothing beside it.
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
  /// The page that contains it, so many levels up, but no higher than `top`.
  PageAddress raised(int levels, int top) const {
    const int to = std::min(level() + levels, top);
    return of(face(), to, page() >> (to - level()));
  }
  auto operator<=>(const PageAddress&) const = default;
};

/// The level that is one page.
inline int top_level(int page_size) { return std::countr_zero(unsigned(finest_side)) - std::countr_zero(unsigned(page_size)); }

/// The camera of level 0: fitted to the scene, its texels as wide as high.
inline LightCamera finest_camera(const Light& light, const MeshBoxes& boxes) {
  LightCamera camera = fit_to_scene(light, boxes, finest_side, fit_margin);
  for (LightImage& image : camera.images) {
    const glm::dvec2 middle = (finest_side / 2.0 - image.offset) / image.scale;
    image.scale = glm::dvec2(std::min(image.scale.x, image.scale.y));
    image.offset = finest_side / 2.0 - middle * image.scale;
  }
  return camera;
}

/// Of a face of that camera: the image whose texels have 2^level times the side.
inline LightImage at_level(LightImage image, int level) {
  image.scale *= std::ldexp(1.0, -level);
  image.offset *= std::ldexp(1.0, -level);
  return image;
}

/// The pages that are looked up, in rising order; the index of a page is its slot, unless PoolLayout gives it another.
struct PageTable {
  std::vector<PageAddress> pages{};
  std::size_t asked_count = 0;  ///< before levels were raised
  int raised = 0;               ///< levels that all of them were raised by, to find room

  /// Of a page that is there.
  std::uint32_t index(PageAddress address) const {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(pages, address) - pages.begin());
  }
  int level_count() const {
    std::uint32_t levels = 0;
    for (const PageAddress& page : pages) levels |= 1u << page.level();
    return std::popcount(levels);
  }
  void sort_and_thin() {
    std::ranges::sort(pages);
    pages.erase(std::unique(pages.begin(), pages.end()), pages.end());
  }
};

/// The pages that pixels request. Where these are more than there is room for, all levels are raised until they fit; six always
/// do.
inline PageTable pages_of(std::span<const std::uint32_t> asked, std::size_t room, int top) {
  // Neighbors mostly request the same page: what differs from the pixel before is sorted, block by block.
  constexpr std::size_t block = 16384;
  std::vector<PageTable> found((asked.size() + block - 1) / block);
  for_blocks(asked.size(), block, [&](std::size_t begin, std::size_t end) {
    PageTable& mine = found[begin / block];
    std::uint32_t last = PageAddress::none;
    for (std::size_t i = begin; i < end; ++i) {
      if (asked[i] == last) continue;
      last = asked[i];
      if (last != PageAddress::none) mine.pages.push_back({last});
    }
    mine.sort_and_thin();
  });
  PageTable table;
  for (const PageTable& mine : found) table.pages.insert(table.pages.end(), mine.pages.begin(), mine.pages.end());
  table.sort_and_thin();
  table.asked_count = table.pages.size();
  for (; table.pages.size() > room && table.raised < top; ++table.raised) {
    for (PageAddress& page : table.pages) page = page.raised(1, top);
    table.sort_and_thin();
  }
  return table;
}

}  // namespace gnomon::virtual_map
