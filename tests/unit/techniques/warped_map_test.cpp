#include <gnomon/kit/maps/light_map.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/context.h"
#include "map_scenes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"
#include "techniques/warped_map/warp.h"

extern "C" void gnomon_technique_warped_map(gnomon::Registry&);

namespace warped_map_test {
using namespace gnomon;
using namespace gnomon::warped_map;

const View low_view{.eye = {-2.8f, 0.2f, 0.3f}, .target = {3, 0.1f, 0}};
const Light sun{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}};
const Light spot{.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}};

class WarpedMap : public testing::Test {
 protected:
  WarpedMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_warped_map, settings, scene, light, g);
  }
};

LightImage leaning(bool is_perspective) {
  LightImage image;
  image.is_perspective = is_perspective;
  image.origin = {1, 2, 3};
  image.scale = {300, 200};
  image.offset = {40, 30};
  image.pivot = {0.3, -0.8};
  image.lean = 1.7;
  image.near = 0.5;
  image.far = 9;
  return image;
}

// Texels of a window place, by the formula and by the matrix that draws; and back; and for small steps by differences.
TEST(warped_image, texels_by_formula_matrix_and_inverse_are_the_same) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.8, 1), depth(0.6, 9);
  for (const bool is_perspective : {false, true}) {
    const LightImage image = leaning(is_perspective);
    const glm::dmat4 clip = image.clip_from_world(512);
    for (int round = 0; round < 100; ++round) {
      const glm::dvec2 window{place(random), place(random)};
      const double z = depth(random);
      const glm::dvec3 q(is_perspective ? window * z : window, z);
      const glm::dvec2 texel = image.texel_of(window);
      EXPECT_LE(glm::distance(image.window_of(texel), window), 1e-12);
      const glm::dvec4 c = clip * glm::dvec4(image.to_world(q), 1);
      EXPECT_NEAR((c.x / c.w + 1) * 256, texel.x, 1e-9);
      EXPECT_NEAR((1 - c.y / c.w) * 256, texel.y, 1e-9);  // clip space has y up
      EXPECT_NEAR(image.axis_distance(c.z / c.w * image.divisor(window)), z, 1e-9) << "depth over the divisor";
      const glm::dvec2 step(1e-6, -2e-6);
      EXPECT_LE(glm::distance(image.texel_step(window, step), image.texel_of(window + step) - texel), 1e-8);
      // Its width is that of the box around a texel: of the four with a corner there, taken as small.
      const glm::dvec2 width = image.texel_width(q) / (is_perspective ? z : 1);
      glm::dvec2 box(0);
      for (const glm::dvec2 diagonal : {glm::dvec2(1, 1), glm::dvec2(1, -1)})
        box = glm::max(box, glm::abs(image.window_of(texel + 1e-4 * diagonal) - window) * 1e4);
      EXPECT_NEAR(width.x, box.x, 1e-3 * box.x);
      EXPECT_NEAR(width.y, box.y, 1e-3 * box.y);
    }
  }
}

// Between depths 1 and 4, light across the view: n = 1 + sqrt(4) = 3; at 30 degrees to it twice as much.
TEST(warp, light_space_perspective_is_the_published_distance) {
  EXPECT_DOUBLE_EQ(light_space_perspective_distance(1, 4, 1), 3);
  EXPECT_DOUBLE_EQ(light_space_perspective_distance(1, 4, 0.5), 6);
}

// What is in focus ends where 80 % of the rows do; from 0.8 of the length on no perspective is needed for that.
TEST(warp, trapezoidal_gives_the_focus_four_fifths_of_the_rows) {
  for (const double focus : {0.01, 0.2, 0.5, 0.79}) {
    const double n = trapezoidal_distance(2, 2 * focus);
    const auto row = [&](double y) { return (1 / n - 1 / (y + n)) / (1 / n - 1 / (2 + n)); };
    EXPECT_NEAR(row(2 * focus), 0.8, 1e-9) << focus;
  }
  EXPECT_EQ(trapezoidal_distance(2, 1.6), INFINITY);
}

