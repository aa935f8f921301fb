#include <gnomon/kit/maps/light_map.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/context.h"
#include "map_scenes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"
#include "techniques/cascaded_map/slices.h"

extern "C" void gnomon_technique_cascaded_map(gnomon::Registry&);
extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace cascaded_map_test {
using namespace gnomon;
using namespace gnomon::cascaded_map;

const View low_view{.eye = {-2.8f, 0.2f, 0.3f}, .target = {3, 0.1f, 0}};
const Light sun{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}};

class CascadedMap : public testing::Test {
 protected:
  CascadedMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_cascaded_map, settings, scene, light, g);
  }
  /// Pixels whose answer is not that of a ray.
  static int wrong(const small_world::Run& map, const Scene& scene, const Light& light, const GBuffer& g) {
    int count = 0;
    for (std::size_t i = 0; i < g.size(); ++i)
      if (faces_light(scene, g, light, i))
        count += (small_world::caster_distance(scene, light, g.position(i)) < INFINITY) != (map.mask[i] < 0.5f);
    return count;
  }
};

// From 1 to 16 in four: equal ratios end at 2, 4, 8, equal lengths at 4.75, 8.5, 12.25, and halfway between are their means.
TEST(cascaded_map_slices, splits_are_means_of_equal_ratios_and_equal_lengths) {
  const auto expect = [](double logarithmic, std::vector<double> ends) {
    const std::vector<double> splits = practical_splits({1, 16}, 4, logarithmic);
    ASSERT_EQ(splits.size(), ends.size());
    for (std::size_t i = 0; i < ends.size(); ++i) EXPECT_NEAR(splits[i], ends[i], 1e-12);
  };
  expect(1, {2, 4, 8});
  expect(0, {4.75, 8.5, 12.25});
  expect(0.5, {3.375, 6.25, 10.125});
  EXPECT_TRUE(practical_splits({1, 16}, 1, 0.5).empty());
}

// Corners of the slice's pyramid lie in the sphere, and the farthest of them on it.
TEST(cascaded_map_slices, sphere_holds_its_slice_and_no_more) {
  const glm::dvec3 eye(1, 2, 3), axis = glm::normalize(glm::dvec3(1, -0.5, 2));
  const glm::dvec3 side = glm::normalize(glm::cross(axis, glm::dvec3(0, 1, 0)));
  for (const double tangent : {0.1, 0.5, 1.0, 3.0})
    for (const DepthRange slice : {DepthRange{1, 2}, DepthRange{0.01, 5}, DepthRange{4.9, 5}}) {
      const SliceSphere sphere = sphere_around(eye, axis, tangent, slice);
      const auto distance = [&](double depth) { return glm::distance(sphere.center, eye + depth * (axis + tangent * side)); };
      EXPECT_LE(distance(slice.near), sphere.radius * (1 + 1e-12));
      EXPECT_NEAR(distance(slice.far), sphere.radius, 1e-12);
    }
}

// However the sphere moves, its square is as large, holds it, and begins at a whole number of texels.
TEST(cascaded_map_slices, stable_windows_move_by_whole_texels) {
  const LightSpaceFace face = light_space_of(sun, mesh_boxes(map_scenes::soup_over_ground(1))).main();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-5, 5);
  const double radius = 1.7, texel = 2 * radius / 99;
  for (int round = 0; round < 200; ++round) {
    const SliceSphere sphere{{place(random), place(random), place(random)}, radius};
    const LightExtent window = stable_window(face, sphere, 100);
    const glm::dvec2 center(face.seen(sphere.center));
    for (int k = 0; k < 2; ++k) {
      EXPECT_NEAR(window.high[k] - window.low[k], 100 * texel, 1e-12);
      EXPECT_LE(window.low[k], center[k] - radius + 1e-12);
      EXPECT_GE(window.high[k], center[k] + radius - 1e-12);
      EXPECT_NEAR(window.low[k] / texel, std::round(window.low[k] / texel), 1e-9);
    }
  }
}

