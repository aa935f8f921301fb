// The alias-free map: a triangle on paper, points on the lines of the grid, layers, and what is refused.
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "small_world.h"

extern "C" void gnomon_technique_alias_free_map(gnomon::Registry& registry);

namespace gnomon::alias_free_map_test {

using namespace hand_made;
using hand_made::Picture;
using small_world::value;

small_world::Run run(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings = "") {
  return small_world::run(gnomon_technique_alias_free_map, settings, scene, light, gbuffer);
}

// A triangle with a right angle in the plane y = 2, under a light at (0, 4, 0), has on the floor a shadow of twice its size:
// x, z >= 0 and x + z <= 2. Its edges belong to it.
TEST(AliasFreeMap, one_triangle_on_paper) {
  Scene scene;
  scene.meshes = {square(10, 0), mesh_of({{0, 2, 0}, {0, 2, 1}, {1, 2, 0}}, {{0, 1, 2}})};
  struct Case {
    glm::vec3 point;
    bool dark;
  };
  const Case cases[] = {
      {{0.5f, 0, 0.5f}, true},
      {{0.25f, 1, 0.25f}, true},
      {{0.25f, 3, 0.25f}, false},
      {{1, 0, 1}, true},
      {{0, 0, 1}, true},
      {{2, 0, 0}, true},
      {{0, 0, 0}, true},
      {{1, 0, 1.0001f}, false},
      {{-0.0001f, 0, 1}, false},
      {{1, 0x1p-20f, 1}, false},
      {{1, -0x1p-20f, 1}, true},
      {{-0.5f, 0, -0.5f}, false},
      {{1.5f, 0, 1.5f}, false},
      {{0.5f, 2, 0.25f}, false},
      {{-0.25f, 5, -0.25f}, false},
      {{0.5f, 1.9999f, 0.5f}, true},
  };
  Picture picture(std::size(cases), 1);
  for (std::size_t i = 0; i < std::size(cases); ++i) {
    const bool above = cases[i].point.y > 4;
    picture.set(i, cases[i].point, {0, above ? -1 : 1, 0}, 0, cases[i].point.x < cases[i].point.z ? 0 : 1);
  }
  const Light light = point_light({0, 4, 0});
  for (const char* settings : {"", "resolution=16", "resolution=4096"}) {
    const auto done = run(scene, light, picture.gbuffer, settings);
    for (std::size_t i = 0; i < std::size(cases); ++i) {
      SCOPED_TRACE(i);
      EXPECT_EQ(done.mask[i] == 0, cases[i].dark);
      const auto why = done.technique->explain(i);
      ASSERT_TRUE(why);
      EXPECT_TRUE(why->covered);
      ASSERT_EQ(why->element.has_value(), cases[i].dark);
      if (cases[i].dark) {
        EXPECT_EQ(*why->element, 2u);
      }
    }
    EXPECT_EQ(value(done.technique->counts(), "samples"), std::size(cases));
    EXPECT_GE(value(done.technique->counts(), "exact_tests"), 4);  // the points under edges and corners
  }
}

// Samples on a lattice that the grid's lines go through, for 16 x 16 and 32 x 32 cells of the box 0 .. 4, under squares whose
// edges lie on the same lines, straight below a sun. A point is dark when it lies in a closed square.
TEST(AliasFreeMap, points_on_the_lines_of_the_grid_and_under_edges) {
  Scene scene;
  scene.meshes = {square(10, 0)};
  Random random(1);
  struct Box {
    float x0, x1, z0, z1;
  };
  std::vector<Box> boxes;
  for (int i = 0; i < 12; ++i) {
    const auto line = [&](std::uint32_t count) { return static_cast<float>(random.below(count)) / 8; };
    const float x = line(24), z = line(24), w = 0.125f + line(8), d = 0.125f + line(8);
    boxes.push_back({x, x + w, z, z + d});
    const float y = 1 + static_cast<float>(i);
    scene.meshes.push_back(mesh_of({{x, y, z}, {x, y, z + d}, {x + w, y, z + d}, {x + w, y, z}}, {{0, 1, 2}, {0, 2, 3}}));
  }
  Picture picture(33, 33);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const float x = static_cast<float>(i % 33) / 8, z = static_cast<float>(i / 33) / 8;
    picture.set(i, {x, 0, z}, {0, 1, 0}, 0, x < z ? 0 : 1);
  }
  for (const char* settings : {"resolution=16", "resolution=32", "resolution=33", "resolution=512"}) {
    const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer, settings);
    int dark = 0;
    for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
      const glm::vec3 p = picture.gbuffer.position(i);
      const bool covered =
          std::ranges::any_of(boxes, [&](const Box& b) { return p.x >= b.x0 && p.x <= b.x1 && p.z >= b.z0 && p.z <= b.z1; });
      EXPECT_EQ(done.mask[i] == 0, covered) << p.x << ", " << p.z;
      dark += covered;
    }
    EXPECT_GT(dark, 200);
    EXPECT_LT(dark, 900);
    EXPECT_GT(value(done.technique->counts(), "exact_tests"), 100);
  }
}

TEST(AliasFreeMap, area_lights_are_refused_with_a_reason) {
  Registry roll;
  gnomon_technique_alias_free_map(roll);
  const auto technique = roll.technique("alias_free_map").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// Five points of a floor under a sun, four of them in one of 16 x 16 cells. The sun sees two squares: one over the four, one
// over none, which nothing is tested against. The floor's own two triangles walk too. So the four have the longest list and the
// most tests, and both layers show them brighter than the fifth.
TEST(AliasFreeMap, layers_show_the_lists_and_the_tests) {
  Scene scene;
  scene.meshes = {square(10, 0), mesh_of({{-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}, {1, 1, -1}}, {{0, 1, 2}, {0, 2, 3}}),
                  mesh_of({{5, 1, 5}, {5, 1, 6}, {6, 1, 6}, {6, 1, 5}}, {{0, 1, 2}, {0, 2, 3}})};
  Picture picture(6, 1);
  for (int i = 0; i < 4; ++i) picture.set(i, {0.01f * static_cast<float>(i), 0, 0.005f}, {0, 1, 0}, 0, 1);
  picture.set(4, {4, 0, -4}, {0, 1, 0}, 0, 1);
  const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer, "resolution=16");
  EXPECT_EQ(done.mask, (std::vector<float>{0, 0, 0, 0, 1, 1}));
  const Counts counts = done.technique->counts();
  EXPECT_EQ(value(counts, "samples"), 5);
  EXPECT_EQ(value(counts, "cells_used"), 2);
  EXPECT_EQ(value(counts, "longest_list"), 4);
  EXPECT_LE(value(counts, "sample_tests"), 5 * 2 + 4 * 2);
  EXPECT_GE(value(counts, "sample_tests"), 5 * 1 + 4 * 1);
  for (const char* layer : {"list", "tests"}) {
    SCOPED_TRACE(layer);
    const std::vector<float> picture_of = done.technique->draw_debug(layer);
    const auto pixel = [&](int i) { return std::vector<float>(picture_of.begin() + 3 * i, picture_of.begin() + 3 * i + 3); };
    EXPECT_NE(pixel(0), pixel(4));
    EXPECT_NE(pixel(4), pixel(5));
  }
  EXPECT_EQ(done.technique->draw_debug("list")[0], done.technique->draw_debug("list")[3]);
  EXPECT_THROW(done.technique->draw_debug("map"), std::exception);
}

}  // namespace gnomon::alias_free_map_test
