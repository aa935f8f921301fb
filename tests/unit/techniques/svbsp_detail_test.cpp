// The surface detail of the SVBSP tree: areas on paper, what is narrow or far away, and the painter's picture of it.
#include <gnomon/kit/pictures/layers.h>
#include <gtest/gtest.h>

#include <map>

#include "hard_scenes.h"
#include "svbsp_rig.h"

namespace gnomon::svbsp_detail_test {

using namespace hand_made;
using namespace svbsp_rig;
using small_world::value;

// Occluder 1 is the square of side 2 at the height 5 below a lamp at 10: on the ground, twice as large, it covers (-2 ..
// 2)^2; at the height 2 its shadow is 1.6 times as large and covers (0 .. 1.6)^2 of occluder 2, (0 .. 2)^2, whose own shadow
// is 1.25 times as large, (0 .. 2.5)^2. So on the ground 16 + 6.25 - 4 = 18.25 of 400 are dark, and on occluder 2 2.56 of 4.
TEST(Svbsp, areas_of_two_squares_over_a_ground) {
  const auto rectangle = [](float low, float high, float height) {
    return mesh_of({{low, height, low}, {low, height, high}, {high, height, high}, {high, height, low}},
                   {{0, 1, 2}, {0, 2, 3}});
  };
  Scene scene;
  scene.meshes = {rectangle(-10, 10, 0), rectangle(-1, 1, 5), rectangle(0, 2, 2)};
  for (const char* const settings : all_orders) {
    SCOPED_TRACE(settings);
    const auto technique = lit(settings, scene, point_light({0, 10, 0}));
    const SurfaceDetail detail = *technique->surface_detail();
    EXPECT_NEAR(area(detail, 0, false), 18.25, 1e-9);
    EXPECT_NEAR(area(detail, 0, true), 381.75, 1e-9);
    EXPECT_NEAR(area(detail, 2, false), 2.56, 1e-9);
    EXPECT_NEAR(area(detail, 2, true), 1.44, 1e-9);
    EXPECT_EQ(area(detail, 1, false), 0);
    EXPECT_NEAR(area(detail, 1, true), 4, 1e-9);
  }
  EXPECT_FALSE(lit("", scene, point_light({0, 10, 0}))->surface_detail()->polygons.empty());
  Registry registry;
  gnomon_technique_svbsp(registry);
  EXPECT_TRUE(registry.techniques()[0].make()->surface_detail()->polygons.empty());  // of a fresh object
}

// Merged, a polygon has all its corners and is alone; else there are more of them, with the same areas, lit and dark.
TEST(Svbsp, merging_changes_no_area) {
  Random random(3);
  for (int round = 0; round < 20; ++round) {
    Scene scene;
    scene.meshes = {square(6, -2), hard_scenes::boxes(random, 6, false)};
    const Light light = hard_scenes::hard_light(random);
    for (const char* const order : {"", "order=bsp", "order=face_planes"}) {
      const std::string settings = *order ? std::string(order) + "," : "";
      const auto merged = lit(settings + "merge=true", scene, light)->surface_detail();
      const auto loose = lit(settings + "merge=false", scene, light)->surface_detail();
      EXPECT_LE(merged->polygons.size(), loose->polygons.size());
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> parts;
      for (const DetailPolygon& polygon : merged->polygons) ++parts[{polygon.mesh, polygon.triangle}];
      for (const DetailPolygon& polygon : merged->polygons)
        if (parts[{polygon.mesh, polygon.triangle}] == 1) {
          EXPECT_EQ(polygon.count, 3u);
        }
      for (const std::uint32_t mesh : {0u, 1u})
        for (const bool is_lit : {true, false}) EXPECT_NEAR(area(*merged, mesh, is_lit), area(*loose, mesh, is_lit), 1e-7);
    }
  }
}

// A triangle edge-on to the sun casts and receives nothing. One a hundred-billionth of the scene wide, as the light sees it,
// casts nothing either. It lies along the plane of the ground's diagonal, so that no fragment of it is left; it is divided
// all the same, into itself.
TEST(Svbsp, what_has_no_width_casts_nothing) {
  Scene scene;
  scene.meshes = {square(5, 0), mesh_of({{0, 1, -1}, {0, 1, 1}, {0, 2, 0}, {-1, 3, -1}, {1, 3, 1}, {0x1p-36f, 4, -0x1p-36f}},
                                        {{0, 1, 2}, {3, 4, 5}})};
  for (const char* const settings : {"", "merge=false"}) {
    const auto technique = lit(settings, scene, sun({0, -1, 0}));
    EXPECT_EQ(value(technique->counts(), "shadow_planes"),
              5);  // of the ground's two triangles
    const SurfaceDetail detail = *technique->surface_detail();
    EXPECT_EQ(area(detail, 0, false), 0);
    ASSERT_EQ(std::ranges::count(detail.polygons, 1u, &DetailPolygon::mesh), 1);
    const DetailPolygon& narrow = detail.polygons.back();
    EXPECT_EQ(narrow.triangle, 1u);
    EXPECT_TRUE(narrow.is_lit);
    EXPECT_EQ(narrow.count, 3u);
  }
}

// Without casters there is nothing to center light space on; a sun's direction may have any length.
TEST(Svbsp, a_long_direction_moves_no_corner) {
  Scene scene;
  scene.meshes = {square(1, 0.25f)};
  scene.meshes[0].casts = false;
  const auto detail = lit("merge=false", scene, sun({0, -1e20f, 0}))->surface_detail();
  ASSERT_EQ(detail->polygons.size(), 2u);
  for (const glm::dvec3& corner : detail->corners) {
    EXPECT_NEAR(std::abs(corner.x), 1, 1e-14);
    EXPECT_NEAR(corner.y, 0.25, 1e-14);
    EXPECT_NEAR(std::abs(corner.z), 1, 1e-14);
  }
}

// Steep triangles reach up through a tilted plate by tips less than 10^-10 of the scene wide: these hide nothing of the
// plate, so that all below it stays dark.
TEST(Svbsp, tips_bound_no_cells) {
  for (const float height : {3e-10f, 1e-9f, 3e-9f, 1e-8f}) {
    Scene scene;
    scene.meshes = {square(2, 0), square(3, -1.5f)};
    for (glm::vec3& p : scene.meshes[0].positions) p.y = p.x / 4;
    for (const float z : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f})
      scene.meshes.push_back(mesh_of({{0, height, z}, {0.1f, -1, z + 0.05f}, {0, -1, z + 0.1f}}, {{0, 1, 2}}));
    for (const char* const settings : {"", "order=face_planes", "order=face_planes,drop_edges=none"}) {
      SCOPED_TRACE(settings);
      const auto detail = lit(settings, scene, sun({0, -1, 0}))->surface_detail();
      EXPECT_NEAR(area(*detail, 1, false), 16, 1e-8);
      for (std::uint32_t mesh = 2; mesh < 7; ++mesh) EXPECT_NEAR(area(*detail, mesh, true), 0, 1e-8);
    }
  }
}