// One slice is the whole picture: the mask of a map that is fitted to the view.
TEST_F(CascadedMap, one_cascade_is_a_map_fitted_to_the_view) {
  const Scene scene = map_scenes::soup_over_ground(21);
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 96, 72);
  for (const Light& light : {sun, Light{.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}}}) {
    const auto cascaded = run("resolution=256,cascades=1", scene, light, g);
    const auto one = small_world::run(gnomon_technique_shadow_map, "resolution=256,fit=view", scene, light, g);
    int different = 0;
    for (std::size_t i = 0; i < g.size(); ++i) different += cascaded.mask[i] != one.mask[i];
    EXPECT_LE(different, 8) << light.name;  // the windows' double and float32 may round a texel's border otherwise
  }
}

// Along a low view four images tell more than one of the same texels together.
TEST_F(CascadedMap, four_images_beat_one_of_their_texels_along_a_low_view) {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  for (int i = 0; i < 24; ++i) {
    const float x = -2.6f + 0.22f * static_cast<float>(i);
    scene.meshes.push_back(small_world::box({x, 0, -0.02f}, {x + 0.08f, 0.5f, 0.02f}));
  }
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 160, 120);
  const int of_one = wrong(small_world::run(gnomon_technique_shadow_map, "resolution=256", scene, sun, g), scene, sun, g);
  for (const std::string placement : {"fitted", "stable"}) {
    const int of_four = wrong(run("resolution=128,placement=" + placement, scene, sun, g), scene, sun, g);
    EXPECT_LT(of_four, (placement == "fitted" ? 0.6 : 1.0) * of_one) << placement << ' ' << of_one;
  }
}

// In every slice the texel that a pixel looked up is on the light's ray to it, to a texel.
TEST_F(CascadedMap, explanations_name_the_texels_of_the_right_image) {
  const Scene scene = map_scenes::soup_over_ground(4);
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 96, 72);
  const auto cascaded = run("resolution=256,bias=receiver_plane", scene, sun, g);
  std::vector<double> widths;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, sun, i)) continue;
    const auto why = cascaded.technique->explain(i);
    ASSERT_TRUE(why);
    if (why->taps.empty()) continue;
    ASSERT_EQ(why->taps.size(), 1u);
    const glm::dvec3 to = glm::dvec3(g.position(i)) - why->taps[0].origin;
    EXPECT_LE(glm::length(glm::cross(to, why->taps[0].direction)), why->texel_width * std::sqrt(0.5) * 1.01);
    if (std::ranges::find(widths, why->texel_width) == widths.end()) widths.push_back(why->texel_width);
  }
  EXPECT_EQ(widths.size(), 4u) << "one width of texels for each slice";
}

// A pixel's part is the number of its slice: parts follow depth, and there are as many as cascades.
TEST_F(CascadedMap, parts_are_slices_of_depth) {
  const Scene scene = map_scenes::soup_over_ground(4);
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 96, 72);
  const auto cascaded = run("resolution=128,cascades=3", scene, sun, g);
  const std::vector<std::uint32_t> parts = cascaded.technique->image_parts();
  ASSERT_EQ(parts.size(), g.size());
  const glm::dvec3 axis = glm::normalize(glm::dvec3(low_view.target) - glm::dvec3(low_view.eye));
  std::vector<std::pair<double, std::uint32_t>> by_depth;
  for (std::size_t i = 0; i < g.size(); ++i) {
    EXPECT_EQ(parts[i] != 0, faces_light(scene, g, sun, i)) << i;
    if (parts[i] != 0) by_depth.emplace_back(glm::dot(axis, glm::dvec3(g.position(i)) - glm::dvec3(low_view.eye)), parts[i]);
  }
  std::ranges::sort(by_depth);
  EXPECT_TRUE(std::ranges::is_sorted(by_depth, {}, &std::pair<double, std::uint32_t>::second));
  EXPECT_EQ(by_depth.front().second, 1u);
  EXPECT_EQ(by_depth.back().second, 3u);
  EXPECT_TRUE(run("resolution=128,cascades=1", scene, sun, g).technique->image_parts().empty());
}