// The image itself keeps that, whatever margin it has: of the rows inside, four fifths lie before the focus, and row 0 begins
// at the pivot.
TEST(warp, images_have_their_center_where_it_was_asked_for) {
  for (const double focus : {0.01, 0.25, 0.5})
    for (const int margin : {1, 9}) {
      const std::vector<glm::dvec2> corners{{-1, 2}, {1, 2}, {-3, 6}, {3, 6}};
      LightImage image;
      warped_map::warp(image, corners, trapezoidal_distance(4, 4 * focus), 256, margin);
      EXPECT_NEAR(image.texel_of({0, 2 + 4 * focus}).y, margin + 0.8 * (256 - 2 * margin), 1e-6) << focus << ' ' << margin;
      EXPECT_NEAR(image.texel_of({0, image.pivot.y}).y, 0, 1e-6);
    }
}

// However near the center is requested, no texel is finer than float32 tells window coordinates apart.
TEST(warp, texels_are_no_finer_than_window_coordinates) {
  LightImage image;
  warped_map::warp(image, {{-1e5, -1e5}, {1e5, -1e5}, {-1e5, 1e5}, {1e5, 1e5}}, 1e-3, 8192, 1);
  EXPECT_GE(1 / image.scale.y, 0x1p-20 * 1e5);
  EXPECT_GE(1 / image.scale.x, 0x1p-20 * 1e5);
}

// Whatever corners an image is warped to lie inside its margins and touch them on all sides.
TEST(warp, images_hold_their_corners_inside_the_margin) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-3, 3);
  for (int round = 0; round < 100; ++round) {
    Rows rows(-3, 3, 64);
    std::vector<glm::dvec2> shown;
    for (int i = 0; i < 20; ++i) {
      shown.push_back({place(random), place(random)});
      rows.add(shown.back());
    }
    for (const double distance : {0.3, 5.0, double(INFINITY)}) {
      LightImage image;
      warped_map::warp(image, rows.corners(), distance, 256, 4);
      glm::dvec2 low(INFINITY), high(-INFINITY);
      for (const glm::dvec2& corner : rows.corners()) {
        EXPECT_GE(image.divisor(corner), 1);
        low = glm::min(low, image.texel_of(corner));
        high = glm::max(high, image.texel_of(corner));
      }
      for (int k = 0; k < 2; ++k) {
        EXPECT_NEAR(low[k], 4, 1e-6);
        EXPECT_NEAR(high[k], 252, 1e-6);
      }
      EXPECT_GE(image.divisor(image.window_of({128, 0})), 1 - 1e-9) << "the margin's border";
      for (const glm::dvec2& point : shown) {
        const glm::dvec2 texel = image.texel_of(point);
        EXPECT_GE(std::min(texel.x, texel.y), 4 - 1e-6);
        EXPECT_LE(std::max(texel.x, texel.y), 252 + 1e-6);
      }
    }
  }
}

// Planes stay planes: the receiver's own plane as the bias leaves no acne on flat receivers, and the slope-scaled one none.
TEST_F(WarpedMap, lit_planes_have_no_acne) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({-1, 0.5f, -1}, {0.5f, 1.5f, 0.2f})};
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 128, 96);
  for (const Light& light : {sun, spot})
    for (const std::string warp : {"light_space_perspective", "trapezoidal", "none"})
      for (const std::string bias : {"bias=receiver_plane,depth_bias=0", "bias=slope,depth_bias=0.5,slope_bias=1.5"}) {
        const auto map = run("resolution=256,warp=" + warp + "," + bias, scene, light, g);
        int acne = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(scene, g, light, i) || map.mask[i] == 1) continue;
          const auto why = map.technique->explain(i);
          for (const Tap& tap : why->taps) {  // dark: some caster lies on the tap's ray well before the point
            const glm::dvec3 to = tap.direction * glm::dot(glm::dvec3(g.position(i)) - tap.origin, tap.direction);
            acne += tap.stored > glm::length(to) - 1e-3;
          }
        }
        EXPECT_EQ(acne, 0) << light.name << ' ' << warp << ' ' << bias;
      }
}

