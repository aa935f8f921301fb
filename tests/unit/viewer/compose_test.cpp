// Composed pictures of small frames, pixel by pixel: sides, scales, colors, layers.
#include "app/viewer/compose.h"

#include <gnomon/kit/pictures/layers.h>

#include "composed.h"
#include "measure/cause/color_vision.h"
#include "measure/picture/signed_color.h"

namespace compose_test {

using namespace composed_pixels;
using namespace hand_made_frame;

const Rgb darker = rgb(signed_color(-1, 1)), same = rgb(signed_color(0, 1)), lighter = rgb(signed_color(1, 1));

TEST(viewer_compose, light_received_is_irradiance_inside_the_cone) {
  // A light 2 m above the origin; the point at (2, 0, 0) sees it under 45 degrees, as far from the cone's axis.
  HandMadeFrame seen(4, 1);
  seen.picture->set(1, {2, 0, 0}, {0, 1, 0}, 0, 0);
  seen.picture->set(2, {0, 0, 0}, {0, -1, 0}, 0, 0);
  seen.picture->mesh[3] = no_mesh;
  Light point = hand_made::point_light({0, 2, 0});
  point.intensity = 3;
  std::vector<double> received = received_light(seen.picture->gbuffer, point);
  EXPECT_EQ(received[0], 3.0 / 4);
  EXPECT_NEAR(received[1], 3.0 / 8 * std::sqrt(0.5), 1e-15);
  EXPECT_EQ(received[2], 0) << "turned away";
  EXPECT_EQ(received[3], 0) << "background";
  point.kind = SpotLight{{0, 2, 0}, {0, -1, 0}, 20, 44};
  received = received_light(seen.picture->gbuffer, point);
  EXPECT_EQ(received[0], 3.0 / 4);
  EXPECT_EQ(received[1], 0) << "outside the cone";
}

TEST(viewer_compose, split_shows_the_left_side_left_of_a_line_of_four_pixels) {
  HandMadeFrame dark(10, 2), lit(10, 2);
  std::ranges::fill(dark.answer->mask, 0.0f);
  Composition c{.width = 10, .height = 2, .layout = Layout::split, .paint = Paint::mask, .divider = 0.44};
  c.sides[0] = dark.side();
  c.sides[1] = lit.side();
  // 4.4 is column 4, of which the line takes two pixels to each side.
  const Rgb edge{12, 13, 15}, line{238, 240, 244}, b = gray(0), w = gray(255);
  std::vector<Rgb> row{b, b, edge, line, line, edge, w, w, w, w};
  std::vector<Rgb> both = row;
  both.insert(both.end(), row.begin(), row.end());
  EXPECT_EQ(pixels_of(c), both);
  for (int x = 0; x < 10; ++x) EXPECT_EQ(side_at(c, x + 0.5), x < 4 ? 0 : 1) << x;
  // At the ends half of the line stays, to be dragged.
  c.height = 1;
  c.divider = -3;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{line, edge, w, w, w, w, w, w, w, w}));
  EXPECT_EQ(side_at(c, 0), 1);
  c.divider = 2;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{b, b, b, b, b, b, b, b, edge, line}));
  EXPECT_EQ(side_at(c, 9.9), 0);
  c.divider = NAN;
  EXPECT_EQ(pixels_of(c)[9], w);
}

TEST(viewer_compose, one_side_alone_and_flicker_have_no_line) {
  HandMadeFrame dark(10, 1), lit(10, 1);
  std::ranges::fill(dark.answer->mask, 0.0f);
  Composition c{.width = 10, .height = 1, .paint = Paint::mask};
  c.sides[0] = dark.side();
  c.sides[1] = lit.side();
  const auto shows = [&](Layout layout, bool flicker_is_right) {
    c.layout = layout;
    c.flicker_is_right = flicker_is_right;
    const std::vector<Rgb> pixels = pixels_of(c);
    EXPECT_EQ(pixels, std::vector<Rgb>(10, pixels[0]));
    EXPECT_EQ(side_at(c, 0), pixels[0] == gray(0) ? 0 : 1);
    EXPECT_EQ(side_at(c, 9.5), side_at(c, 0));
    return side_at(c, 0);
  };
  EXPECT_EQ(shows(Layout::left, true), 0);
  EXPECT_EQ(shows(Layout::right, false), 1);
  EXPECT_EQ(shows(Layout::flicker, false), 0);
  EXPECT_EQ(shows(Layout::flicker, true), 1);
}

