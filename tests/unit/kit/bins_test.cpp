// Items sorted into bins, in rising order whatever the blocks.
#include <gnomon/kit/bins.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace gnomon::bins_test {

// Item i lies in the bins of its divisors among 1 .. 6, so bin d - 1 holds the multiples of d.
TEST(Bins, items_of_several_bins_are_in_rising_order) {
  const auto for_bins = [](std::size_t i, auto&& visit) {
    for (std::size_t d = 1; d <= 6; ++d)
      if (i % d == 0) visit(d - 1);
  };
  for (const std::size_t block : {1, 7, 1000}) {
    Bins bins, at_once;
    sort_into_bins(500, block, 6, bins, for_bins);
    sort_into_bins_at_once(500, block, 6, at_once, for_bins);
    for (std::size_t d = 1; d <= 6; ++d) {
      const std::span<const std::uint32_t> multiples = bins.of(d - 1);
      ASSERT_EQ(multiples.size(), (499 / d) + 1);
      for (std::size_t k = 0; k < multiples.size(); ++k) EXPECT_EQ(multiples[k], k * d);
      EXPECT_TRUE(std::ranges::equal(multiples, at_once.of(d - 1)));
    }
  }
}

TEST(Bins, no_items) {
  Bins bins;
  sort_into_bins(0, 16, 3, bins, [](std::size_t, auto&&) {});
  for (std::size_t bin = 0; bin < 3; ++bin) EXPECT_TRUE(bins.of(bin).empty());
}

}  // namespace gnomon::bins_test