// The tap of a pixel is the texel that holds it, shadows are never beside the image, and stored surfaces are those of the
// scene.
TEST_F(WarpedMap, explanations_name_the_texels_that_were_asked) {
  const Scene scene = map_scenes::soup_over_ground(4);
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 96, 72);
  for (const Light& light : {sun, spot}) {
    const auto map = run("resolution=256,bias=receiver_plane", scene, light, g);
    int stored = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const auto why = map.technique->explain(i);
      ASSERT_TRUE(why);
      if (small_world::caster_distance(scene, light, g.position(i)) < INFINITY) {
        EXPECT_TRUE(why->covered) << light.name << ' ' << i;
      }
      if (why->taps.empty() || !why->covered) continue;
      const Tap& tap = why->taps[0];
      const glm::dvec3 to = glm::dvec3(g.position(i)) - tap.origin;
      EXPECT_LE(glm::length(glm::cross(to, tap.direction)), why->texel_width * std::sqrt(0.5) * 1.03) << light.name;
      if (tap.stored == INFINITY) continue;
      const double first = small_world::nearest(scene, tap.origin - tap.direction * (light.name == "sun" ? 20.0 : 0.0),
                                                tap.direction, 1e-6, true)
                               .t -
                           (light.name == "sun" ? 20.0 : 0.0);
      stored += std::abs(first - tap.stored) < 1e-4;
    }
    EXPECT_GT(stored, 1000) << light.name;
  }
}

// In a small picture one pixel alone may be the end of what the window shows: a roof shadows all, and none is beside the image.
TEST_F(WarpedMap, the_outermost_points_of_a_small_picture_are_in_the_image) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::ground(40, 5)};
  for (const auto& [width, height] : {std::pair(16, 9), std::pair(7, 5), std::pair(40, 30)}) {
    const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0.3f, 3, 2}, .target = {0, 0, 0}}, width, height);
    for (const std::string warp : {"light_space_perspective", "trapezoidal", "none"}) {
      const auto map = run("resolution=1024,warp=" + warp, scene, sun, g);
      for (std::size_t i = 0; i < g.size(); ++i)
        if (faces_light(scene, g, sun, i)) {
          EXPECT_EQ(map.mask[i], 0) << warp << ' ' << width << ' ' << i;
        }
    }
  }
}

// Along a low view a warp tells more than the same texels without.
TEST_F(WarpedMap, warps_beat_a_fit_along_a_low_view) {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  for (int i = 0; i < 24; ++i) {
    const float x = -2.6f + 0.22f * static_cast<float>(i);
    scene.meshes.push_back(small_world::box({x, 0, -0.02f}, {x + 0.08f, 0.5f, 0.02f}));
  }
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 160, 120);
  const auto wrong = [&](const std::string& warp) {
    const auto map = run("resolution=256,warp=" + warp, scene, sun, g);
    int count = 0;
    for (std::size_t i = 0; i < g.size(); ++i)
      if (faces_light(scene, g, sun, i))
        count += (small_world::caster_distance(scene, sun, g.position(i)) < INFINITY) != (map.mask[i] < 0.5f);
    return count;
  };
  const int none = wrong("none");
  EXPECT_LT(wrong("light_space_perspective"), 0.8 * none) << none;
  EXPECT_LT(wrong("trapezoidal"), 0.8 * none) << none;
}

// Light along the view has no direction of depth: all warps are none.
TEST_F(WarpedMap, light_along_the_view_is_not_warped) {
  const Scene scene = map_scenes::soup_over_ground(4);
  const View view{.eye = {0, 5, 3}, .target = {0, 0, 0}};
  const Light light{.kind = DirectionalLight{{0, -5, -3}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const auto none = run("resolution=128,warp=none", scene, light, g), warped = run("resolution=128", scene, light, g);
  EXPECT_EQ(none.mask, warped.mask);
}

TEST_F(WarpedMap, lights_of_six_images_are_refused_with_the_reason) {
  Registry registry;
  gnomon_technique_warped_map(registry);
  const auto technique = registry.techniques()[0].make();
  const Scene scene = map_scenes::soup_over_ground(8);
  for (const Light& light : {Light{.kind = PointLight{{0, 3, 0}}}, Light{.kind = SpotLight{{0, 3, 0}, {0, -1, 0}, 50, 70}}}) {
    const Support support = technique->supports(scene, light, low_view);
    EXPECT_EQ(support.kind(), Support::Kind::unsupported);
    EXPECT_NE(support.why().find("a warp is of one image"), std::string::npos) << support.why();
  }
}

}  // namespace warped_map_test