TEST(viewer_compose, smaller_frames_are_magnified_to_the_nearest_pixel) {
  // Centers of five columns over two are at 0.2, 0.6, 1.0, 1.4, 1.8; of three rows over two at 1/3, 1, 5/3.
  HandMadeFrame seen(2, 2);
  seen.answer->mask = {0, 0.2f, 0.4f, 1};
  Composition c = left_of(seen, Paint::mask);
  c.width = 5;
  c.height = 3;
  const Rgb p = gray(0), q = gray(51), r = gray(102), s = gray(255);
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{p, p, q, q, q, r, r, s, s, s, r, r, s, s, s}));
  EXPECT_EQ(frame_pixel(c, 0, 1, 0), 0u);
  EXPECT_EQ(frame_pixel(c, 0, 2, 0), 1u);
  EXPECT_EQ(frame_pixel(c, 0, 1, 1), 2u);
  EXPECT_EQ(frame_pixel(c, 0, 4, 2), 3u);
  for (const auto& [x, y] : {std::pair{-1, 0}, {5, 0}, {0, -1}, {0, 3}}) EXPECT_EQ(frame_pixel(c, 0, x, y), std::nullopt);
  EXPECT_EQ(frame_pixel(c, 1, 0, 0), std::nullopt) << "no frame";
  // A frame that is larger than the picture, after the window shrank: centers of two over four are at 1 and 3.
  HandMadeFrame large(4, 1);
  large.answer->mask = {0, 0.2f, 0.4f, 1};
  c = left_of(large, Paint::mask);
  c.width = 2;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{q, s}));
}

TEST(viewer_compose, masks_of_fewer_pixels_stand_for_their_frame) {
  HandMadeFrame seen(4, 2);
  const std::vector<float> coarse{0, 1};
  Composition c = left_of(seen, Paint::mask);
  c.sides[0].mask = coarse;
  c.sides[0].mask_width = 2;
  c.sides[0].mask_height = 1;
  const Rgb b = gray(0), w = gray(255);
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{b, b, w, w, b, b, w, w}));
  c.paint = Paint::shaded;  // ambient is 1/4, sRGB 137
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{gray(137), gray(137), w, w, gray(137), gray(137), w, w}));
  // It differs from the other side where a pixel of it does, and errors wait for the whole mask.
  c.sides[1] = seen.side();
  c.paint = Paint::difference;
  c.difference.against = Against::other_side;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{darker, darker, same, same, darker, darker, same, same}));
  c.paint = Paint::kinds;
  c.reference = seen.reference.get();
  EXPECT_EQ(pixels_of(c), std::vector<Rgb>(8, right));
}

TEST(viewer_compose, errors_are_colored_where_they_are_tested) {
  HandMadeFrame seen(6, 1);
  seen.answer->mask = {1, 0, 0, 1, 0, 0.51f};
  seen.reference->mask = {1, 1, 0, 0, 1, 1};
  seen.reference->classes[4] = PixelClass::S;
  seen.verdict.causes = {Cause::none, Cause::crack, Cause::none, Cause::region, Cause::none, Cause::none};
  EXPECT_EQ(pixels_of(left_of(seen, Paint::kinds)), (std::vector<Rgb>{right, false_dark, right, false_lit, untested, right}));
  const auto color = [](Cause cause) { return rgb(cause_infos()[static_cast<int>(cause) - 1].color); };
  EXPECT_EQ(pixels_of(left_of(seen, Paint::causes)),
            (std::vector<Rgb>{right, color(Cause::crack), right, color(Cause::region), untested, right}));
}