TEST(cascaded_map_slices, lengths_are_those_of_all_slices_but_the_last) {
  EXPECT_EQ(lengths_of({1, 16}, std::vector{2.0, 5.0, 9.0}), (std::vector{1.0, 3.0, 4.0}));
  EXPECT_TRUE(lengths_of({1, 16}, {}).empty());
}

/// Plates half a meter above a ground, one behind the other along a low view.
Scene plates_over_ground() {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  for (int i = 0; i < 12; ++i) {
    const float x = -2.6f + 0.45f * static_cast<float>(i);
    scene.meshes.push_back(small_world::box({x, 0.5f, -0.4f}, {x + 0.15f, 0.55f, 0.4f}));
  }
  return scene;
}

// A point of the ground is lit by a texel that stores nothing more than a quarter of a meter before it: plates are half a meter
// above it or more. The answer is the mean of that by the weights of the taps, and the weight of the second one, in the next
// slice, grows from 0 where the overlap begins to 1 at the slice's end, linearly in depth.
TEST_F(CascadedMap, blended_slices_are_weighted_means_of_both_look_ups) {
  const Scene scene = plates_over_ground();
  const GBuffer g = small_world::make_gbuffer(scene, low_view, 96, 72);
  ViewSlices slices{.eye = low_view.eye, .axis = glm::normalize(glm::dvec3(low_view.target) - glm::dvec3(low_view.eye))};
  for (const std::string placement : {"fitted", "stable"}) {
    DepthRange range = depths_of(points_facing(sun, mesh_boxes(scene), g), slices);
    if (placement == "stable") range = quantized(range);
    slices.ends = practical_splits(range, 3, 0.5);
    const std::vector<double> lengths = lengths_of(range, slices.ends);
    const auto map = run("resolution=64,cascades=3,blend=0.5,placement=" + placement, scene, sun, g);
    int both = 0, between = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.mesh[i] != 0 || !faces_light(scene, g, sun, i)) continue;
      const auto why = map.technique->explain(i);
      ASSERT_TRUE(why);
      if (why->taps.empty()) continue;  // nothing casts there
      double weights = 0, lit = 0;
      for (const Tap& tap : why->taps) {
        weights += tap.weight;
        if (tap.stored > glm::dot(glm::dvec3(g.position(i)) - tap.origin, tap.direction) - 0.25) lit += tap.weight;
      }
      EXPECT_NEAR(weights, 1, 1e-6) << i;
      EXPECT_NEAR(map.mask[i], lit, 1e-5) << i;
      between += map.mask[i] > 0.01f && map.mask[i] < 0.99f;
      const int slice = slices.slice_of(g.position(i));
      if (slice == 2) continue;
      const double share = 1 + (slices.depth_of(g.position(i)) - slices.ends[slice]) / (0.5 * lengths[slice]);
      if (share > 0.01 && share < 0.99) {
        ASSERT_EQ(why->taps.size(), 2u) << i;
        EXPECT_NEAR(why->taps[1].weight, share, 1e-4) << i;
        ++both;
      } else if (share < -0.01) {
        EXPECT_EQ(why->taps.size(), 1u) << i;
      }
      if (placement == "stable") {
        EXPECT_TRUE(why->covered) << i;
      }
    }
    EXPECT_GT(both, 100) << placement;
    EXPECT_GT(between, 0) << placement << ": edges of two images differ somewhere";
  }
}