// Leaves 1e-4 above a floor, seen from 1e7 times as far away as they are wide apart: eight squares of side 1/2 are 2 of 64
// square meters.
TEST(Svbsp, a_far_lamp_sees_which_of_two_is_nearer) {
  Scene scene;
  scene.meshes = {square(4, 0)};
  for (int i = 0; i < 8; ++i) {
    scene.meshes.push_back(square(0.25f, 1e-4f));
    for (glm::vec3& p : scene.meshes.back().positions) p.x += static_cast<float>(i) - 3.5f;
  }
  for (const char* const settings : all_orders) {
    SCOPED_TRACE(settings);
    const auto detail = lit(settings, scene, point_light({0, 1e7f, 0}))->surface_detail();
    EXPECT_NEAR(area(*detail, 0, false), 2, 1e-5);
    EXPECT_NEAR(area(*detail, 0, true), 62, 1e-5);
  }
}

// Unmerged, the two squares over a ground leave more polygons than merged.
TEST(Svbsp, merging_leaves_fewer_polygons) {
  Scene scene;
  scene.meshes = {square(10, 0), square(1, 5), square(1, 2)};
  for (const char* const order : {"order=tiles", "order=bsp", "order=face_planes"}) {
    const auto count = [&](const std::string& merge) {
      return lit(order + merge, scene, point_light({0.5f, 10, 0.25f}))->surface_detail()->polygons.size();
    };
    EXPECT_LT(count(",merge=true"), count(",merge=false")) << order;
  }
}

// The second pass: away from edges the painter's picture is the depth-buffered one with the mask, wherever the eye goes.
TEST(Svbsp, the_painter_shows_the_mask) {
  Random random(7);
  std::mt19937 engine(7);
  int plain = 0, dark = 0;
  for (int round = 0; round < 12; ++round) {
    Scene scene;
    scene.meshes = {small_world::ground(3, 0), small_world::random_soup(engine, 25, 2, 0.2f, 2, 0.6f),
                    hard_scenes::boxes(random, 3, false), hard_scenes::cycle(1, 1.5f)};
    const Light light = round % 2 ? sun({0.3f, -1, 0.2f}) : point_light({0.5f, 5, 0.3f});
    const char* const settings = all_orders[round % 5];
    for (int eye = 0; eye < 3; ++eye) {
      const View view{.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.4, -4), glm::dvec3(4, 4, 4))), .target = {0, 0.5f, 0}};
      const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 64, 48);
      const auto done = run(settings, scene, light, gbuffer);
      const std::vector<float> painted = done.technique->draw_debug("painter"),
                               wanted = shaded_layer(scene, gbuffer, light, done.mask);
      const auto same = [&](std::size_t i, std::size_t j) {
        return gbuffer.mesh[i] == gbuffer.mesh[j] && gbuffer.triangle[i] == gbuffer.triangle[j] && done.mask[i] == done.mask[j];
      };
      for (std::size_t y = 1; y + 1 < 48; ++y)
        for (std::size_t x = 1; x + 1 < 64; ++x) {
          const std::size_t i = 64 * y + x;
          bool is_plain = true;
          for (const std::size_t j : {i - 65, i - 64, i - 63, i - 1, i + 1, i + 63, i + 64, i + 65}) is_plain &= same(i, j);
          if (!is_plain) continue;
          ++plain, dark += done.mask[i] == 0;
          for (std::size_t c = 3 * i; c < 3 * i + 3; ++c)
            ASSERT_NEAR(painted[c], wanted[c], 2e-6) << "round " << round << ", " << settings << ", eye " << eye << ", " << i;
        }
    }
  }
  EXPECT_GT(plain, 40'000);
  EXPECT_GT(dark, 2'000);
}

}  // namespace gnomon::svbsp_detail_test
