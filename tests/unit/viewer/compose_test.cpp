#include "app/viewer/compose.h"

#include <gnomon/kit/layers.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <random>

#include "app/viewer/several_lights.h"
#include "hand_made_frame.h"
#include "measure/cause/color_vision.h"
#include "measure/picture/signed_color.h"
#include "measure/score/error_picture.h"

namespace {

using namespace gnomon;
using namespace gnomon::viewer;
using namespace hand_made_frame;

const Rgb darker = rgb(signed_color(-1, 1)), same = rgb(signed_color(0, 1)), lighter = rgb(signed_color(1, 1));

std::vector<std::uint32_t> composed(const Composition& c) {
  std::vector<std::uint32_t> rgba(static_cast<std::size_t>(c.width) * c.height, 0x01020304);
  compose(c, rgba);
  return rgba;
}

/// The bytes of `composed` without alpha, which is 255.
std::vector<std::uint8_t> bytes_of(const Composition& c) {
  std::vector<std::uint8_t> rgb;
  for (const std::uint32_t pixel : composed(c)) {
    const auto bytes = std::bit_cast<std::array<std::uint8_t, 4>>(pixel);
    EXPECT_EQ(bytes[3], 255);
    rgb.insert(rgb.end(), bytes.begin(), bytes.begin() + 3);
  }
  return rgb;
}

std::vector<Rgb> pixels_of(const Composition& c) {
  const std::vector<std::uint8_t> bytes = bytes_of(c);
  std::vector<Rgb> pixels;
  for (std::size_t i = 0; i < bytes.size(); i += 3) pixels.push_back({bytes[i], bytes[i + 1], bytes[i + 2]});
  return pixels;
}

/// Any points, normals, classes, masks and causes, under any kind of light.
HandMadeFrame random_seen(std::mt19937& random, int width, int height) {
  HandMadeFrame seen(width, height);
  const auto uniform = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  const auto vector = [&] { return glm::vec3(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)); };
  seen.scene().ambient = uniform(0, 0.4f);
  for (Mesh& mesh : seen.scene().meshes) mesh.albedo = {uniform(0, 1), uniform(0, 1), uniform(0, 1)};
  for (std::size_t i = 0; i < seen.answer->mask.size(); ++i) {
    seen.picture->set(i, vector(), glm::normalize(vector()), random() % 8 == 0 ? no_mesh : random() % 2, random() % 2);
    const auto visibility = [&] { return random() % 4 == 0 ? uniform(0, 1) : static_cast<float>(random() % 2); };
    seen.answer->mask[i] = visibility();
    seen.reference->mask[i] = visibility();
    seen.reference->classes[i] = seen.picture->mesh[i] == no_mesh ? PixelClass::B
                                 : random() % 2 == 0              ? PixelClass::T
                                                                  : static_cast<PixelClass>(random() % 6);
    const bool is_wrong =
        seen.reference->classes[i] == PixelClass::T && std::abs(seen.answer->mask[i] - seen.reference->mask[i]) > 0.5f;
    seen.verdict.causes[i] = is_wrong ? static_cast<Cause>(1 + random() % cause_infos().size()) : Cause::none;
  }
  seen.verdict.cause_counts = count_causes(seen.verdict.causes);
  switch (random() % 4) {
    case 0:
      seen.frame->light = hand_made::point_light(vector());
      break;
    case 1:
      seen.frame->light = hand_made::sun(vector());
      break;
    case 2:
      seen.frame->light.kind = SpotLight{vector(), vector(), 20, 50};
      break;
    case 3:
      seen.frame->light.kind = SphereLight{vector(), 1};
      break;
  }
  seen.frame->light.intensity = uniform(0, 2);
  seen.finish();
  return seen;
}

// What the files of `gnomon render` show, the window shows.
RC_GTEST_PROP(viewer_compose, a_full_frame_has_the_bytes_of_the_pictures_in_files, ()) {
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  const HandMadeFrame seen = random_seen(random, *rc::gen::inRange(1, 90), *rc::gen::inRange(1, 40));
  const Frame& f = *seen.frame;
  const std::vector<float>& mask = seen.answer->mask;
  const Composition c = left_of(seen, Paint::shaded);
  RC_ASSERT(bytes_of(c) == shade(f.scene(), f.gbuffer, f.light, mask).rgb);
  RC_ASSERT(bytes_of(left_of(seen, Paint::mask)) == draw_mask(mask, c.width, c.height).rgb);
}

