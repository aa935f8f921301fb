// The second pass of svbsp: polygons of the regular BSP tree painted back to front.
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <set>

#include "surface_world.h"
#include "techniques/svbsp/paint_bsp.h"

namespace svbsp_painter_test {

using namespace gnomon;
using namespace surface_world;
using namespace svbsp;

TEST(SvbspPainter, painted_back_to_front_equals_the_depth_buffered_picture) {
  int plain = 0, shadowed = 0, elsewhere = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    World world(seed, seed % 3 == 0);
    const Bsp bsp(world.scene);
    const Shadow shadow(world.scene.meshes[0], world.light);
    const DetailOf detail_of = [&](const BspPolygon& polygon, DetailBrush& brush) {
      const auto corners = bsp.corners(polygon);
      if (polygon.triangle == 0) return;  // it does not shade itself
      shadow.divide({corners.begin(), corners.end()},
                    [&](const Polygon& part, bool is_lit) { brush.paint(std::span<const Corner>(part), is_lit); });
    };
    Random random(seed);
    for (int eye = 0; eye < 4; ++eye) {  // the light stays, the eye moves, always among the triangles
      const std::vector<float> painted = paint_back_to_front(world.scene, world.gbuffer, world.light, bsp, detail_of);
      const std::vector<float> wanted = shaded_layer(world.scene, world.gbuffer, world.light, world.mask);
      for (std::size_t i = 0; i < world.gbuffer.size(); ++i) {
        const float difference = largest(color(painted, i) - color(wanted, i));
        if (world.is_plain(i)) {
          ASSERT_LT(difference, 2e-6f) << "seed " << seed << " eye " << eye << " pixel " << i;
          ++plain;
          shadowed += world.mask[i] == 0;
        } else {
          elsewhere += difference > 2e-6f;
        }
      }
      world.look(glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2))),
                 glm::vec3(random.uniform(glm::dvec3(-1), glm::dvec3(1))));
    }
  }
  EXPECT_GT(plain, 400'000);
  EXPECT_GT(shadowed, 3000);
  // At edges, too, both test pixel centers.
  EXPECT_LT(elsewhere, 30);
}

TEST(SvbspPainter, asks_about_what_faces_eye_and_light) {
  // A floor of two triangles, a mesh without any, and a plate above half of it: from above all four face eye and light, from
  // below none; a mesh that does not receive is not tested.
  Scene scene;
  scene.meshes = {hand_made::square(2, 0), Mesh{}, hand_made::square(1, 0.5f)};
  scene.meshes[0].albedo = {0.9f, 0.1f, 0.1f};
  scene.meshes[2].albedo = {0.1f, 0.1f, 0.9f};
  const Bsp bsp(scene);
  const Light light = sun({0, -1, 0});
  const auto asked = [&](float height) {
    const GBuffer gbuffer =
        small_world::make_gbuffer(scene, {.eye = {0.1f, height, 0.2f}, .target = {0, 0, 0}, .up = {0, 0, -1}}, 16, 16);
    std::multiset<std::uint32_t> triangles;
    const std::vector<float> painted = paint_back_to_front(
        scene, gbuffer, light, bsp, [&](const BspPolygon& polygon, DetailBrush&) { triangles.insert(polygon.triangle); });
    EXPECT_EQ(painted.size(), 3 * gbuffer.size());
    const std::vector<float> wanted = shaded_layer(scene, gbuffer, light, std::vector<float>(gbuffer.size(), 1.0f));
    for (std::size_t k = 0; k < painted.size(); ++k) EXPECT_NEAR(painted[k], wanted[k], 2e-6f);
    return triangles;
  };
  EXPECT_EQ(asked(3), (std::multiset<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_TRUE(asked(-3).empty());
  scene.meshes[0].receives = false;
  EXPECT_EQ(asked(3), (std::multiset<std::uint32_t>{2, 3}));
}

}  // namespace svbsp_painter_test
