#include <gnomon/kit/pictures/exposure.h>
#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::exposure_test {

// 100 pixels whose strongest channels are 1 .. 100, and as many that send nothing: the 95th of these is white, what is above it
// is cut off.
TEST(Exposure, makes_white_of_what_95_of_100_lit_pixels_do_not_reach) {
  std::vector<float> rgb(600, 0.0f);
  for (int i = 0; i < 100; ++i) {
    rgb[6 * i + i % 3] = static_cast<float>(i + 1);
    rgb[6 * i + (i + 1) % 3] = 0.5f * static_cast<float>(i + 1);
  }
  EXPECT_FLOAT_EQ(exposure(rgb), 1 / 95.0f);
  const std::vector<float> shown = exposed(rgb);
  EXPECT_FLOAT_EQ(shown[6 * 9], 10 / 95.0f);
  EXPECT_FLOAT_EQ(shown[6 * 9 + 1], 5 / 95.0f);
  EXPECT_EQ(shown[6 * 99], 1.0f);
}

TEST(Exposure, of_darkness_is_one) {
  const std::vector<float> dark(30, 0.0f);
  EXPECT_EQ(exposure(dark), 1);
  EXPECT_EQ(exposed(dark), dark);
  EXPECT_TRUE(std::isfinite(exposure(std::vector<float>(3, 1e-42f))));
}

}  // namespace gnomon::exposure_test
