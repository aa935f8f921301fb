#include "measure/picture.h"

#include <OpenImageIO/imageio.h>
#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "hand_made.h"
#include "measure/blob.h"

namespace {

using namespace gnomon;
namespace fs = std::filesystem;
using Rgb = std::array<int, 3>;

struct Folder {
  fs::path path = fs::temp_directory_path() / fmt::format("gnomon_picture_{}", getpid());
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

Rgb pixel(const Picture& picture, int x, int y) {
  const std::uint8_t* rgb = &picture.rgb[3 * (static_cast<std::size_t>(y) * picture.width + x)];
  return {rgb[0], rgb[1], rgb[2]};
}

/// A square seen from above, one receiver point per pixel, all turned up.
struct Flat {
  Scene scene;
  hand_made::Picture picture;
  Flat(int width, int height) : picture(width, height) {
    scene.meshes = {hand_made::square(5, 0)};
    for (std::size_t i = 0; i < picture.mesh.size(); ++i) picture.set(i, {0, 0, 0}, {0, 1, 0}, 0, 0);
  }
};

TEST(picture, shading_is_lambert_with_ambient_in_srgb) {
  // Sun 60 degrees off the normal: N.L = 1/2. sRGB of 1/2 is 188, of 1/4 is 137, of 1/8 is 99 (IEC 61966-2-1 by hand:
  // 1.055 * 0.125^(1/2.4) - 0.055 = 0.38857, times 255 = 99.09).
  Flat flat(4, 1);
  flat.scene.ambient = 0.25f;
  flat.scene.meshes[0].albedo = {1, 0.5f, 0.25f};
  Light sun = hand_made::sun({-std::sqrt(3.0f), -1, 0});
  sun.intensity = 0.5f;
  flat.picture.mesh[3] = no_mesh;
  const std::vector<float> visibility{1, 0, 0.5f, 1};
  const Picture shaded = shade(flat.scene, flat.picture.gbuffer, sun, visibility);
  EXPECT_EQ(pixel(shaded, 1, 0), (Rgb{137, 99, 71}));  // ambient alone: 1/4, 1/8, 1/16
  const Rgb lit = pixel(shaded, 0, 0);                 // 1/4 + 1/2 * 1/2 = 1/2; the float sine moves it less than one step
  EXPECT_NEAR(lit[0], 188, 1);
  EXPECT_NEAR(lit[1], 137, 1);
  EXPECT_NEAR(lit[2], 99, 1);
  const Rgb half = pixel(shaded, 2, 0);  // 3/8: 1.055 * 0.375^(1/2.4) - 0.055 = 0.64607
  EXPECT_NEAR(half[0], 165, 1);
  EXPECT_EQ(pixel(shaded, 3, 0), (Rgb{24, 26, 30})) << "background";
}

TEST(picture, debug_layers_are_linear_floats_shown_in_srgb) {
  // 12.92 * x * 255 near black: 1/4096 is 0.80, that is 1; 1/1024 is 3.2, that is 3. Outside 0 .. 1 is the end of the range.
  const Folder folder;
  const std::vector<float> linear{0, 1, 0.5f, 1.0f / 4096, 1.0f / 1024, 0.25f, -1, 2, 0.125f};
  write_file(folder.path / "layer", std::as_bytes(std::span(linear)));
  EXPECT_EQ(draw_layer(folder.path / "layer", 3, 1).rgb, (std::vector<std::uint8_t>{0, 255, 188, 1, 3, 137, 0, 255, 99}));
  EXPECT_THROW(draw_layer(folder.path / "layer", 2, 1), Error);
}

TEST(picture, a_mask_is_gray_and_black_in_shadow) {
  const std::vector<float> mask{0, 1, 0.5f, 0.2f};
  const Picture picture = draw_mask(mask, 2, 2);
  EXPECT_EQ(pixel(picture, 0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(picture, 1, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(picture, 0, 1), (Rgb{128, 128, 128}));
  EXPECT_EQ(pixel(picture, 1, 1), (Rgb{51, 51, 51}));
}

const Rgb dark_color{213, 94, 0}, lit_color{86, 180, 233}, beyond_color{204, 121, 167};

/// Counts the pixels of a color in the rows from `first` up to `last`.
int count(const Picture& picture, const Rgb& color, int first, int last) {
  int found = 0;
  for (int y = first; y < last; ++y)
    for (int x = 0; x < picture.width; ++x) found += pixel(picture, x, y) == color;
  return found;
}

TEST(error_picture, exactly_the_wrong_pixels_have_the_color_of_their_kind) {
  constexpr int w = 420, h = 40;
  Flat flat(w, h);
  std::mt19937 random(1);
  std::vector<Verdict> verdicts(w * h);
  for (Verdict& v : verdicts) v = static_cast<Verdict>(random() % 5);
  Tally tally;
  tally.tested = w * h;
  const Picture picture = draw_errors(flat.scene, flat.picture.gbuffer, hand_made::sun({0, -1, 0}), verdicts, tally, "title");
  EXPECT_EQ(picture.width, w);
  ASSERT_GT(picture.height, h) << "a legend below";
  Rgb untested{-1, -1, -1}, right{-1, -1, -1};
  for (int i = 0; i < w * h; ++i) {
    const Rgb color = pixel(picture, i % w, i / w);
    if (verdicts[i] == Verdict::false_dark) {
      ASSERT_EQ(color, dark_color);
    }
    if (verdicts[i] == Verdict::false_lit) {
      ASSERT_EQ(color, lit_color);
    }
    if (verdicts[i] == Verdict::beyond_coverage) {
      ASSERT_EQ(color, beyond_color);
    }
    if (verdicts[i] == Verdict::untested) untested = color;
    if (verdicts[i] == Verdict::right) right = color;
    // The rest is gray, so that no error hides in it.
    if (verdicts[i] < Verdict::false_dark) {
      ASSERT_TRUE(color[0] == color[1] && color[1] == color[2]);
    }
  }
  EXPECT_LT(untested[0], right[0]) << "untested pixels are darker";
  // The legend has one swatch of each kind, and something written in dark ink.
  EXPECT_GT(count(picture, dark_color, h, picture.height), 100);
  EXPECT_GT(count(picture, lit_color, h, picture.height), 100);
  EXPECT_GT(count(picture, beyond_color, h, picture.height), 100);
}

TEST(error_picture, a_kind_that_does_not_occur_shows_0_and_beyond_coverage_no_swatch) {
  constexpr int w = 420, h = 8;
  Flat flat(w, h);
  std::vector<Verdict> verdicts(w * h, Verdict::right);
  Tally tally;
  tally.tested = w * h;
  const auto draw = [&] {
    return draw_errors(flat.scene, flat.picture.gbuffer, hand_made::sun({0, -1, 0}), verdicts, tally, "");
  };
  const Picture none = draw();
  EXPECT_EQ(count(none, beyond_color, 0, none.height), 0);
  EXPECT_GT(count(none, dark_color, h, none.height), 100);
  // Dark and not covered: it is no false lit pixel, so that share stays 0 and its words stay the same. The swatches of the
  // first two kinds and what is written beside them lie in the same columns as before.
  verdicts[0] = Verdict::beyond_coverage;
  tally.wrong = tally.false_dark = tally.beyond_coverage = 1;
  const Picture one = draw();
  int third = w;
  for (int x = w - 1; x >= 0; --x)
    if (pixel(one, x, h + 12) == beyond_color) third = x;
  ASSERT_LT(third, w);
  for (int y = h; y < one.height; ++y)
    for (int x = 0; x < third; ++x) ASSERT_EQ(pixel(one, x, y), pixel(none, x, y)) << x << ' ' << y;
}

TEST(error_picture, a_picture_narrower_than_its_legend_is_drawn) {
  Flat flat(3, 2);
  const std::vector<Verdict> verdicts(6, Verdict::false_lit);
  Tally tally;
  tally.tested = tally.wrong = tally.false_lit = 6;
  const Picture picture = draw_errors(flat.scene, flat.picture.gbuffer, hand_made::sun({0, -1, 0}), verdicts, tally, "a title");
  EXPECT_EQ(count(picture, lit_color, 0, 2), 6);
  EXPECT_EQ(picture.rgb.size(), static_cast<std::size_t>(3 * 3 * picture.height));
}

TEST(picture_file, png_comes_back_bit_for_bit) {
  const Folder folder;
  std::mt19937 random(2);
  Picture picture{31, 17, std::vector<std::uint8_t>(31 * 17 * 3)};
  for (std::uint8_t& byte : picture.rgb) byte = static_cast<std::uint8_t>(random());
  write_png(folder.path / "made/here.png", picture);
  const auto input = OIIO::ImageInput::open((folder.path / "made/here.png").string());
  ASSERT_TRUE(input);
  ASSERT_EQ(std::tuple(input->spec().width, input->spec().height, input->spec().nchannels), std::tuple(31, 17, 3));
  std::vector<std::uint8_t> back(picture.rgb.size());
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, back.data()));
  EXPECT_EQ(back, picture.rgb);
  EXPECT_EQ(folder.file_count(), 1u);
}

TEST(picture_file, exr_channels_come_back_bit_for_bit_under_their_names) {
  // Also values that half floats cannot hold: 1/3, 1e-30, 1 - 2^-24.
  const Folder folder;
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
  const fs::path file = folder.path / "mask.exr";
  write_exr(file, 23, 9, names, channels);
  EXPECT_EQ(read_exr(file, "zeta.V", 23, 9), first);
  EXPECT_EQ(read_exr(file, "alpha.V", 23, 9), second);
  EXPECT_THROW(read_exr(file, "beta.V", 23, 9), Error);
  EXPECT_THROW(read_exr(file, "zeta.V", 9, 23), Error);
  EXPECT_THROW(read_exr(folder.path / "none.exr", "zeta.V", 23, 9), Error);
}

TEST(picture_file, what_cannot_be_written_is_an_error_that_leaves_nothing) {
  const Folder folder;
  const Picture picture{2, 2, std::vector<std::uint8_t>(12)};
  std::ofstream(folder.path / "plain") << "a file, not a folder";
  EXPECT_THROW(write_png(folder.path / "plain/x.png", picture), Error);
  fs::create_directories(folder.path / "taken.png/inside");
  EXPECT_THROW(write_png(folder.path / "taken.png", picture), Error);
  EXPECT_THROW(write_png("/dev/null/x.png", picture), Error);
  EXPECT_EQ(folder.file_count(), 2u) << "the plain file and the folder that was in the way";
}

}  // namespace