/// The same points under a second light, whose mask, reference and classes are others; what is wrong has a cause.
HandMadeFrame several_seen(std::mt19937& random, int width, int height) {
  HandMadeFrame seen = random_seen(random, width, height);
  const HandMadeFrame other = random_seen(random, width, height);
  Frame& frame = *seen.frame;
  frame.lights = {frame.light, other.frame->light};
  frame.lights[1].name = "other";
  const auto bare = [](const HandMadeFrame& from) {
    auto reference = std::make_shared<ReferenceState>(*from.reference);
    reference->frame.reset();
    return reference;
  };
  auto second = bare(other);
  for (std::size_t i = 0; i < second->classes.size(); ++i)
    if (frame.gbuffer.is_background(i)) second->classes[i] = PixelClass::B;
  std::vector<std::vector<Cause>> causes = {seen.verdict.causes, {}};
  for (std::size_t i = 0; i < second->classes.size(); ++i)
    causes[1].push_back(second->classes[i] == PixelClass::T && is_wrong(other.answer->mask[i], second->mask[i]) ? Cause::acne
                                                                                                                : Cause::none);
  seen.reference->lights = {bare(seen), second};
  put_together(*seen.reference);
  seen.answer->masks = {seen.answer->mask, other.answer->mask};
  seen.answer->mask = shown_together(frame, frame.gbuffer, seen.answer->masks);
  frame.received = received_light(frame.gbuffer, frame.lights[0]);
  const std::vector<double> more = received_light(frame.gbuffer, frame.lights[1]);
  for (std::size_t i = 0; i < more.size(); ++i) frame.received[i] += more[i];
  frame.exposure = exposure_of(frame.scene(), frame.gbuffer, frame.received);
  seen.verdict.together = put_together(*seen.answer, *seen.reference, LightShareKind::area, causes);
  seen.verdict.has_causes = true;
  return seen;
}

// Of several lights together, too: the light of all, in an exposure that keeps it below white, and errors of that light.
TEST(viewer_compose, several_lights_have_the_bytes_of_the_pictures_in_files) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    const HandMadeFrame seen = several_seen(random, 60, 40);
    const Frame& f = *seen.frame;
    std::vector<Evidence> lights;
    for (std::size_t k = 0; k < 2; ++k) lights.push_back(evidence_of(*seen.answer, *seen.reference, LightShareKind::area, k));
    const Together whole = together(lights);
    EXPECT_EQ(seen.answer->mask, whole.shown);
    EXPECT_TRUE(bytes_of(left_of(seen, Paint::shaded)) == shade(f.scene(), f.gbuffer, whole.received, whole.shown).rgb) << seed;
    EXPECT_TRUE(bytes_of(left_of(seen, Paint::mask)) == draw_mask(whole.shown, 60, 40).rgb) << seed;
    for (const Paint paint : {Paint::kinds, Paint::causes}) {
      Evidence e = seen.verdict.together->evidence();
      if (paint == Paint::kinds) e.causes = {};
      Picture errors = draw_errors(e, "");
      errors.rgb.resize(seen.answer->mask.size() * 3);
      EXPECT_TRUE(bytes_of(left_of(seen, paint)) == errors.rgb) << seed;
    }
  }
}

TEST(viewer_compose, errors_have_the_bytes_of_the_pictures_in_files) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    const HandMadeFrame seen = random_seen(random, 60, 40);
    const Frame& f = *seen.frame;
    const std::vector<float>& mask = seen.answer->mask;
    for (const Paint paint : {Paint::kinds, Paint::causes}) {
      Evidence e{60, 40, seen.reference->classes, seen.reference->mask, mask, {}, &f.scene(), &f.gbuffer, &f.light};
      if (paint == Paint::causes) e.causes = seen.verdict.causes;
      Picture errors = draw_errors(e, "");
      errors.rgb.resize(mask.size() * 3);  // without the legend below
      EXPECT_TRUE(bytes_of(left_of(seen, paint)) == errors.rgb) << seed;
    }
  }
}

TEST(viewer_compose, errors_under_a_light_with_area_have_them_too) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    HandMadeFrame seen = random_seen(random, 60, 40);
    const std::size_t pixels = seen.answer->mask.size();
    seen.frame->light.kind = SphereLight{{0, 5, 0}, 1};
    for (float& v : seen.answer->mask) v = static_cast<float>(random() % 1000) / 999;
    for (std::size_t i = 0; i < pixels; ++i) seen.verdict.causes[i] = static_cast<Cause>(random() % 3);
    seen.verdict.has_causes = true;
    seen.finish();
    const Frame& f = *seen.frame;
    for (const Paint paint : {Paint::kinds, Paint::causes})
      for (const bool are_sought : {true, false}) {
        if (!are_sought) seen.verdict.causes.clear();
        Evidence e{60,         40,      seen.reference->classes, seen.reference->mask, seen.answer->mask, {}, &f.scene(),
                   &f.gbuffer, &f.light};
        if (paint == Paint::causes) e.causes = seen.verdict.causes;
        Picture errors = draw_errors(e, "");
        errors.rgb.resize(pixels * 3);
        EXPECT_TRUE(bytes_of(left_of(seen, paint)) == errors.rgb) << seed << are_sought;
        seen.verdict.causes.assign(pixels, Cause::none);
      }
  }
}

