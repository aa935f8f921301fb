// What every technique must say that finds soft shadows from geometry, of lights and casters that stand in each other's way.
#include <gtest/gtest.h>

#include "area_lights.h"
#include "device/context.h"
#include "hand_made.h"
#include "small_world.h"

namespace soft_from_geometry_test {
using namespace gnomon;

/// Those that decide any point by triangles, without texels.
class SoftFromGeometry : public testing::TestWithParam<const char*> {
 protected:
  SoftFromGeometry() { process_context(); }

  /// What one point of the ground sees of a light under casters.
  static float at_origin(const std::vector<Mesh>& casters, const Light& light) {
    Scene scene;
    scene.meshes = {small_world::ground(4)};
    scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
    hand_made::Picture picture(1, 1);
    picture.set(0, {0, 0, 0}, {0, 1, 0}, 0, 0);
    const auto technique = registry().technique(GetParam()).make();
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    VisibilityMask mask(1, 1);
    technique->resolve(picture.gbuffer, mask);
    return mask.read()[0];
  }
};

TEST_P(SoftFromGeometry, a_light_in_a_closed_mesh_is_hidden_and_one_whose_mesh_is_open_below_is_seen) {
  const Mesh closed = small_world::box({-2, 2, -2}, {2, 4, 2});
  Mesh open = closed;
  std::erase_if(open.triangles, [&](const glm::uvec3& t) {
    return open.positions[t.x].y == 2 && open.positions[t.y].y == 2 && open.positions[t.z].y == 2;
  });
  finish(open);
  for (const Light& light : {rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1}), disc({0, 3, 0}, {0, -1, 0}, 1), sphere({0, 3, 0}, 0.9f)}) {
    EXPECT_EQ(at_origin({closed}, light), 0) << kind_name(light);
    EXPECT_EQ(at_origin({open}, light), 1) << kind_name(light);
  }
}

TEST_P(SoftFromGeometry, points_on_the_plane_of_the_light_or_in_it_are_left_lit) {
  const Mesh roof = hand_made::square(5, 2);
  EXPECT_EQ(at_origin({roof}, rect({3, 0, 0}, {1, 0, 0}, {0, 0, 1})), 1);
  EXPECT_EQ(at_origin({roof}, disc({0, 0, 0}, {0, 1, 0}, 1)), 1);
  EXPECT_EQ(at_origin({roof}, sphere({0, 0.5f, 0}, 1)), 1);
}

TEST_P(SoftFromGeometry, a_caster_a_hair_below_the_light_hides_what_it_covers) {
  const Light level = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(at_origin({hand_made::square(5, 2.999f)}, level), 0);
  EXPECT_EQ(at_origin({hand_made::square(0.5f, 3.001f)}, level), 1);
}

// Half of the light is behind the plate from -1 to 0, but for what a hundred places cannot tell.
TEST_P(SoftFromGeometry, triangles_without_area_change_nothing) {
  const std::vector<glm::vec3> corners{{-1, 1, -9}, {-1, 1, 9}, {0, 1, 9}, {0, 1, -9}, {0, 1, 0}};
  const Light light = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  const float plain = at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}})}, light);
  EXPECT_NEAR(plain, 0.5, 0.13);
  EXPECT_NEAR(at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}, {3, 4, 2}, {3, 3, 2}})}, light), plain, 1e-6);
}

TEST_P(SoftFromGeometry, lights_as_small_as_float32_allows_are_hard) {
  const Mesh plate = small_world::make_mesh({{-1, 1, -9}, {-1, 1, 9}, {0.01f, 1, 9}, {0.01f, 1, -9}}, {{0, 1, 2}, {0, 2, 3}});
  for (const float size : {1e-3f, 1e-6f, 1e-20f})
    for (const float x : {-0.2f, 0.2f})
      for (const Light& light :
           {rect({x, 3, 0}, {size, 0, 0}, {0, 0, size}), disc({x, 3, 0}, {0, -1, 0}, size), sphere({x, 3, 0}, size)})
        EXPECT_EQ(at_origin({plate}, light), x > 0 ? 1 : 0) << kind_name(light) << " of " << size << " m at " << x;
}

INSTANTIATE_TEST_SUITE_P(all, SoftFromGeometry,
                         testing::Values("averaged_hard", "exact_area", "soft_volume", "penumbra_wedge", "area_svbsp"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace soft_from_geometry_test
