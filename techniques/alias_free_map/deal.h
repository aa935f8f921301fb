#pragma once
#include <gnomon/kit/parallel.h>

#include <cstdint>
#include <vector>

namespace gnomon::alias_free_map {

/// Items dealt to bins: what bin b holds is items[begin[b]] .. items[begin[b + 1]], in rising order.
struct Dealt {
  std::vector<std::uint32_t> begin, items;
  std::vector<std::uint32_t> counts;  ///< scratch: of each block and bin
  std::size_t bytes() const { return (begin.capacity() + items.capacity() + counts.capacity()) * sizeof(std::uint32_t); }
};

/// for_bins(item, visit) calls visit(bin) for each bin of an item, and does so twice: to count and to deal. On all threads; the
/// outcome is the same on any number of them.
template <class ForBins>
void deal(std::size_t item_count, std::size_t block, std::size_t bin_count, Dealt& out, ForBins&& for_bins) {
  const std::size_t blocks = (item_count + block - 1) / block;
  out.counts.assign(blocks * bin_count, 0);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const counts = out.counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i) for_bins(i, [&](std::size_t bin) { ++counts[bin]; });
  });
  out.begin.resize(bin_count + 1);
  std::uint32_t sum = 0;
  for (std::size_t bin = 0; bin < bin_count; ++bin) {
    out.begin[bin] = sum;
    for (std::size_t k = 0; k < blocks; ++k) {
      const std::uint32_t count = out.counts[k * bin_count + bin];
      out.counts[k * bin_count + bin] = sum;
      sum += count;
    }
  }
  out.begin[bin_count] = sum;
  if (out.items.capacity() < sum) out.items = std::vector<std::uint32_t>(sum);  // to measure: growth would hold twice of it
  out.items.resize(sum);
  for_blocks(item_count, block, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const next = out.counts.data() + begin / block * bin_count;
    for (std::size_t i = begin; i < end; ++i)
      for_bins(i, [&](std::size_t bin) { out.items[next[bin]++] = static_cast<std::uint32_t>(i); });
  });
}

}  // namespace gnomon::alias_free_map