TEST(viewer_compose, light_received_is_intensity_times_cosine_inside_the_cone) {
  // A light 2 m above the origin; the point at (2, 0, 0) sees it under 45 degrees, as far from the cone's axis.
  HandMadeFrame seen(4, 1);
  seen.picture->set(1, {2, 0, 0}, {0, 1, 0}, 0, 0);
  seen.picture->set(2, {0, 0, 0}, {0, -1, 0}, 0, 0);
  seen.picture->mesh[3] = no_mesh;
  Light point = hand_made::point_light({0, 2, 0});
  point.intensity = 3;
  std::vector<double> received = received_light(seen.picture->gbuffer, point);
  EXPECT_EQ(received[0], 3);
  EXPECT_NEAR(received[1], 3 * std::sqrt(0.5), 1e-15);
  EXPECT_EQ(received[2], 0) << "turned away";
  EXPECT_EQ(received[3], 0) << "background";
  point.kind = SpotLight{{0, 2, 0}, {0, -1, 0}, 20, 44};
  received = received_light(seen.picture->gbuffer, point);
  EXPECT_EQ(received[0], 3);
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
  seen.answer->mask = {1, 0, 0, 1, 0, 0.5f};
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

RC_GTEST_PROP(viewer_compose, every_combination_fills_the_picture_and_nothing_else, ()) {
  std::mt19937 random(*rc::gen::arbitrary<unsigned>());
  const auto size = [] { return *rc::gen::inRange(1, 40); };
  const HandMadeFrame a = random_seen(random, size(), size()), b = random_seen(random, size(), size());
  const LayerPicture layers[] = {layer_of(a, glm::vec3(1)), layer_of(b, glm::vec3(NAN, -1, 2))};
  std::vector<float> coarse(12);
  for (float& v : coarse) v = random() % 4 == 0 ? NAN : static_cast<float>(random() % 5) - 2;
  Composition c{.width = size(), .height = size()};
  c.layout = static_cast<Layout>(random() % std::size(layout_rows));
  c.paint = static_cast<Paint>(random() % std::size(paint_rows));
  c.difference = {static_cast<Against>(random() % 2), difference_scales[random() % difference_scales.size()],
                  random() % 2 == 0};
  c.shows_contours = random() % 2 == 0;
  c.divider = std::uniform_real_distribution<double>(-0.2, 1.2)(random);
  c.flicker_is_right = random() % 2 == 0;
  c.layer_opacity = std::uniform_real_distribution<float>(-1, 2)(random);
  for (ComposeSide& side : c.sides) {
    const HandMadeFrame& seen = random() % 2 == 0 ? a : b;
    side = random() % 8 == 0 ? ComposeSide{} : seen.side();
    if (random() % 4 == 0) side.mask = coarse, side.mask_width = 4, side.mask_height = 3;
    if (random() % 8 == 0) side.mask_width += 1;
    if (random() % 4 == 0) side.verdict = random() % 2 == 0 ? nullptr : &b.verdict;
    if (random() % 2 == 0) side.layer = &layers[random() % 2];
  }
  c.reference = random() % 2 == 0 ? nullptr : a.reference.get();

  constexpr std::uint32_t guard = 0xdeadbeef;
  constexpr std::size_t margin = 64;
  const std::size_t count = static_cast<std::size_t>(c.width) * c.height;
  std::vector<std::uint32_t> rgba(count + 2 * margin, guard);
  compose(c, std::span(rgba).subspan(margin, count));
  for (std::size_t i = 0; i < rgba.size(); ++i) {
    if (i < margin || i >= margin + count)
      RC_ASSERT(rgba[i] == guard);
    else
      RC_ASSERT((std::bit_cast<std::array<std::uint8_t, 4>>(rgba[i])[3]) == 255);
  }
  // Twice the same, and the columns of a split are those of its sides alone.
  RC_ASSERT(std::ranges::equal(composed(c), std::span(rgba).subspan(margin, count)));
  if (c.layout == Layout::split) {
    std::vector<std::uint32_t> alone[2];
    for (int side = 0; side < 2; ++side) {
      c.layout = side == 0 ? Layout::left : Layout::right;
      alone[side] = composed(c);
    }
    c.layout = Layout::split;
    const auto middle = static_cast<int>(std::lround(std::clamp(c.divider, 0.0, 1.0) * c.width));
    for (int i = 0; i < c.width * c.height; ++i)
      if (const int x = i % c.width; x < middle - 2 || x > middle + 1) RC_ASSERT(rgba[margin + i] == alone[side_at(c, x)][i]);
  }
  // Legend and magnifier take the same in.
  for (int side = 0; side < 2; ++side) {
    for (const LegendEntry& entry : legend(c, side)) RC_ASSERT(!words(entry).empty());
    Explanation why;
    why.taps.resize(random() % 7);
    const auto x = static_cast<int>(random() % c.width), y = static_cast<int>(random() % c.height);
    for (const PixelFact& fact : pixel_facts(c, side, x, y, c.reference, &why))
      RC_ASSERT(!fact.name.empty() && !fact.value.empty());
  }
}

}  // namespace