// A step of the eye that is no multiple of a texel leaves shadow edges on the ground where they are.
TEST_F(CascadedMap, stable_images_keep_their_texels_while_the_eye_slides) {
  const Scene scene = map_scenes::soup_over_ground(8);
  const auto texel_corners = [&](const std::string& placement, float slide) {
    View view = low_view;
    view.eye.x += slide;
    view.target.x += slide;
    const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
    const auto map = run("resolution=256,cascades=1,placement=" + placement, scene, sun, g);
    for (std::size_t i = 0; i < g.size(); ++i)
      if (const auto why = map.technique->explain(i); why && !why->taps.empty()) return why->taps[0].origin / why->texel_width;
    throw Error("no pixel looked up a texel");
  };
  const glm::dvec3 before = texel_corners("stable", 0), after = texel_corners("stable", 0.0137f);
  // Centers of texels differ by whole steps along both axes of the face.
  const LightSpaceFace face = light_space_of(sun, mesh_boxes(scene)).main();
  for (int k = 0; k < 2; ++k) {
    const double steps = glm::dot(after - before, face.axis(k));
    EXPECT_NEAR(steps, std::round(steps), 1e-3) << k;
  }
}

// 10^4 m from the origin float32 has steps of 2^-10 m. Coordinates here are eighths, so that the scene itself stays the same to
// the bit when it is moved, and only points of the picture are rounded, by up to 2^-11 m along each axis: less than a fiftieth
// of a texel. What texels store is the same surface then, to a step of the raster (1/256 texel) along the receivers' slope.
// Transforms of coordinates of 10^4 m would be off by 10^-3 m and more.
TEST_F(CascadedMap, stable_images_are_the_same_ten_kilometers_away) {
  const glm::vec3 way(1e4f, 0, -1e4f);
  Scene here, there;
  here.meshes = {small_world::ground(3)};
  for (int i = 0; i < 11; ++i) {
    const float x = -2.5f + 0.5f * static_cast<float>(i);
    here.meshes.push_back(small_world::box({x, 0.5f, -0.375f}, {x + 0.125f, 0.625f, 0.375f}));
  }
  there = here;
  for (Mesh& mesh : there.meshes)
    for (glm::vec3& p : mesh.positions) p += way;
  const View near{.eye = {-2.75f, 0.25f, 0.25f}, .target = {3, 0.125f, 0}};
  const View far{.eye = near.eye + way, .target = near.target + way};
  const GBuffer g = small_world::make_gbuffer(here, near, 96, 72), moved = small_world::make_gbuffer(there, far, 96, 72);
  const std::string settings = "resolution=256,cascades=2,placement=stable";
  const auto at_origin = run(settings, here, sun, g), away = run(settings, there, sun, moved);
  const LightSpaceFace face = light_space_of(sun, mesh_boxes(here)).main();
  std::size_t facing = 0, looked_up = 0, same = 0, stored = 0, apart = 0, different = 0;
  int dark = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(here, g, sun, i) || !faces_light(there, moved, sun, i)) continue;
    ++facing;
    dark += (away.mask[i] < 0.5f) - (at_origin.mask[i] < 0.5f);
    different += at_origin.mask[i] != away.mask[i];
    const auto a = at_origin.technique->explain(i), b = away.technique->explain(i);
    if (a->taps.empty() || b->taps.empty()) continue;
    ++looked_up;
    EXPECT_NEAR(a->texel_width, b->texel_width, 1e-6) << i;
    const Tap &ta = a->taps[0], &tb = b->taps[0];
    const glm::dvec3 aside = tb.origin - glm::dvec3(way) - ta.origin;
    if (std::hypot(glm::dot(aside, face.axis(0)), glm::dot(aside, face.axis(1))) > a->texel_width / 4) continue;
    ++same;
    apart += std::isfinite(ta.stored) != std::isfinite(tb.stored);
    if (!std::isfinite(ta.stored) || !std::isfinite(tb.stored)) continue;
    ++stored;
    EXPECT_LE(glm::distance(ta.origin + ta.stored * ta.direction, tb.origin + tb.stored * tb.direction - glm::dvec3(way)), 5e-4)
        << i;
  }
  EXPECT_GT(stored, facing / 2);
  EXPECT_GE(same, looked_up * 9 / 10) << "points cross a border between texels where rounding takes them over it";
  EXPECT_LE(apart, same / 200);
  EXPECT_LE(std::abs(dark), static_cast<int>(facing / 100)) << "the mask has the same share of shadow";
  EXPECT_LE(different, facing / 50);
}

