#include <gtest/gtest.h>

#include "device/context.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace shadow_map_cube_test {
using namespace gnomon;

// The six faces of a cube are fitted one by one, so their biases must not mix. A chip 1 cm beside the light fills the +x face
// with casters from 1 cm on. In the -y face a plate hovers 10 cm above the ground, 4 m below the light: its shadow is 10 cm
// behind its caster. The rounding allowance of a depth grows as z^2 / (near far): with the -y face's own planes it is about
// 4e-6 m * 16 / (3.9 * 4) = 4e-6 m, with those of the +x face 4e-6 * 16 / 1e-4 = 0.6 m, and the shadow would be gone.
TEST(ShadowMapCube, a_near_caster_in_one_face_does_not_widen_the_bias_of_another) {
  process_context();
  Scene scene;
  scene.meshes = {
      small_world::ground(3, -4), small_world::ground(1, -3.9f),
      small_world::make_mesh({{0.01f, -0.004f, -0.004f}, {0.01f, 0.004f, -0.004f}, {0.01f, 0, 0.004f}}, {{0, 1, 2}})};
  const Light light{.name = "point", .kind = PointLight{{0, 0, 0}}};
  // From the side, below the plate, so that the ground in its shadow is seen.
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {4, -3.6f, 0}, .target = {0, -4, 0}}, 96, 54);
  const auto run = small_world::run(gnomon_technique_shadow_map, "", scene, light, g);
  int dark = 0, wrong = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i) || g.mesh[i] != 0) continue;
    // The plate's shadow on the ground is the square |x|, |z| <= 4 / 3.9; stay 2 cm off its edge.
    const float reach = std::max(std::abs(g.px[i]), std::abs(g.pz[i]));
    if (std::abs(reach - 4 / 3.9f) < 0.02f) continue;
    const bool expected = reach < 4 / 3.9f;
    dark += expected;
    wrong += (run.mask[i] < 0.5f) != expected;
  }
  EXPECT_GT(dark, 50);
  EXPECT_EQ(wrong, 0);
}

}  // namespace shadow_map_cube_test
