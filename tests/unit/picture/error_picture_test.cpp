#include "measure/score/error_picture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "measure/cause/own_causes.h"
#include "pixels.h"

namespace error_picture_test {

using namespace pixels;

Rgb color_of(Cause cause) {
  const auto& rgb = cause_infos()[static_cast<std::size_t>(cause) - 1].color;
  return {rgb[0], rgb[1], rgb[2]};
}

/// A scored mask over the flat square under a vertical sun; all is tested, lit and right until told otherwise.
struct Scored : Flat {
  std::vector<PixelClass> classes;
  std::vector<float> reference, mask;
  std::vector<Cause> causes;
  std::vector<CauseInfo> own_causes;
  Light light = hand_made::sun({0, -1, 0});
  Scored(int width, int height)
      : Flat(width, height),
        classes(picture.mesh.size(), PixelClass::T),
        reference(picture.mesh.size(), 1.0f),
        mask(reference),
        causes(picture.mesh.size(), Cause::none) {}
  void err(std::size_t i, Cause cause) {
    mask[i] = 1 - reference[i];
    causes[i] = cause;
  }
  Picture draw(const std::string& title = "") const {
    const GBuffer& g = picture.gbuffer;
    Evidence evidence{g.width, g.height, classes, reference, mask, causes, &scene, &g, &light, nullptr};
    evidence.own_causes = own_causes;
    evidence.kind = answer_kind(scene, light);
    return draw_errors(evidence, title);
  }
};

TEST(error_picture, exactly_the_wrong_tested_pixels_have_the_color_of_their_cause) {
  constexpr int w = 420, h = 40;
  Scored scored(w, h);
  scored.own_causes = {{own_cause(0), "off_screen", "What casts the shadow is out of the picture.", {252, 0, 132}}};
  const std::vector<CauseInfo> infos = with_common(scored.own_causes);
  const auto color_in = [&](Cause cause) {
    const auto& c = infos[static_cast<std::size_t>(cause) - 1].color;
    return Rgb{c[0], c[1], c[2]};
  };
  std::mt19937 random(1);
  for (std::size_t i = 0; i < scored.mask.size(); ++i) {
    scored.classes[i] = random() % 3 == 0 ? PixelClass::U : PixelClass::T;
    scored.reference[i] = scored.mask[i] = static_cast<float>(random() % 2);
    if (random() % 2 == 0)
      scored.err(i, scored.classes[i] == PixelClass::T ? static_cast<Cause>(1 + random() % infos.size()) : Cause::none);
  }
  const Picture picture = scored.draw("title");
  EXPECT_EQ(picture.width, w);
  ASSERT_GT(picture.height, h) << "a legend below";
  Rgb untested{-1, -1, -1}, right{-1, -1, -1};
  for (int i = 0; i < w * h; ++i) {
    const Rgb color = pixel(picture, i % w, i / w);
    if (scored.causes[i] != Cause::none) {
      ASSERT_EQ(color, color_in(scored.causes[i]));
      continue;
    }
    // The rest is gray, so that no error hides in it.
    ASSERT_TRUE(color[0] == color[1] && color[1] == color[2]);
    (scored.classes[i] == PixelClass::T ? right : untested) = color;
  }
  EXPECT_LT(untested[0], right[0]) << "untested pixels are darker";
  for (const CauseInfo& info : infos) {
    if (info.cause == Cause::unexplained) continue;  // white, as the paper around its frame
    EXPECT_EQ(count(picture, color_in(info.cause), h, picture.height), 12 * 12) << info.name << ": one swatch";
  }
}

TEST(error_picture, under_a_light_with_area_colors_are_as_strong_as_errors_are_large) {
  constexpr int w = 420, h = 1;
  Scored scored(w, h);
  scored.light.kind = DiscLight{.center = {0, 4, 0}, .normal = {0, -1, 0}, .radius = 1};
  scored.causes.clear();
  // Off by less than 1 %, then by the steps, both ways; the last one is not tested.
  const std::vector<float> off{-0.009f, 0.009f, -0.011f, -0.04f, -0.2f, -0.31f, 0.011f, 0.04f, 0.2f, 0.31f, 0.5f};
  for (std::size_t i = 0; i < off.size(); ++i) {
    scored.reference[i] = 0.5f;
    scored.mask[i] = 0.5f + off[i];
  }
  scored.classes[10] = PixelClass::U;
  const Picture picture = scored.draw("title");
  const Rgb right = pixel(picture, 20, 0), dark = color_of(Cause::acne), light = color_of(Cause::peter_panning);
  EXPECT_EQ(pixel(picture, 0, 0), right);
  EXPECT_EQ(pixel(picture, 1, 0), right);
  const double weights[] = {0.3, 0.5, 0.75, 1};
  for (int k = 0; k < 4; ++k)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(pixel(picture, 2 + k, 0)[c], right[c] + weights[k] * (dark[c] - right[c]), 0.51) << k;
      EXPECT_NEAR(pixel(picture, 6 + k, 0)[c], right[c] + weights[k] * (light[c] - right[c]), 0.51) << k;
    }
  EXPECT_LT(pixel(picture, 10, 0)[0], right[0]) << "not tested";
  EXPECT_EQ(count(picture, dark, h, picture.height), 2 * 12 * 12) << "the swatches of what is too dark, and of 30 % or more";
  EXPECT_EQ(count(picture, light, h, picture.height), 12 * 12) << "of what is too light";
  // With causes the color is the cause's; a pixel without one keeps its gray.
  scored.causes.assign(scored.mask.size(), Cause::none);
  scored.causes[5] = scored.causes[2] = Cause::crack;
  const Picture caused = scored.draw();
  EXPECT_EQ(pixel(caused, 5, 0), color_of(Cause::crack));
  EXPECT_NEAR(pixel(caused, 2, 0)[0], right[0] + 0.3 * (color_of(Cause::crack)[0] - right[0]), 0.51);
  EXPECT_EQ(pixel(caused, 9, 0), right);
}

