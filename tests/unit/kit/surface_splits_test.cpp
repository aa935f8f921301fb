// The pictures of where polygons are divided.
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gtest/gtest.h>

#include "small_world.h"
#include "techniques/svbsp/paint_bsp.h"

namespace surface_splits_test {

using namespace small_world;

glm::dvec3 swatch(const DebugLayer& layer, std::size_t index) { return layer.legend.at(index).color; }
glm::dvec3 color(const std::vector<float>& p, std::size_t i) { return {p[3 * i], p[3 * i + 1], p[3 * i + 2]}; }

/// The square |x|, |z| <= 1 from straight above, 10 pixels a meter: columns 30 .. 49, rows 10 .. 29 of 80 x 40. The diagonal of
/// its triangles runs from (-1, -1) to (1, 1).
struct Square {
  Scene scene;
  GBuffer gbuffer;
  Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  Square() {
    scene.meshes = {ground(1)};
    const View view{.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 53.1301024f};
    gbuffer = make_gbuffer(scene, view, 80, 40);
  }
};

// Triangle 0 is (-1, -1), (-1, 1), (1, 1) in (x, z). It is divided at x = -0.5 and at x = 0.3: lit, lit, shadowed.
TEST(Splits, borders_are_colored_by_what_they_are) {
  const Square world;
  ASSERT_EQ(world.scene.meshes[0].triangles[0], glm::uvec3(0, 1, 2));
  SurfaceDetail detail;
  const auto add = [&](std::uint32_t triangle, bool is_lit, std::vector<glm::dvec2> corners) {
    detail.polygons.push_back(
        {0, triangle, is_lit, static_cast<std::uint32_t>(detail.corners.size()), static_cast<std::uint32_t>(corners.size())});
    for (const glm::dvec2& c : corners) detail.corners.push_back({c.x, 0, c.y});
  };
  add(0, true, {{-1, -1}, {-1, 1}, {-0.5, 1}, {-0.5, -0.5}});
  add(0, true, {{-0.5, -0.5}, {-0.5, 1}, {0.3, 1}, {0.3, 0.3}});
  add(0, false, {{0.3, 0.3}, {0.3, 1}, {1, 1}});
  add(1, true, {{-1, -1}, {1, 1}, {1, -1}});
  const std::vector<float> picture = paint_splits(world.scene, world.gbuffer, world.sun, detail);
  const DebugLayer layer = splits_layer();
  const auto is_border = [&](int x, int y, std::size_t swatch_index) {
    return glm::distance(color(picture, 80 * y + x), swatch(layer, swatch_index)) < 1e-6;
  };
  // In a row below the diagonal's crossing with both: x = -0.5 is between columns 34 and 35, 0.3 between 42 and 43; borders are
  // on the left. Row y meets the diagonal in column y + 20, and is of triangle 0 to its left.
  for (int y = 25; y < 29; ++y)
    for (int x = 30; x < 49; ++x) {
      EXPECT_EQ(is_border(x, y, 2), x == 34) << x << ", " << y << " split";
      EXPECT_EQ(is_border(x, y, 1), x == 42) << x << ", " << y << " border of a shadow";
      if (is_border(x, y, 0)) {
        EXPECT_NEAR(x, y + 20, 1) << "edge of a triangle";
      }
    }
  int edges = 0;
  for (std::size_t i = 0; i < world.gbuffer.size(); ++i)
    edges += is_border(static_cast<int>(i % 80), static_cast<int>(i / 80), 0);
  EXPECT_GE(edges, 15) << "of the diagonal's 20 rows, but for those where its polygons are small";
  // Sunlight along the normal: what is left in shadow is the ambient 0.06 of 0.5.
  const auto brightness = [&](int x, int y) { return color(picture, 80 * y + x).g; };
  EXPECT_LT(3 * brightness(44, 28), brightness(38, 28));
}

// Where borders are half of a polygon or more, splits fade; what divides light from shadow never does.
TEST(Splits, narrow_strips_keep_the_color_of_the_surface_but_for_shadow_borders) {
  const Square world;
  SurfaceDetail detail;
  for (int k = 0; k < 20; ++k) {
    const double a = -1 + 0.1 * k, b = a + 0.1;  // one pixel
    detail.polygons.push_back({0, 0, k < 10, static_cast<std::uint32_t>(detail.corners.size()), 4});
    for (const glm::dvec2 c : {glm::dvec2(a, a), {a, 1}, {b, 1}, {b, b}}) detail.corners.push_back({c.x, 0, c.y});
  }
  const std::vector<float> picture = paint_splits(world.scene, world.gbuffer, world.sun, detail);
  const DebugLayer layer = splits_layer();
  for (int x = 30; x < 41; ++x) {  // strips of ten pixels at least: one of them, by the diagonal, is no border
    const glm::dvec3 c = color(picture, 80 * 28 + x);
    EXPECT_EQ(glm::distance(c, swatch(layer, 1)) < 1e-6, x == 39) << x;
    EXPECT_GT(glm::distance(c, swatch(layer, 2)), 0.3) << x;
  }
}

// Two planes across a ground: a free cut through the middle of the triangles, or none. A vertical wall's plane splits the
// ground where it stands, all the way; with Choice::first the wall's plane is the first.
TEST(Splits, the_tree_splits_the_ground_along_the_plane_of_a_wall) {
  Square world;
  const auto wall = make_mesh({{0.05f, 0, 0}, {0.05f, 0.5f, 0.2f}, {0.05f, 0, 0.4f}}, {{0, 1, 2}});
  world.scene.meshes = {wall, ground(1)};
  const View view = world.gbuffer.view;
  world.gbuffer = make_gbuffer(world.scene, view, 80, 40);
  using namespace svbsp;
  const Bsp bsp(world.scene, {.choice = BspOptions::Choice::first, .free_cuts = false});
  const std::vector<float> picture = paint_bsp(world.scene, world.gbuffer, world.sun, bsp);
  const DebugLayer layer = bsp_layer();
  int splits = 0;
  for (int y = 10; y < 30; ++y)
    for (int x = 30; x < 50; ++x)
      if (glm::distance(color(picture, 80 * y + x), swatch(layer, 1)) < 1e-6) {
        // x = 0.05 is column 40.5: its center counts to either side.
        EXPECT_TRUE(x == 39 || x == 40) << x << ", " << y;
        ++splits;
      }
  EXPECT_GE(splits, 14) << "but for the wall's own pixels and the corner where four parts meet";
}

}  // namespace surface_splits_test
