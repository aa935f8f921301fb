// Masks and reference along a line, and the plot's ticks.
#include "app/viewer/profile.h"

#include "app/viewer/plot.h"
#include "hand_made_frame.h"

namespace profile_test {

using namespace hand_made_frame;

TEST(viewer_profile, has_a_value_for_each_pixel_of_its_length) {
  HandMadeFrame seen(8, 2), other(seen.frame);
  for (int x = 0; x < 8; ++x) {
    seen.answer->mask[x] = static_cast<float>(x) / 8;
    seen.reference->mask[x] = static_cast<float>(x) / 16;
  }
  seen.reference->error.assign(16, 0.01f);
  seen.picture->mesh[3] = no_mesh;
  Composition c = left_of(seen, Paint::mask);
  c.sides[1] = other.side();
  // From the middle of pixel 1 to that of pixel 5: four steps of one pixel.
  const Profile profile = profile_along(c, {{1.5, 0.5}, {5.5, 0.5}});
  EXPECT_EQ(profile.distance, (std::vector<double>{0, 1, 2, 3, 4}));
  ASSERT_EQ(profile.pixel.size(), 5u);
  EXPECT_EQ(profile.pixel[4], glm::ivec2(5, 0));
  EXPECT_EQ(profile.sides[0][0], 1 / 8.0f);
  EXPECT_EQ(profile.reference[0], 1 / 16.0f);
  EXPECT_TRUE(std::isnan(profile.sides[0][2]));
  EXPECT_TRUE(std::isnan(profile.reference[2])) << "the background";
  EXPECT_EQ(profile.sides[0][4], 5 / 8.0f);
  EXPECT_EQ(profile.sides[1][4], 1);
  EXPECT_EQ(profile.error[4], 0.01f);
  EXPECT_FALSE(profile.is_reference[0]);
  EXPECT_EQ(profile_csv(profile),
            "distance_pixels,column,row,left,right,reference,standard_error\n"
            "0,1,0,0.125,1,0.0625,0.00999999978\n"
            "1,2,0,0.25,1,0.125,0.00999999978\n"
            "2,3,0,,,,\n"
            "3,4,0,0.5,1,0.25,0.00999999978\n"
            "4,5,0,0.625,1,0.3125,0.00999999978\n");
}

TEST(viewer_profile, goes_on_beside_the_picture_and_has_a_value_at_least) {
  HandMadeFrame seen(4, 1);
  const Composition c = left_of(seen, Paint::mask);
  const Profile across = profile_along(c, {{-1.5, 0.5}, {1.5, 0.5}});
  EXPECT_TRUE(std::isnan(across.sides[0][0]));
  EXPECT_EQ(across.sides[0][3], 1);
  EXPECT_TRUE(std::isnan(across.sides[1][3])) << "no other side";
  EXPECT_TRUE(across.error.empty());
  const Profile point = profile_along(c, {{1.5, 0.5}, {1.5, 0.5}});
  EXPECT_EQ(point.distance, (std::vector<double>{0, 0}));
  // A diagonal of 3 and 4 pixels is 5 long.
  EXPECT_EQ(profile_along(c, {{0.5, 0.5}, {3.5, 4.5}}).distance.back(), 5);
}

TEST(viewer_profile, of_a_smaller_frame_repeats_its_pixels) {
  HandMadeFrame seen(2, 1);
  seen.answer->mask = {0.25f, 0.75f};
  Composition c = left_of(seen, Paint::mask);
  c.width = 4;
  const Profile profile = profile_along(c, {{0.5, 0.5}, {3.5, 0.5}});
  EXPECT_EQ(profile.sides[0], (std::vector<float>{0.25f, 0.25f, 0.75f, 0.75f}));
}

TEST(viewer_profile, shows_the_reference_as_it_is_judged_by) {
  HandMadeFrame seen(2, 1);
  seen.reference->mask = {0.5f, 0.5f};
  seen.reference->error = {0.1f, 0.1f};
  seen.reference->irradiance = {0.25f, 0.25f};
  seen.reference->irradiance_error = {0.2f, 0.2f};
  Composition c = left_of(seen, Paint::mask);
  // The reference at the left, the technique at the right.
  std::swap(c.sides[0], c.sides[1]);
  c.sides[0] = ComposeSide{seen.frame, seen.reference->mask, 2, 1};
  c.reference = seen.reference.get();
  const ProfileLine line{{0.5, 0.5}, {1.5, 0.5}};
  Profile profile = profile_along(c, line);
  EXPECT_TRUE(profile.is_reference[0]);
  EXPECT_FALSE(profile.is_reference[1]);
  EXPECT_FALSE(profile.is_irradiance);
  EXPECT_EQ(profile.reference[0], 0.5f);
  EXPECT_EQ(profile.error[0], 0.1f);
  seen.verdict.estimates = LightShareKind::irradiance;
  profile = profile_along(c, line);
  EXPECT_TRUE(profile.is_irradiance);
  EXPECT_EQ(profile.reference[0], 0.25f);
  EXPECT_EQ(profile.error[0], 0.2f);
}

TEST(viewer_plot, ticks_are_round_numbers_within_the_axis) {
  const auto values = [](const PlotAxis& axis, int count) {
    std::vector<std::string> words;
    for (const PlotTick& tick : plot_ticks(axis, count)) words.push_back(tick.words);
    return words;
  };
  using Words = std::vector<std::string>;
  EXPECT_EQ(values({"", -0.05, 1.05}, 5), (Words{"0", "0.5", "1"}));
  EXPECT_EQ(values({"", -0.05, 1.05}, 6), (Words{"0", "0.2", "0.4", "0.6", "0.8", "1"}));
  EXPECT_EQ(values({"", 0, 437}, 5), (Words{"0", "100", "200", "300", "400"}));
  EXPECT_EQ(values({"", 1, 256, true}, 5), (Words{"1", "10", "100"}));
  EXPECT_EQ(values({"", 0.015, 0.16, true}, 5), (Words{"0.02", "0.05", "0.1"}));
}

}  // namespace profile_test
