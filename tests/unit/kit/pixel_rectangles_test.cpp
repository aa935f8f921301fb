#include "kit/gl/pixel_rectangles.h"

#include <gtest/gtest.h>

#include <random>

namespace pixel_rectangles_test {
using namespace gnomon;

/// How many rectangles hold each pixel.
std::vector<int> cover(const std::vector<PixelRectangle>& rectangles, int width, int height) {
  std::vector<int> cover(static_cast<std::size_t>(width) * height);
  for (const PixelRectangle& r : rectangles) {
    EXPECT_TRUE(0 <= r.left && r.left < r.right && r.right <= width && 0 <= r.top && r.top < r.bottom && r.bottom <= height);
    for (int y = r.top; y < r.bottom; ++y)
      for (int x = r.left; x < r.right; ++x) ++cover[static_cast<std::size_t>(y) * width + x];
  }
  return cover;
}

TEST(pixel_rectangles, hold_every_wanted_pixel_and_none_twice) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    const int width = std::uniform_int_distribution(1, 90)(random), height = std::uniform_int_distribution(1, 90)(random);
    const double share = std::uniform_real_distribution(0.0, round % 2 ? 0.01 : 1.0)(random);
    std::vector<bool> wanted(static_cast<std::size_t>(width) * height);
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = std::bernoulli_distribution(share)(random);
    const auto rectangles = rectangles_around(width, height, [&](std::size_t i) { return wanted[i]; });
    const std::vector<int> held = cover(rectangles, width, height);
    const PixelRectangle all = around(rectangles);
    for (std::size_t i = 0; i < held.size(); ++i) {
      ASSERT_LE(held[i], 1);
      ASSERT_GE(held[i], int(wanted[i]));
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      if (held[i]) {
        ASSERT_TRUE(all.left <= x && x < all.right && all.top <= y && y < all.bottom);
      }
    }
  }
}

TEST(pixel_rectangles, of_a_full_picture_are_the_picture_and_of_an_empty_one_none) {
  EXPECT_EQ(rectangles_around(640, 360, [](std::size_t) { return true; }), (std::vector<PixelRectangle>{{0, 0, 640, 360}}));
  EXPECT_TRUE(rectangles_around(640, 360, [](std::size_t) { return false; }).empty());
  EXPECT_EQ(around({}), PixelRectangle());
}

// A sky above row 208, which begins a strip: the least area is that below.
TEST(pixel_rectangles, leave_out_the_sky) {
  EXPECT_EQ(rectangles_around(640, 360, [](std::size_t i) { return i / 640 >= 208; }),
            (std::vector<PixelRectangle>{{0, 208, 640, 360}}));
}

// Two small spots: one rectangle around both would have 600 x 300 pixels, two have 200 and the price of a draw more.
TEST(pixel_rectangles, are_apart_where_a_draw_costs_less_than_what_lies_between) {
  const auto rectangles = rectangles_around(640, 360, [](std::size_t i) {
    const auto x = i % 640, y = i / 640;
    return (x < 10 && y < 10) || (x >= 600 && x < 610 && y >= 300 && y < 310);
  });
  EXPECT_EQ(rectangles.size(), 2u);
}

}  // namespace pixel_rectangles_test
