#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/parallel.h>

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon {

/// Items sorted into bins; an item may lie in several. Those of a bin are in rising order.
struct Bins {
  std::vector<std::uint32_t> items;
  std::vector<std::uint32_t> begin;   ///< of each bin, in items; one more ends the last
  std::vector<std::uint32_t> counts;  ///< scratch: of each block and bin

  std::span<const std::uint32_t> of(std::size_t bin) const { return {items.data() + begin[bin], begin[bin + 1] - begin[bin]}; }
  std::size_t bytes() const { return bytes_of(items, begin, counts); }

  /// Makes room, once `counts` are complete; these become the places of the next items.
  void lay_out(std::size_t blocks, std::size_t bin_count) {
    begin.resize(bin_count + 1);
    std::uint32_t sum = 0;
    for (std::size_t bin = 0; bin < bin_count; ++bin) {
      begin[bin] = sum;
      for (std::size_t k = 0; k < blocks; ++k) {
        const std::uint32_t count = counts[k * bin_count + bin];
        counts[k * bin_count + bin] = sum;
        sum += count;
      }
    }
    begin[bin_count] = sum;
    if (items.capacity() < sum) items = std::vector<std::uint32_t>(sum);  // growth would hold twice of it
    items.resize(sum);
  }
};

/// for_bins(item, visit) calls visit(bin) for each bin of an item, and does so twice: to count and to sort. On all threads, in
/// blocks of items; the outcome is the same on any number of them.
template <class ForBins>
void sort_into_bins(std::size_t item_count, std::size_t block, std::size_t bin_count, Bins& bins, ForBins&& for_bins) {
  const std::size_t blocks = (item_count + block - 1) / block;
  bins.counts.assign(blocks * bin_count, 0);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const counts = bins.counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i) for_bins(i, [&](std::size_t bin) { ++counts[bin]; });
  });
  bins.lay_out(blocks, bin_count);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const next = bins.counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i)
      for_bins(i, [&](std::size_t bin) { bins.items[next[bin]++] = static_cast<std::uint32_t>(i); });
  });
}

/// The same for a for_bins that is too much work to be called twice: it is called once, and what it says is kept until then.
template <class ForBins>
void sort_into_bins_at_once(std::size_t item_count, std::size_t block, std::size_t bin_count, Bins& bins, ForBins&& for_bins) {
  const std::size_t blocks = (item_count + block - 1) / block;
  struct Visit {
    std::uint32_t bin, item;
  };
  std::vector<std::vector<Visit>> visits(blocks);
  bins.counts.assign(blocks * bin_count, 0);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const counts = bins.counts.data() + begin / block * bin_count;
    std::vector<Visit>& mine = visits[begin / block];
    mine.reserve(2 * (end - begin));
    for (std::size_t i = begin; i < end; ++i)
      for_bins(i, [&](std::size_t bin) {
        ++counts[bin];
        mine.push_back({static_cast<std::uint32_t>(bin), static_cast<std::uint32_t>(i)});
      });
  });
  bins.lay_out(blocks, bin_count);
  for_blocks(blocks, 1, [&](std::size_t b, std::size_t) {
    std::uint32_t* const next = bins.counts.data() + b * bin_count;
    for (const Visit& visit : visits[b]) bins.items[next[visit.bin]++] = visit.item;
  });
}

}  // namespace gnomon
