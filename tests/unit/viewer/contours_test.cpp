// Contours of visibility, pixel by pixel.
#include "app/viewer/contours.h"

#include <gnomon/kit/random.h>

#include "hand_made_frame.h"

namespace contours_test {

using namespace hand_made_frame;

/// A ramp of visibility from 0 at column 0 to 1 at column 20, the same in all rows.
HandMadeFrame ramp() {
  HandMadeFrame seen(21, 5);
  for (std::size_t i = 0; i < seen.answer->mask.size(); ++i) seen.answer->mask[i] = static_cast<float>(i % 21) / 20;
  return seen;
}

TEST(viewer_contours, lie_where_visibility_has_their_level) {
  const HandMadeFrame seen = ramp();
  const ComposeSide side = seen.side();
  const Contours contours(side, technique_inks[0], false);
  // A step is 1/20: level 0.5 is at column 10, 0.02 at 0.4, 0.98 at 19.6.
  for (int x = 0; x < 21; ++x)
    EXPECT_NEAR(contours.distance(x, 2), std::min({std::abs(x - 0.4), std::abs(x - 10.0), std::abs(x - 19.6)}), 1e-4) << x;
}

TEST(viewer_contours, of_a_sharp_edge_run_along_it_on_both_sides) {
  HandMadeFrame seen(6, 3);
  for (std::size_t i = 0; i < seen.answer->mask.size(); ++i) seen.answer->mask[i] = i % 6 < 3 ? 0 : 1;
  const ComposeSide side = seen.side();
  const Contours contours(side, technique_inks[0], false);
  // The umbra ends on the dark side, full light begins on the lit one: 0.02 of a step off.
  EXPECT_EQ(contours.distance(1, 1), INFINITY);
  EXPECT_NEAR(contours.distance(2, 1), 0.02, 1e-6);
  EXPECT_NEAR(contours.distance(3, 1), 0.02, 1e-6);
  EXPECT_EQ(contours.distance(4, 1), INFINITY);
}

TEST(viewer_contours, are_of_one_surface_that_faces_the_light) {
  HandMadeFrame seen = ramp();
  const auto is_left = [](std::size_t i) { return i % 21 < 10; };
  const std::size_t count = seen.answer->mask.size();
  const ComposeSide side{seen.frame, seen.answer->mask, 21, 5};
  const Contours contours(side, reference_ink, true);
  for (std::size_t i = 0; i < count; ++i) {
    seen.answer->mask[i] = is_left(i) ? 0 : 1;
    seen.picture->mesh[i] = is_left(i) ? 0 : 1;
  }
  for (int x = 0; x < 21; ++x) EXPECT_EQ(contours.distance(x, 2), INFINITY) << x;
  // On one mesh there is an edge; not so where it is turned away, or nothing is to be seen.
  for (std::size_t i = 0; i < count; ++i) seen.picture->mesh[i] = 0;
  EXPECT_LT(contours.distance(10, 2), 1);
  for (std::size_t i = 0; i < count; ++i) seen.frame->received[i] = is_left(i) ? 0 : 1;
  EXPECT_EQ(contours.distance(10, 2), INFINITY);
  for (std::size_t i = 0; i < count; ++i) seen.frame->received[i] = 1;
  for (std::size_t i = 0; i < count; ++i)
    if (is_left(i)) seen.picture->mesh[i] = no_mesh;
  EXPECT_EQ(contours.distance(9, 2), INFINITY);
  EXPECT_EQ(contours.distance(10, 2), INFINITY);
}

// A penumbra of 60 columns, 1/60 each, and noise of up to a quarter, as few samples make it.
TEST(viewer_contours, of_noise_are_those_of_the_mean_around) {
  constexpr int width = 60, height = 40;
  HandMadeFrame seen(width, height);
  const auto fill = [&](double noise) {
    Random random(5);
    for (std::size_t i = 0; i < seen.answer->mask.size(); ++i)
      seen.answer->mask[i] =
          static_cast<float>(std::clamp((i % width + 0.5) / width + random.uniform(-noise, noise), 0.0, 1.0));
  };
  const ComposeSide side{seen.frame, seen.answer->mask, width, height};
  const auto covered = [&](int first, int last) {
    const Contours contours(side, technique_inks[0], false);
    int count = 0;
    for (int y = 0; y < height; ++y)
      for (int x = first; x < last; ++x) count += contours.distance(x, y) < 1.7f;  // half a casing and its rim
    return count;
  };
  fill(0.25);
  const int binary = covered(0, width);
  seen.frame->light.kind = SphereLight{};
  const int thinned = covered(0, width);
  EXPECT_GT(binary, width * height / 2) << "under a light without area a mask is drawn as it is";
  EXPECT_LT(3 * thinned, binary);
  // The middle of the penumbra is where it is: between columns 29 and 30. The mean of 81 values with a standard deviation of
  // 0.25 / sqrt(3) is off by 0.016, a column: four of these are 4 columns, and a line is 2 wide to each side.
  EXPECT_EQ(covered(8, 23) + covered(37, 52), 0);
  EXPECT_GT(covered(23, 37), height);
  // Without noise every pixel keeps its own: the ramp, and an edge in it.
  fill(0);
  for (std::size_t i = 0; i < seen.answer->mask.size(); ++i)
    if (i % width >= 30) seen.answer->mask[i] = 1;
  const Contours contours(side, technique_inks[0], false);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ASSERT_FALSE(contours.is_of_mean(x, y)) << x << ' ' << y;
}

TEST(viewer_contours, of_a_thin_shadow_are_its_own) {
  HandMadeFrame seen(30, 30);
  seen.frame->light.kind = SphereLight{};
  for (std::size_t i = 0; i < seen.answer->mask.size(); ++i) seen.answer->mask[i] = i % 30 == 15 || i % 30 == 17 ? 0.1f : 1;
  const ComposeSide side{seen.frame, seen.answer->mask, 30, 30};
  const Contours contours(side, technique_inks[0], false);
  for (int x = 0; x < 30; ++x) EXPECT_FALSE(contours.is_of_mean(x, 15)) << x;
}

TEST(viewer_contours, of_the_side_lie_over_broader_ones_of_the_reference) {
  HandMadeFrame seen = ramp();
  seen.reference->mask = seen.answer->mask;
  Composition c = left_of(seen, Paint::mask);
  const auto row = [&] {
    std::vector<std::uint32_t> picture(21 * 5);
    compose(c, picture);
    std::vector<Rgb> colors;
    for (int x = 0; x < 21; ++x) {
      const std::uint32_t p = picture[2 * 21 + x];
      colors.push_back({static_cast<int>(p & 255), static_cast<int>(p >> 8 & 255), static_cast<int>(p >> 16 & 255)});
    }
    return colors;
  };
  const std::vector<Rgb> plain = row();
  c.shows_contours = true;
  const std::vector<Rgb> both = row();
  EXPECT_EQ(both[10], rgb(technique_inks[0].core));
  // 2 off: beyond the side's line, whose half width is 1.7 with its rim. The reference's is 2.7, so 0.7 is its white over 153.
  EXPECT_NEAR(both[12][0], 153 + 0.7 * (255 - 153), 1);
  EXPECT_EQ(both[13], plain[13]);
  c.layout = Layout::right;
  std::swap(c.sides[0], c.sides[1]);
  EXPECT_EQ(row()[10], rgb(technique_inks[1].core));
  // A side that shows the reference itself has one contour.
  c.sides[1].mask = seen.reference->mask;
  c.sides[1].verdict = nullptr;
  c.reference = seen.reference.get();
  EXPECT_EQ(row()[10], rgb(reference_ink.core));
}

}  // namespace contours_test
