#include <gnomon/kit/maps/bias_presets.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bias_presets_test {
using namespace gnomon;

const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
const Light spot{.name = "spot", .kind = SpotLight{}};
const Light point{.name = "point", .kind = PointLight{}};

const BiasPreset& preset(std::string_view name) { return *std::ranges::find(bias_presets(), name, &BiasPreset::name); }

TEST(bias_presets, each_has_a_name_of_its_own_a_source_and_a_reason_where_a_light_is_missing) {
  std::set<std::string_view> names;
  for (const BiasPreset& one : bias_presets()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_FALSE(one.source.empty()) << one.name;
    EXPECT_TRUE(one.directional) << one.name;
    EXPECT_EQ(one.missing.empty(), one.spot && one.point) << one.name;
  }
  EXPECT_EQ(names, (std::set<std::string_view>{"oriented", "godot", "unity", "unreal", "bevy", "filament", "three_js"}));
}

// Of Godot 0.1 / 100 m; of Unreal 10 half texels times 0.5, and 3 times 0.5 of that for the slope; of Bevy a texel's diagonal,
// sqrt 2 widths, 1.8 and 0.6 times.
TEST(bias_presets, numbers_are_those_of_the_engines_in_meters_and_texels) {
  EXPECT_DOUBLE_EQ(preset("godot").numbers(sun)->meters, 0.1 / 100);
  EXPECT_DOUBLE_EQ(preset("godot").numbers(sun)->normal, 1);
  EXPECT_DOUBLE_EQ(preset("unity").numbers(sun)->texels, 1);
  EXPECT_DOUBLE_EQ(preset("unreal").numbers(sun)->texels, 10 * 0.5 * 0.5);
  EXPECT_DOUBLE_EQ(preset("unreal").numbers(sun)->slope, 10 * 0.5 * 0.5 * 3 * 0.5);
  EXPECT_DOUBLE_EQ(preset("bevy").numbers(sun)->meters, 0.02);
  EXPECT_DOUBLE_EQ(preset("bevy").numbers(spot)->meters, 0.02);
  EXPECT_DOUBLE_EQ(preset("bevy").numbers(point)->meters, 0.08);
  EXPECT_DOUBLE_EQ(preset("bevy").numbers(sun)->normal, 1.8 * std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(preset("bevy").numbers(point)->normal, 0.6 * std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(preset("filament").numbers(point)->meters, 0.001);
  EXPECT_DOUBLE_EQ(preset("filament").numbers(point)->slope, 2);
  EXPECT_DOUBLE_EQ(preset("oriented").numbers(spot)->meters, 0.002);
  const BiasNumbers none = *preset("three_js").numbers(point);
  EXPECT_EQ(none.meters + none.texels + none.slope + none.normal, 0);
}

TEST(bias_presets, a_light_without_numbers_is_refused_with_preset_light_and_reason) {
  for (const char* name : {"godot", "unity", "unreal"}) {
    EXPECT_EQ(preset(name).refusal(sun, 10), std::nullopt);
    for (const Light& light : {spot, point}) {
      const std::string wanted =
          std::string("bias=") + name + " has no number for a " + light.name + " light: " + std::string(preset(name).missing);
      EXPECT_EQ(preset(name).refusal(light, 10), wanted);
    }
  }
  for (const char* name : {"oriented", "bevy", "filament", "three_js"})
    for (const Light& light : {sun, spot, point}) EXPECT_EQ(preset(name).refusal(light, 10), std::nullopt) << name;
}

// 0.02 m hide all shadows of a scene of 0.01 m. Texels grow with the scene, and a scene without meshes has no length.
TEST(bias_presets, a_bias_longer_than_the_scene_is_refused_with_both_lengths) {
  EXPECT_EQ(preset("bevy").refusal(sun, 0.01),
            "bias=bevy is 0.02 m toward the light, longer than the scene, whose diagonal is 0.01 m");
  EXPECT_EQ(preset("bevy").refusal(sun, 0.03), std::nullopt);
  EXPECT_EQ(preset("bevy").refusal(sun, 0), std::nullopt);
  EXPECT_EQ(preset("unreal").refusal(sun, 1e-6), std::nullopt);
}

// What 0.005 means, of an image 40 m wide with 1024 texels a side over 100 m of depth: 0.5 m as a share of the depth range, 5
// mm in meters, 0.05 mm of Godot's hundredths, 0.2 mm in texels, and 0.05 mm of Unreal's, which are a quarter of a texel.
TEST(bias_presets, one_number_means_lengths_that_differ_ten_thousandfold) {
  const double number = 0.005, texel = 40.0 / 1024, range = 100;
  EXPECT_NEAR(number * range, 0.5, 1e-12);
  EXPECT_NEAR(number * preset("godot").numbers(sun)->meters / 0.1, 5e-5, 1e-12);
  EXPECT_NEAR(number * preset("unity").numbers(sun)->texels * texel, 1.953e-4, 1e-7);
  EXPECT_NEAR(number * preset("unreal").numbers(sun)->texels / 10 * texel, 4.883e-5, 1e-8);
}

}  // namespace bias_presets_test
