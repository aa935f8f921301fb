#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <utility>

namespace gnomon {

/// Pixels that are near to each other, as those of one mesh in a tile are: what one question about all of them may start from.
struct PixelGroup {
  /// A plane that none of the points lies below: only what reaches above it is before places over their horizon.
  struct Above {
    glm::dvec3 normal;
    double height, highest;  ///< along the normal: of the lowest and of the highest of the points
  };
  Bounds box;                  ///< of the points
  std::optional<Above> above;  ///< where all have one normal
};
PixelGroup group_of(const GBuffer& gbuffer, std::span<const std::uint32_t> pixels);

/// Sorts pixels into two halves along the longest side of their box.
std::pair<std::span<std::uint32_t>, std::span<std::uint32_t>> halve(const GBuffer& gbuffer, const Bounds& box,
                                                                    std::span<std::uint32_t> pixels);

/// Halves pixels as long as narrow(level, group) says that there is too much to test for each of them: levels count halvings
/// from 0, and the group of the level above was narrowed last. Then use(group, pixels).
template <class Narrow, class Use>
void for_narrow_groups(const GBuffer& gbuffer, std::span<std::uint32_t> pixels, const Narrow& narrow, const Use& use,
                       std::size_t level = 0) {
  constexpr std::size_t few_pixels = 4;
  const PixelGroup group = group_of(gbuffer, pixels);
  if (!narrow(level, group) || pixels.size() <= few_pixels) return use(group, pixels);
  const auto [some, others] = halve(gbuffer, group.box, pixels);
  for_narrow_groups(gbuffer, some, narrow, use, level + 1);
  for_narrow_groups(gbuffer, others, narrow, use, level + 1);
}

inline constexpr int tile_side = 16;
/// Tiles of 16 x 16 pixels in a picture.
std::size_t tile_count(const GBuffer& gbuffer);
/// The pixels of a tile for which is_asked(pixel), mesh after mesh.
template <class IsAsked>
void pixels_of_tile(const GBuffer& gbuffer, std::size_t tile, const IsAsked& is_asked, std::vector<std::uint32_t>& pixels) {
  const std::size_t columns = (gbuffer.width + tile_side - 1) / tile_side;
  const int left = static_cast<int>(tile % columns) * tile_side, top = static_cast<int>(tile / columns) * tile_side;
  pixels.clear();
  for (int y = top; y < std::min(top + tile_side, gbuffer.height); ++y)
    for (int x = left; x < std::min(left + tile_side, gbuffer.width); ++x)
      if (const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x; is_asked(i))
        pixels.push_back(static_cast<std::uint32_t>(i));
  std::ranges::stable_sort(pixels, {}, [&](std::uint32_t i) { return gbuffer.mesh[i]; });
}

/// On all threads: use(pixels, tile, scratch) for the pixels of each mesh in each tile that is_asked(pixel), in the order of
/// the picture. `borrow()` gives a thread its scratch.
template <class IsAsked, class Borrow, class Use>
void for_pixel_groups(const GBuffer& gbuffer, const IsAsked& is_asked, const Borrow& borrow, const Use& use) {
  for_blocks(tile_count(gbuffer), 1, [&](std::size_t begin, std::size_t end) {
    const auto scratch = borrow();
    std::vector<std::uint32_t> pixels;
    for (std::size_t tile = begin; tile < end; ++tile) {
      pixels_of_tile(gbuffer, tile, is_asked, pixels);
      for (auto first = pixels.begin(); first != pixels.end();) {
        const auto last =
            std::find_if(first, pixels.end(), [&](std::uint32_t i) { return gbuffer.mesh[i] != gbuffer.mesh[*first]; });
        use(std::span<std::uint32_t>(first, last), tile, *scratch);
        first = last;
      }
    }
  });
}

}  // namespace gnomon
