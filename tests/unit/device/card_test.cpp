// What a card says of itself, read from a library that stands for its maker's.
#include "device/card.h"

#include <gtest/gtest.h>

#include "places.h"

namespace card_test {
using namespace gnomon;

TEST(card, tells_clocks_and_power_of_the_one_that_draws) {
  for (int again = 0; again < 2; ++again) {
    const auto card = card_state("NVIDIA Abacus 10/PCIe/SSE2", fake_card_library().c_str());
    ASSERT_TRUE(card);
    EXPECT_EQ(card->name, "NVIDIA Abacus 10");
    EXPECT_EQ(card->driver, "1.2.3");
    EXPECT_EQ(card->graphics_mhz, 1500);
    EXPECT_EQ(card->memory_mhz, 7000);
    EXPECT_NEAR(card->power_w.value(), 123.456, 1e-9);
    EXPECT_NEAR(card->power_limit_w.value(), 350, 1e-9);
    EXPECT_FALSE(card->celsius);  // a function that the library does not have
  }
}

TEST(card, what_one_does_not_tell_is_missing) {
  const auto card = card_state("NVIDIA Slide Rule", fake_card_library().c_str());
  ASSERT_TRUE(card);
  EXPECT_FALSE(card->graphics_mhz || card->memory_mhz || card->power_w);
  EXPECT_TRUE(card->power_limit_w);
}

TEST(card, of_another_renderer_and_without_a_library_nothing_is_known) {
  EXPECT_FALSE(card_state("llvmpipe (LLVM 15.0.6, 256 bits)", fake_card_library().c_str()));
  EXPECT_FALSE(card_state("NVIDIA Abacus 10", "no_such_library.so.1"));
  EXPECT_FALSE(card_state("NVIDIA Abacus 10", "libm.so.6"));  // a library without its functions
}

}  // namespace card_test