TEST(error_picture, the_legend_names_the_causes_that_occur_and_breaks_into_lines) {
  constexpr int h = 8;
  const auto drawn = [&](int width, int cause_count) {
    Scored scored(width, h);
    for (int k = 0; k < cause_count; ++k) scored.err(k, static_cast<Cause>(1 + k));
    return scored.draw("a title");
  };
  for (int present = 0; present < static_cast<int>(cause_infos().size()); ++present) {
    const Picture picture = drawn(640, present);
    for (int k = 0; k < 14; ++k)
      EXPECT_EQ(count(picture, color_of(static_cast<Cause>(1 + k)), h, picture.height), k < present ? 144 : 0)
          << present << ' ' << k;
  }
  // Wide enough, all fits one line; narrower, the picture grows by a line height at a time, and no swatch is lost at the edge.
  const int one_line = drawn(4000, 14).height;
  EXPECT_EQ(drawn(640, 0).height, one_line);
  EXPECT_EQ(drawn(640, 2).height, one_line);
  int last = one_line;
  for (const int width : {2000, 1000, 640, 420, 250}) {
    const Picture picture = drawn(width, 14);
    EXPECT_GE(picture.height, last);
    EXPECT_EQ((picture.height - one_line) % 20, 0);
    last = picture.height;
    for (int k = 0; k < 14; ++k)
      EXPECT_EQ(count(picture, color_of(static_cast<Cause>(1 + k)), h, picture.height), 144) << width << ' ' << k;
  }
  EXPECT_GE(last, one_line + 6 * 20);
}

/// The leftmost column of rows from `top` on that has the color; the width where none has it.
int first_column(const Picture& picture, const Rgb& color, int top) {
  for (int x = 0; x < picture.width; ++x)
    for (int y = top; y < picture.height; ++y)
      if (pixel(picture, x, y) == color) return x;
  return picture.width;
}

