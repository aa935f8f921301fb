#pragma once
#include <gnomon/kit/gl/gl.h>

#include "draw_lists.h"

// Where pages lie in the pool, and which of them stay there after an update.
namespace gnomon::virtual_map {

/// Where pages lie: side by side in the layers of an array, sixteen in a row of 128.
struct PoolLayout {
  /// Room for the pages and the rest of a row, or in steps of a quarter: a few pages more or less mostly leave it as it is.
  enum class Room { exact, in_steps };
  static constexpr int width = 2048, most_height = 8192;  ///< texels of a layer
  int page_size = 128, rows = 1, layers = 1;
  std::vector<std::uint32_t> slots{};  ///< of each page of a table; none where that is its index

  PoolLayout() = default;
  PoolLayout(std::size_t page_count, int page_size, Room room = Room::exact) : page_size(page_size) {
    const int most_rows = most_height / page_size;
    int all_rows = std::max(1, (static_cast<int>(page_count) + columns() - 1) / columns());
    if (room == Room::in_steps) {
      const int step = std::max(1, static_cast<int>(std::bit_floor(static_cast<unsigned>(all_rows))) / 4);
      all_rows = (all_rows + step - 1) / step * step;
    }
    layers = (all_rows + most_rows - 1) / most_rows;
    rows = (all_rows + layers - 1) / layers;
  }
  /// Of these pages, where `moving` tells of each whether a moving caster touches it. None: they have no slots of their own.
  ///
  /// A page takes the first free slot from a place on that follows from its address, those that no moving caster touches
  /// first, in rising order. So slots follow from the pages and from nothing that was before, and other pages change few of
  /// them.
  PoolLayout(std::span<const PageAddress> pages, int page_size, std::span<const std::uint8_t> moving)
      : PoolLayout(pages.size(), page_size, moving.empty() ? Room::exact : Room::in_steps) {
    slots.resize(moving.size());
    const std::uint32_t count = slot_count();
    std::vector<std::uint8_t> is_taken(count);
    for (const std::uint8_t moves : {0, 1})
      for (std::size_t k = 0; k < moving.size(); ++k) {
        if (moving[k] != moves) continue;
        // The address times 2^32 / golden ratio: neighbors lie far apart.
        auto slot = static_cast<std::uint32_t>(std::uint64_t(pages[k].word * 0x9E3779B1u) * count >> 32);
        while (is_taken[slot] != 0) slot = slot + 1 == count ? 0 : slot + 1;
        is_taken[slot] = 1;
        slots[k] = slot;
      }
  }
  int columns() const { return width / page_size; }
  std::uint32_t slot_count() const { return static_cast<std::uint32_t>(columns() * rows * layers); }
  std::uint32_t slot(std::uint32_t page) const { return slots.empty() ? page : slots[page]; }
  /// Column, row, layer of a page, by its index in the table.
  glm::ivec3 place(std::uint32_t page) const {
    const int at = static_cast<int>(slot(page)), row = at / columns();
    return {at % columns(), row % rows, row / rows};
  }
  /// The same as shaders read it.
  std::uint32_t word(std::uint32_t page) const {
    const glm::uvec3 at(place(page));
    return at.z << 16 | at.y << 8 | at.x;
  }
};

/// Of each page whether a triangle of a mesh that moves is in its list: 1 or 0.
inline std::vector<std::uint8_t> pages_of_moving(const DrawLists& lists, const Footprints& footprints,
                                                 const MovingMeshes& moving, std::size_t page_count) {
  std::vector<std::uint8_t> found(page_count);
  const auto moves = [&](std::uint32_t item) { return moving.moves(footprints.all[item].mesh); };
  for_blocks(page_count, 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      found[k] = std::ranges::any_of(lists.bins.of(2 * k), moves) || std::ranges::any_of(lists.bins.of(2 * k + 1), moves);
  });
  return found;
}

/// Which page a pool shows in each of its slots, of those that no moving caster touches.
///
/// Such a page stays right while nothing but these casters moves. Its texels have the same bits as if they were drawn again,
/// for it is drawn again at the same place of the window, by the same list: elsewhere a rasterizer rounds in another way.
class StillPages {
 public:
  StillPages() = default;
  StillPages(const PageTable& table, const PoolLayout& layout, std::span<const std::uint8_t> moving, AlphaRule rule)
      : rows_(layout.rows), layers_(layout.layers), rule_(rule) {
    if (!moving.empty()) by_slot_.resize(layout.slot_count());
    for (std::uint32_t k = 0; k < moving.size(); ++k)
      if (moving[k] == 0) by_slot_[layout.slot(k)] = table.pages[k];
  }
  /// Of each page of a table whether it needs not be drawn: 1 or 0.
  std::vector<std::uint8_t> kept(const PageTable& table, const PoolLayout& layout, std::span<const std::uint8_t> moving,
                                 AlphaRule rule) const {
    std::vector<std::uint8_t> is_kept(table.pages.size());
    if (by_slot_.empty() || layout.rows != rows_ || layout.layers != layers_ || rule != rule_) return is_kept;
    for (std::uint32_t k = 0; k < moving.size(); ++k) is_kept[k] = moving[k] == 0 && by_slot_[layout.slot(k)] == table.pages[k];
    return is_kept;
  }
  std::size_t bytes() const { return bytes_of(by_slot_); }

 private:
  std::vector<PageAddress> by_slot_;
  int rows_ = 0, layers_ = 0;
  AlphaRule rule_ = AlphaRule::texel;
};

}  // namespace gnomon::virtual_map