TEST(viewer_compose, differences_have_the_colors_of_the_scale) {
  HandMadeFrame here(5, 1), there(here.frame);
  here.answer->mask = {0, 1, 0.5f, 1, 0};
  there.answer->mask = {0, 0, 1, 0.5f, 1};
  Composition c = left_of(here, Paint::difference);
  c.difference.against = Against::other_side;
  c.sides[1] = there.side();
  // A white lit surface is the brightest of the dimmed scene, where colors are what they are.
  const Rgb half_darker = rgb(signed_color(-0.5, 1)), half_lighter = rgb(signed_color(0.5, 1));
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{same, lighter, half_darker, half_lighter, darker}));
  c.layout = Layout::right;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{same, darker, half_lighter, half_darker, lighter}));
  // Untested, it is 71 of 172: colors keep (172 + 71) / 344 of their light. Plain ones keep it all.
  c.layout = Layout::left;
  here.reference->classes[4] = PixelClass::U;
  const Rgb dark = pixels_of(c)[4];
  for (int k = 0; k < 3; ++k) EXPECT_EQ(dark[k], darker[k] * 243 / 344);
  c.difference.is_plain = true;
  EXPECT_EQ(pixels_of(c)[4], darker);
  // Answers for other frames are not compared.
  HandMadeFrame before(5, 1);
  c.sides[1] = before.side();
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{right, right, right, right, untested}));
}

TEST(viewer_compose, differences_to_the_reference_end_at_the_full_scale) {
  HandMadeFrame seen(5, 1);
  seen.answer->mask = {0.5f, 0.525f, 0.475f, 0.7f, 0.5f};
  seen.reference->mask = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
  seen.picture->mesh[4] = no_mesh;
  Composition c = left_of(seen, Paint::difference);
  c.difference = {.full = 0.1, .is_plain = true};
  // A quarter of the scale, and twice the whole.
  const std::vector<Rgb> pixels = pixels_of(c);
  EXPECT_EQ(pixels[0], same);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(pixels[1][k], signed_color(0.25, 1)[k], 1);
    EXPECT_NEAR(pixels[2][k], signed_color(-0.25, 1)[k], 1);
  }
  EXPECT_EQ(pixels[3], lighter);
  EXPECT_EQ(pixels[4], gray(25)) << "the background";
  // The irradiance's share, where the technique estimates that.
  seen.reference->irradiance = seen.answer->mask;
  seen.verdict.estimates = LightShareKind::irradiance;
  for (int x = 0; x < 4; ++x) EXPECT_EQ(pixels_of(c)[x], same);
}

TEST(viewer_compose, classes_have_a_color_each) {
  HandMadeFrame seen(6, 1);
  seen.reference->classes = {PixelClass::B, PixelClass::F, PixelClass::G, PixelClass::S, PixelClass::U, PixelClass::T};
  const std::vector<Rgb> pixels = pixels_of(left_of(seen, Paint::classes));
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(pixels[k], rgb(class_infos()[k].color));
    for (std::size_t j = 0; j < k; ++j)
      for (const glm::dmat3& vision : color_vision::visions)
        EXPECT_GT(
            glm::distance(color_vision::lab(class_infos()[k].color, vision), color_vision::lab(class_infos()[j].color, vision)),
            26)
            << class_infos()[k].letter << class_infos()[j].letter;
  }
}

