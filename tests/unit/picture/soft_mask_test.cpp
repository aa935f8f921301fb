#include <gnomon/error.h>
#include <gtest/gtest.h>

#include "measure/picture/legend.h"
#include "measure/scratch_folder.h"

namespace soft_mask_test {

using namespace gnomon;

constexpr int width = 480, height = 3;

/// Visibilities from 0 to 1 along a row.
std::vector<float> ramp() {
  std::vector<float> mask(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = static_cast<float>(i % width) / (width - 1);
  return mask;
}

std::uint8_t red(const Picture& picture, int x, int y) {
  return picture.rgb[3 * (static_cast<std::size_t>(y) * picture.width + x)];
}

TEST(soft_mask, is_the_mask_above_a_bar_from_black_to_white) {
  const std::vector<float> mask = ramp();
  const Picture plain = draw_mask(mask, width, height), soft = draw_soft_mask(mask, width, height);
  EXPECT_EQ(plain.legend_height, 0);
  EXPECT_EQ(soft.height, height + soft.legend_height);
  EXPECT_EQ(soft.width, width);
  EXPECT_TRUE(std::equal(plain.rgb.begin(), plain.rgb.end(), soft.rgb.begin())) << "the mask is what it was";
  EXPECT_EQ(red(soft, 100, height), 150) << "a line ends the picture";
  // Some row of the legend runs through every gray that a bar of 198 pixels within its frame has room for, in order.
  int longest = 0;
  for (int y = height + 1; y < soft.height; ++y) {
    int length = 1;
    for (int x = 1; x < width; ++x) {
      const int step = red(soft, x, y) - red(soft, x - 1, y);
      length = step == 1 || step == 2 ? length + 1 : 1;
      longest = std::max(longest, length);
    }
  }
  EXPECT_GE(longest, 198);
}

TEST(soft_mask, has_its_legend_in_narrow_pictures) {
  for (const int narrow : {1, 40, 100, 160}) {
    const std::vector<float> mask(static_cast<std::size_t>(narrow) * 2, 0.5f);
    const Picture soft = draw_soft_mask(mask, narrow, 2);
    EXPECT_EQ(soft.rgb.size(), static_cast<std::size_t>(3) * narrow * soft.height);
    EXPECT_GE(soft.legend_height, 30);
  }
}

TEST(soft_mask, a_file_with_a_legend_says_so_and_is_no_mask) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_picture");
  const std::vector<float> mask = ramp();
  write_png(folder.path() / "plain.png", draw_mask(mask, width, height));
  EXPECT_EQ(image_files().exr_size(folder.path() / "plain.png"), std::pair(width, height));
  const Picture soft = draw_soft_mask(mask, width, height);
  write_png(folder.path() / "soft.png", soft);
  try {
    image_files().exr_size(folder.path() / "soft.png");
    FAIL() << "a legend is taken for pixels of the mask";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("soft.png is a picture with a legend of " + std::to_string(soft.legend_height)),
              std::string::npos)
        << error.what();
  }
}

}  // namespace soft_mask_test