// Placed in double by an origin that stays, a window is the same whatever origin it is seen from.
TEST(cascaded_map_slices, windows_move_to_the_eye_in_double) {
  const LightSpace still = light_space_of(sun, mesh_boxes(map_scenes::soup_over_ground(1)));
  const glm::dvec3 eye(12345.678, 1.7, -54321.0);
  const LightSpace around = around_eye(still, eye);
  const glm::dvec3 point = eye + glm::dvec3(0.25, -0.5, 3);
  const LightExtent window = stable_window(still.main(), {point, 2}, 100), moved = less(window, still.main().seen(eye));
  const glm::dvec3 q = around.main().seen(point);
  for (int k = 0; k < 2; ++k) {
    EXPECT_NEAR(moved.high[k] - moved.low[k], window.high[k] - window.low[k], 1e-9);
    EXPECT_LE(moved.low[k], q[k] - 2 + 1e-9);
    EXPECT_GE(moved.high[k], q[k] + 2 - 1e-9);
  }
  EXPECT_NEAR(moved.near, q.z - 2, 1e-9);
  EXPECT_NEAR(moved.far, q.z + 2, 1e-9);
}

// The eye's coordinates are rounded three times, and the transforms lose what 1/128 of a texel of a slice does not hold.
TEST(cascaded_map_slices, rounding_grows_with_the_eye_and_where_texels_are_small) {
  const ViewSlices slices{.eye = {1e4, 0, 0}, .axis = {1, 0, 0}, .ends = {10}};
  LightCamera camera;
  camera.images.resize(2);
  for (int i = 0; i < 2; ++i) {
    camera.images[i].scale = {50, 100};
    camera.images[i].layer = i;
  }
  const double at_eye = 6 * 0x1p-24 * 1e4;
  // Reaches are 10 sqrt 2 and 1000 sqrt 2 m, 1/128 texel of 1/50 m is 1.6e-4 m: 17 * 2^-24 * 1414 m is 1.4e-3 m.
  EXPECT_NEAR(rounding_around_eye(camera, {}, slices, 1000, 1), at_eye + 17 * 0x1p-24 * 1000 * std::sqrt(2) - 0.02 / 128, 1e-9);
  camera.images[1].scale = {1, 1};
  EXPECT_NEAR(rounding_around_eye(camera, {}, slices, 1000, 1), at_eye, 1e-9) << "texels are a meter wide";
}

// Points have six images and no slices; what is unsupported says why.
TEST_F(CascadedMap, lights_of_six_images_are_refused_with_the_reason) {
  const Scene scene = map_scenes::soup_over_ground(8);
  Registry registry;
  gnomon_technique_cascaded_map(registry);
  const auto technique = registry.techniques()[0].make();
  for (const Light& light : {Light{.kind = PointLight{{0, 3, 0}}}, Light{.kind = SpotLight{{0, 3, 0}, {0, -1, 0}, 50, 70}}}) {
    const Support support = technique->supports(scene, light, low_view);
    EXPECT_EQ(support.kind(), Support::Kind::unsupported);
    EXPECT_NE(support.why().find("slices are of one image"), std::string::npos) << support.why();
  }
  technique->apply("placement=stable");
  EXPECT_EQ(technique->supports(scene, {.kind = SpotLight{{0, 3, 0}, {0, -1, 0}, 20, 30}}, low_view).kind(),
            Support::Kind::unsupported);
  EXPECT_EQ(technique->supports(scene, sun, low_view).kind(), Support::Kind::full);
}

}  // namespace cascaded_map_test