TEST(viewer_compose, what_is_not_there_yet_leaves_the_dimmed_scene) {
  HandMadeFrame seen(3, 1), later(3, 1);
  seen.answer->mask = {0, 1, 1};
  seen.reference->classes[1] = PixelClass::U;
  seen.picture->mesh[2] = no_mesh;
  // The background is untested: 20 + (2 * 24 + 5 * 26 + 30) / 8 / 5.
  const Rgb dim = gray(25);
  const std::vector<Rgb> unjudged{right, right, dim}, judged{right, untested, dim};
  Composition c = left_of(seen, Paint::kinds);
  c.sides[0].verdict = nullptr;
  for (const Paint paint : {Paint::kinds, Paint::causes, Paint::difference, Paint::classes}) {
    c.paint = paint;
    EXPECT_EQ(pixels_of(c), unjudged) << static_cast<int>(paint);
  }
  c.sides[0].mask = {};
  for (const Paint paint : {Paint::shaded, Paint::mask}) {
    c.paint = paint;
    EXPECT_EQ(pixels_of(c), unjudged) << static_cast<int>(paint);
  }
  // Classes are shown with whatever brings them, for the same frame.
  c.paint = Paint::shaded;
  c.reference = seen.reference.get();
  EXPECT_EQ(pixels_of(c), judged);
  c.reference = nullptr;
  c.sides[1] = seen.side();
  EXPECT_EQ(pixels_of(c), judged);
  c.reference = later.reference.get();
  c.sides[1] = later.side();
  EXPECT_EQ(pixels_of(c), unjudged) << "of another frame";
  // Error kinds need no causes, causes do.
  c = left_of(seen, Paint::kinds);
  seen.verdict.causes.clear();
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{false_dark, untested, dim}));
  c.paint = Paint::causes;
  EXPECT_EQ(pixels_of(c), judged);
  // A verdict of another frame is none.
  c.paint = Paint::kinds;
  c.sides[0].verdict = &later.verdict;
  EXPECT_EQ(pixels_of(c), unjudged);
  c.sides[0] = {};
  for (std::size_t p = 0; p < std::size(paint_rows); ++p) {
    c.paint = static_cast<Paint>(p);
    EXPECT_EQ(pixels_of(c), std::vector<Rgb>(3, nothing));
  }
}

TEST(viewer_compose, sides_of_different_frames_are_each_shown_as_they_are) {
  HandMadeFrame large(8, 2), small(4, 1);
  small.answer->mask = {1, 1, 0, 1};
  Composition c{.width = 8, .height = 2, .layout = Layout::split, .paint = Paint::mask, .divider = 0.25};
  c.sides[0] = large.side();
  c.sides[1] = small.side();
  // Column 4 and 5 show pixel 2 of the small frame; the line is over columns 0 to 3.
  const std::vector<Rgb> pixels = pixels_of(c);
  for (int y = 0; y < 2; ++y)
    for (int x = 4; x < 8; ++x) EXPECT_EQ(pixels[8 * y + x], gray(x < 6 ? 0 : 255)) << x << ' ' << y;
}

TEST(viewer_compose, a_layer_hides_the_paint_by_its_opacity) {
  HandMadeFrame seen(3, 1);
  seen.answer->mask = {0, 1, 1};
  seen.picture->mesh[1] = seen.picture->mesh[2] = no_mesh;
  LayerPicture layer = layer_of(seen, {0.5f, 0.25f, 0.125f});  // sRGB 188, 137, 99
  for (int c = 0; c < 3; ++c) layer.rgb[3 + c] = background_color()[c];
  Composition c = left_of(seen, Paint::mask);
  c.sides[0].layer = &layer;
  c.layer_opacity = 0;
  const Rgb b = gray(0), w = gray(255), over{188, 137, 99};
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{b, w, w}));
  c.layer_opacity = 1;
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{over, w, over})) << "but not where it shows nothing before nothing";
  c.layer_opacity = 0.5f;  // (255 + color) / 2 rounded up
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{{94, 69, 50}, w, {222, 196, 177}}));
  // The same color on a surface hides it: shape is all that such a layer leaves out.
  c.layer_opacity = 1;
  for (int k = 0; k < 3; ++k) layer.rgb[k] = background_color()[k];
  EXPECT_EQ(pixels_of(c)[0], nothing);
}

TEST(viewer_compose, a_layer_of_another_frame_is_magnified_by_itself) {
  HandMadeFrame seen(4, 1), before(2, 1);
  LayerPicture layer = layer_of(before, {0, 0, 0});
  layer.rgb[5] = 1;
  Composition c = left_of(seen, Paint::mask);
  c.sides[0].layer = &layer;
  c.layer_opacity = 1;
  const Rgb b = gray(0), blue{0, 0, 255};
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{b, b, blue, blue}));
  c.sides[0].frame.reset();
  EXPECT_EQ(pixels_of(c), (std::vector<Rgb>{b, b, blue, blue})) << "also before there is an answer";
  layer.rgb.pop_back();
  EXPECT_EQ(pixels_of(c), std::vector<Rgb>(4, nothing)) << "half a layer is none";
}

}  // namespace compose_test
