#include "measure/picture/picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pixels.h"

namespace picture_test {

using namespace pixels;

TEST(picture, shading_is_lambert_with_ambient_in_srgb) {
  // Sun 60 degrees off the normal: N.L = 1/2. sRGB of 1/2 is 188, of 1/4 is 137, of 1/8 is 99 (IEC 61966-2-1 by hand:
  // 1.055 * 0.125^(1/2.4) - 0.055 = 0.38857, times 255 = 99.09).
  Flat flat(4, 1);
  flat.scene.ambient = 0.25f;
  flat.scene.meshes[0].albedo = {1, 0.5f, 0.25f};
  Light sun = hand_made::sun({-std::sqrt(3.0f), -1, 0});
  sun.intensity = 0.5f;
  flat.picture.mesh[3] = no_mesh;
  flat.picture.gbuffer.view.exposure = 1;
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

/// A debug layer of that many black pixels and of `colored`, three floats, in the first one.
Picture draw_black(int width, int height, const DebugLayer& layer, const glm::vec3& colored = glm::vec3(0)) {
  std::vector<float> linear(static_cast<std::size_t>(width) * height * 3);
  for (int c = 0; c < 3; ++c) linear[c] = colored[c];
  return draw_layer(linear, width, height, layer);
}

TEST(debug_layer, is_linear_floats_shown_in_srgb_above_a_strip) {
  // 12.92 * x * 255 near black: 1/4096 is 0.80, that is 1; 1/1024 is 3.2, that is 3. Outside 0 .. 1 is the end of the range.
  const std::vector<float> linear{0, 1, 0.5f, 1.0f / 4096, 1.0f / 1024, 0.25f, -1, 2, 0.125f};
  const DebugLayer layer{"layer", "What it shows.", {{"a color", {0.5, 0.25, 0.125}}}};
  const Picture picture = draw_layer(linear, 3, 1, layer);
  EXPECT_EQ(picture.width, 3);
  EXPECT_GT(picture.height, 1);
  ASSERT_EQ(picture.rgb.size(), static_cast<std::size_t>(3 * 3 * picture.height));
  EXPECT_EQ(std::vector(picture.rgb.begin(), picture.rgb.begin() + 9),
            (std::vector<std::uint8_t>{0, 255, 188, 1, 3, 137, 0, 255, 99}));
}

TEST(debug_layer, the_strip_is_as_high_as_its_lines_and_has_dark_words_on_white) {
  // Ten pixels and twenty for each line.
  constexpr int h = 5;
  EXPECT_EQ(draw_black(640, h, {"layer", "One line."}).height, h + 30);
  std::string sentence = "Many words";
  for (int i = 0; i < 100; ++i) sentence += " and more";
  // 200 words of 3 letters at least, some 20 pixels each: many more lines than the three that are shown.
  const Picture cut = draw_black(640, h, {"layer", sentence + "."});
  EXPECT_EQ(cut.height, h + 70);
  for (int line = 0; line < 3; ++line) EXPECT_LT(darkest(cut, h + 5 + 20 * line, h + 25 + 20 * line), 60) << line;
  EXPECT_EQ(count(cut, {255, 255, 255}, h, h + 5), 5 * 640) << "white above the words";
  // What was cut off leaves no trace but the dots, whatever it was.
  EXPECT_EQ(cut.rgb, draw_black(640, h, {"layer", sentence + " and again."}).rgb);
  EXPECT_NE(draw_black(640, h, {"layer", "One line."}).rgb, draw_black(640, h, {"layer", "One lime."}).rgb);
  // At the margins the strip is white.
  for (int y = h; y < cut.height; ++y)
    for (const int x : {0, 3, 7, 632, 636, 639}) EXPECT_EQ(pixel(cut, x, y), (Rgb{255, 255, 255})) << x << ' ' << y;
}

TEST(debug_layer, swatches_stand_below_the_sentence_in_their_colors) {
  constexpr int h = 4;
  // sRGB of 1/2, 1/4, 1/8 is 188, 137, 99.
  DebugLayer layer{"layer", "A sentence.", {{"first", {0.5, 0.25, 0.125}}, {"second", {0, 1, 0.5}}}};
  for (const int width : {640, 100}) {
    const Picture picture = draw_black(width, h, layer, {0.5, 0.25, 0.125});
    // The two are side by side or, where the width is for one, below each other.
    EXPECT_EQ(picture.height, h + (width == 640 ? 50 : 70));
    EXPECT_EQ(count(picture, {188, 137, 99}, 0, h), 1) << "the pixel of the layer";
    EXPECT_EQ(count(picture, {0, 0, 0}, 0, h), h * width - 1) << "the others";
    EXPECT_EQ(count(picture, {188, 137, 99}, h, h + 25), 0) << "beside the sentence";
    EXPECT_EQ(count(picture, {188, 137, 99}, h + 25, picture.height), 12 * 12);
    EXPECT_EQ(count(picture, {0, 255, 188}, h + 25, picture.height), 12 * 12);
  }
  // Narrower than anything in it.
  const Picture narrow = draw_black(3, h, layer);
  EXPECT_EQ(narrow.rgb.size(), static_cast<std::size_t>(3 * 3 * narrow.height));
}

TEST(picture, a_mask_is_gray_and_black_in_shadow) {
  const std::vector<float> mask{0, 1, 0.5f, 0.2f};
  const Picture picture = draw_mask(mask, 2, 2);
  EXPECT_EQ(pixel(picture, 0, 0), (Rgb{0, 0, 0}));
  EXPECT_EQ(pixel(picture, 1, 0), (Rgb{255, 255, 255}));
  EXPECT_EQ(pixel(picture, 0, 1), (Rgb{128, 128, 128}));
  EXPECT_EQ(pixel(picture, 1, 1), (Rgb{51, 51, 51}));
}

}  // namespace picture_test
