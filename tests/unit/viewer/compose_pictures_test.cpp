// Composed pictures of any frames: the bytes that files of `gnomon render` have, and no pixel left out.
#include <gnomon/kit/pictures/layers.h>
#include <rapidcheck/gtest.h>

#include <random>

#include "app/viewer/several_lights.h"
#include "composed.h"
#include "measure/picture/signed_color.h"
#include "measure/score/error_picture.h"

namespace compose_pictures_test {

using namespace composed_pixels;
using namespace hand_made_frame;

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
  seen.answer->mask = shown_together(frame, frame.gbuffer, seen.answer->masks).mask;
  frame.received = received_light(frame.gbuffer, frame.lights[0]);
  const std::vector<double> more = received_light(frame.gbuffer, frame.lights[1]);
  for (std::size_t i = 0; i < more.size(); ++i) frame.received[i] += more[i];
  frame.exposure = exposure_of(frame.scene(), frame.gbuffer, frame.received);
  seen.verdict.together = put_together(*seen.answer, *seen.reference, LightShareKind::area, causes);
  seen.verdict.has_causes = true;
  return seen;
}

// Of several lights together, too: the light of all, exposed together, and errors of that light.
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
      e.kind = f.kind();
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
        e.kind = f.kind();
        if (paint == Paint::causes) e.causes = seen.verdict.causes;
        Picture errors = draw_errors(e, "");
        errors.rgb.resize(pixels * 3);
        EXPECT_TRUE(bytes_of(left_of(seen, paint)) == errors.rgb) << seed << are_sought;
        seen.verdict.causes.assign(pixels, Cause::none);
      }
  }
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

}  // namespace compose_pictures_test