TEST(error_picture, the_legend_has_the_largest_share_first) {
  constexpr int w = 2000, h = 2;  // all swatches in one line
  Scored scored(w, h);
  auto err = [&, next = 0](Cause cause, int times) mutable {
    for (int k = 0; k < times; ++k) scored.err(next++, cause);
  };
  // Equal ones stay in the order of the causes: acne before crack.
  err(Cause::tessellation, 1);
  err(Cause::crack, 2);
  err(Cause::acne, 2);
  err(Cause::region, 4);
  const auto order = [&] {
    const Picture picture = scored.draw();
    std::vector<int> columns;
    for (const Cause cause : {Cause::region, Cause::acne, Cause::crack, Cause::tessellation})
      columns.push_back(first_column(picture, color_of(cause), h));
    return columns;
  };
  const std::vector<int> hard = order();
  EXPECT_TRUE(std::ranges::is_sorted(hard));
  EXPECT_LT(hard.back(), w);
  // Under a light with area by their parts of the error: the crack's two pixels are off by less than the one of tessellation.
  scored.light.kind = DiscLight{.center = {0, 4, 0}, .normal = {0, -1, 0}, .radius = 1};
  for (std::size_t i = 0; i < scored.mask.size(); ++i)
    if (scored.causes[i] == Cause::crack) scored.mask[i] = scored.reference[i] - 0.25f;
  const std::vector<int> soft = order();
  EXPECT_LT(soft[0], soft[1]);
  EXPECT_LT(soft[1], soft[3]);
  EXPECT_LT(soft[3], soft[2]);
}

TEST(error_picture, the_white_swatch_of_what_is_unexplained_is_seen_on_white) {
  constexpr int h = 1;
  Scored scored(420, h);
  scored.err(7, Cause::unexplained);
  const Picture picture = scored.draw();
  const Rgb frame{110, 110, 110};
  const int left = first_column(picture, frame, h);
  int y = h;
  while (pixel(picture, left, y) != frame) ++y;
  // 12 x 12 pixels within a frame of one pixel; letters have its gray, too.
  int framing = 0;
  for (int k = 0; k < 14 * 14; ++k) framing += pixel(picture, left + k % 14, y + k / 14) == frame;
  EXPECT_EQ(framing, 4 * 13);
  for (int k = 1; k <= 12; ++k) EXPECT_EQ(pixel(picture, left + k, y + k), color_of(Cause::unexplained));
  EXPECT_EQ(pixel(picture, left + 13, y + 13), frame);
}

TEST(error_picture, shares_are_those_of_the_tested_pixels) {
  // 3 of 96 tested pixels are 3.12 %; the four untested ones count neither as wrong nor as tested. The same words are drawn for
  // another picture with that share, and other words for another share.
  const auto legend = [](int tested, int wrong) {
    Scored scored(400, 1);
    for (int i = tested; i < 400; ++i) scored.classes[i] = PixelClass::S;
    for (int i = 0; i < wrong; ++i) scored.err(i, Cause::acne);
    scored.err(399, Cause::none);
    const Picture picture = scored.draw();
    return std::vector(picture.rgb.begin() + 3 * 400, picture.rgb.end());
  };
  EXPECT_EQ(legend(96, 3), legend(192, 6));
  EXPECT_NE(legend(96, 3), legend(100, 3));
}

TEST(error_picture, without_causes_false_dark_and_false_lit_are_told_apart) {
  Scored scored(420, 8);
  scored.reference[5] = scored.reference[6] = scored.mask[6] = 0;
  scored.err(3, Cause::none);
  scored.err(5, Cause::none);
  scored.causes.clear();
  const Picture picture = scored.draw();
  EXPECT_EQ(pixel(picture, 3, 0), color_of(Cause::acne));
  EXPECT_EQ(pixel(picture, 5, 0), color_of(Cause::peter_panning));
  EXPECT_EQ(count(picture, color_of(Cause::acne), 0, 8) + count(picture, color_of(Cause::peter_panning), 0, 8), 2);
}

TEST(error_picture, a_picture_narrower_than_its_legend_is_drawn) {
  Scored scored(3, 2);
  for (int i = 0; i < 6; ++i) scored.err(i, Cause::crack);
  const Picture picture = scored.draw("a title");
  EXPECT_EQ(count(picture, color_of(Cause::crack), 0, 2), 6);
  EXPECT_EQ(picture.rgb.size(), static_cast<std::size_t>(3 * 3 * picture.height));
}

}  // namespace error_picture_test
