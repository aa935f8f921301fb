#pragma once
#include "tiles.h"

namespace composite_planar {

/// A rectangle of pixels. Where it shows a plane, its pixels evaluate the tests of a list; without a list they are all dark.
struct Patch {
  std::uint32_t left, top, right, bottom;  ///< pixels
  std::uint32_t plane, first, count;       ///< receiver; where the list is in `lists`

  double pixel_count() const { return double(right - left) * (bottom - top); }
};

/// What a draw is made of. Reused from picture to picture.
class Patches {
 public:
  static constexpr std::uint32_t most = 4;  ///< tests in the list of a patch

  std::vector<Patch> whole, single, several;  ///< without a list, with one test, with more
  std::vector<std::uint32_t> lists;           ///< numbers of tests

  /// Tiles become patches, and those side by side with the same list one patch. A list holds at most `limit` tests; with 0 all
  /// patches go without a list.
  void make(std::span<const Entry> entries, std::uint32_t columns, std::uint32_t width, std::uint32_t height,
            std::uint32_t limit = most) {
    columns_ = columns;
    width_ = width;
    height_ = height;
    limit_ = limit;
    for (auto* kind : {&whole, &single, &several}) kind->clear();
    lists.clear();
    before_.clear();
    for (std::size_t i = 0; i < entries.size();) {
      const std::size_t first = i;
      bool is_whole = limit == 0;
      for (; i < entries.size() && entries[i].tile == entries[first].tile && entries[i].plane == entries[first].plane; ++i)
        is_whole = is_whole || entries[i].is_whole;
      add(entries.subspan(first, is_whole ? 1 : i - first), is_whole);
    }
    for (const Run& run : before_) end(run);
    before_.clear();
  }

  std::size_t size() const { return whole.size() + single.size() + several.size(); }
  std::size_t bytes() const { return bytes_of(whole, single, several, lists); }

 private:
  /// Tiles side by side that have the same list so far.
  struct Run {
    std::uint32_t first_tile, last_tile, plane, first, count;
  };

  void add(std::span<const Entry> list, bool is_whole) {
    const std::uint32_t tile = list[0].tile, count = is_whole ? 0 : static_cast<std::uint32_t>(list.size());
    // Runs that the tile does not touch are over.
    std::erase_if(before_, [&](const Run& run) {
      const bool is_over = run.last_tile + 1 < tile || (tile % columns_ == 0 && run.last_tile < tile);
      if (is_over) end(run);
      return is_over;
    });
    for (Run& run : before_)
      if (run.last_tile + 1 == tile && run.plane == list[0].plane && run.count == count &&
          std::equal(lists.begin() + run.first, lists.begin() + run.first + count, list.begin(),
                     [](std::uint32_t test, const Entry& entry) { return test == entry.test; })) {
        run.last_tile = tile;
        return;
      }
    before_.push_back({tile, tile, list[0].plane, static_cast<std::uint32_t>(lists.size()), count});
    for (std::uint32_t k = 0; k < count; ++k) lists.push_back(list[k].test);
  }

  void end(const Run& run) {
    const std::uint32_t left = run.first_tile % columns_ * Tiles::side, top = run.first_tile / columns_ * Tiles::side;
    const std::uint32_t right = std::min<std::uint32_t>((run.last_tile % columns_ + 1) * Tiles::side, width_);
    const std::uint32_t bottom = std::min<std::uint32_t>(top + Tiles::side, height_);
    Patch patch{left, top, right, bottom, run.plane, run.first, run.count};
    if (run.count == 0) whole.push_back(patch);
    for (std::uint32_t done = 0; done < run.count; done += patch.count) {
      patch.first = run.first + done;
      patch.count = std::min(run.count - done, limit_);
      (patch.count == 1 ? single : several).push_back(patch);
    }
  }

  std::uint32_t columns_ = 1, width_ = 0, height_ = 0, limit_ = most;
  std::vector<Run> before_;
};

}  // namespace composite_planar
