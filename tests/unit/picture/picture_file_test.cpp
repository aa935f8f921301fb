#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>

#include "measure/picture/picture.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace picture_file_test {

using namespace gnomon;
namespace fs = std::filesystem;

std::size_t file_count(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(picture_file, png_comes_back_bit_for_bit) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_picture");
  std::mt19937 random(2);
  Picture picture{31, 17, std::vector<std::uint8_t>(31 * 17 * 3)};
  for (std::uint8_t& byte : picture.rgb) byte = static_cast<std::uint8_t>(random());
  write_png(folder.path() / "made/here.png", picture);
  const std::vector<std::string> channels = image_files().exr_channels(folder.path() / "made/here.png");
  ASSERT_EQ(channels, (std::vector<std::string>{"R", "G", "B"}));
  std::vector<std::uint8_t> back(picture.rgb.size());
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float> values = read_exr(folder.path() / "made/here.png", channels[c], 31, 17);  // of any format
    for (std::size_t i = 0; i < values.size(); ++i) back[3 * i + c] = static_cast<std::uint8_t>(std::lround(255 * values[i]));
  }
  EXPECT_EQ(back, picture.rgb);
  EXPECT_EQ(file_count(folder.path()), 1u);
}

TEST(picture_file, exr_channels_come_back_bit_for_bit_under_their_names) {
  // Also values that half floats cannot hold: 1/3, 1e-30, 1 - 2^-24.
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_picture");
  std::mt19937 random(3);
  std::vector<float> first(23 * 9), second(23 * 9);
  for (float& v : first) v = static_cast<float>(random()) * 0x1p-32f;
  for (float& v : second) v = static_cast<float>(random() % 2);
  second[0] = 1.0f / 3;
  second[1] = 1e-30f;
  second[2] = 1 - 0x1p-24f;
  // In an EXR channels lie in the order of their names; "zeta" was written first.
  const std::vector<std::string> names{"zeta.V", "alpha.V"};
  const std::vector<std::span<const float>> channels{first, second};
  const fs::path file = folder.path() / "mask.exr";
  write_exr(file, 23, 9, names, channels);
  EXPECT_EQ(read_exr(file, "zeta.V", 23, 9), first);
  EXPECT_EQ(read_exr(file, "alpha.V", 23, 9), second);
  EXPECT_THROW(read_exr(file, "beta.V", 23, 9), Error);
  EXPECT_THROW(read_exr(file, "zeta.V", 9, 23), Error);
  EXPECT_THROW(read_exr(folder.path() / "none.exr", "zeta.V", 23, 9), Error);
}

TEST(picture_file, what_cannot_be_written_is_an_error_that_leaves_nothing) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_picture");
  const Picture picture{2, 2, std::vector<std::uint8_t>(12)};
  std::ofstream(folder.path() / "plain") << "a file, not a folder";
  EXPECT_THROW(write_png(folder.path() / "plain/x.png", picture), Error);
  fs::create_directories(folder.path() / "taken.png/inside");
  EXPECT_THROW(write_png(folder.path() / "taken.png", picture), Error);
  EXPECT_THROW(write_png("/dev/null/x.png", picture), Error);
  EXPECT_EQ(file_count(folder.path()), 2u) << "the plain file and the folder that was in the way";
}

}  // namespace picture_file_test
