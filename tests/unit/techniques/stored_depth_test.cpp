// What the texels of a shadow map hold: the first surface, the second, the midpoint of both, or dual depth layers.
#include <gtest/gtest.h>

#include <cmath>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace stored_depth_test {
using namespace gnomon;

class StoredDepths : public testing::Test {
 protected:
  StoredDepths() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

const View view{.eye = {0, 3, 7}, .target = {0, 0, 0}};
const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}}, point{.name = "point", .kind = PointLight{{0, 4, 0}}},
    spot{.name = "spot", .kind = SpotLight{{0, 4, 0}, {0, -1, 0}, 40, 55}},
    slanted{.name = "slanted", .kind = DirectionalLight{{0.5f, -1, 0.25f}}};

auto run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
  return small_world::run(gnomon_technique_shadow_map, "resolution=256," + settings, scene, light, g);
}

// A slab from 0.5 to 1 m over a ground that casts nothing, light from straight above: where the ray of a texel meets it, the
// first surface is at 1 m, the second at 0.5 m, their mean along the axis at 0.75 m; dual layers lie two texels below 1 m, as
// wide as they are there, and at the midpoint where they may be farther.
TEST_F(StoredDepths, of_a_slab_are_its_top_its_bottom_and_what_lies_between) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), small_world::box({-1, 0.5f, -1}, {1, 1, 1})};
  const GBuffer g = small_world::make_gbuffer(scene, view, 48, 36);
  for (const Light& light : {sun, point, spot}) {
    const auto height_of = [&](const std::string& settings, double& texel) {
      const auto map = run(settings, scene, light, g);
      double lowest = INFINITY, highest = -INFINITY;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (g.mesh[i] != 0 || std::abs(g.px[i]) > 0.8f || std::abs(g.pz[i]) > 0.8f) continue;
        const auto why = *map.technique->explain(i);
        const double height = why.taps.at(0).origin.y + why.taps[0].direction.y * why.taps[0].stored;
        lowest = std::min(lowest, height);
        highest = std::max(highest, height);
        texel = why.texel_width * (light.name == "sun" ? 1 : 0.75);  // of the ground, 4 m away; the top is 3 m away
      }
      EXPECT_NEAR(lowest, highest, 1e-4) << settings << ' ' << light.name;
      return lowest;
    };
    double texel = 0;
    EXPECT_NEAR(height_of("stored=first", texel), 1, 1e-4);
    EXPECT_NEAR(height_of("stored=second", texel), 0.5, 1e-4);
    EXPECT_NEAR(height_of("stored=midpoint", texel), 0.75, 1e-4);
    const double dual = height_of("stored=dual,dual_offset=2", texel);
    EXPECT_NEAR(dual, 1 - 2 * texel, 1e-4) << light.name;
    EXPECT_LT(texel, 0.05);
    EXPECT_NEAR(height_of("stored=dual,dual_offset=64", texel), 0.75, 1e-4);
    EXPECT_NEAR(height_of("stored=dual,dual_offset=0", texel), 1, 1e-4);
  }
}

// Single sheets that nothing lies behind, without any bias: where there is no second surface the midpoint is at the far plane,
// and falling back to the first would put acne on the ground. Between a sheet and the ground below it both are right.
TEST_F(StoredDepths, midpoints_need_no_bias_where_open_sheets_lie_above_each_other_and_alone) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::ground(1, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  const auto acne = [&](const std::string& settings) {
    const auto map = run(settings + ",bias=constant,depth_bias=0", scene, slanted, g);
    int count = 0, dark = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, slanted, i)) continue;
      const glm::dvec3 at = g.position(i);
      const bool is_dark = small_world::caster_distance(scene, slanted, at) < INFINITY;
      const auto near_edge = [&](double x, double z) {  // the shadow of the sheet is it, moved by (0.5, 0.25)
        return std::max(std::abs(x - at.x), std::abs(z - at.z)) > 0.9 && std::max(std::abs(x - at.x), std::abs(z - at.z)) < 1.1;
      };
      if (g.mesh[i] == 0 ? near_edge(0.5, 0.25) : near_edge(0, 0)) continue;
      count += !is_dark && map.mask[i] == 0;
      dark += is_dark && map.mask[i] == 0;
    }
    EXPECT_GT(dark, 50) << settings;
    return count;
  };
  EXPECT_GT(acne("stored=first"), 300);
  EXPECT_EQ(acne("stored=midpoint"), 0);
  // Dual layers have no far plane: the offset is what keeps them off a sheet, here more than a texel's spread of depth.
  EXPECT_EQ(acne("stored=dual,dual_offset=2"), 0);
  EXPECT_GT(acne("stored=dual,dual_offset=0"), 300);
}

// A box on a ground that casts, too: below the box the second surface is as far as the ground, and light leaks in under it
// where the texel of a point in its shadow holds box and ground. The midpoint is half a box nearer.
TEST_F(StoredDepths, midpoints_hold_the_shadow_at_a_contact_where_the_second_surface_leaks) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({-1, 0, -1}, {1, 1, 1})};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {2, 0.8f, 0.6f}, .target = {1, 0, 0}}, 160, 120);
  const auto leaks = [&](const std::string& settings) {
    const auto map = run(settings, scene, slanted, g);
    int count = 0, asked = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      // The box's shadow reaches to x = 1.5; a texel is 0.025 m wide.
      if (g.mesh[i] != 0 || g.px[i] < 1 || g.px[i] > 1.1f || std::abs(g.pz[i]) > 0.7f) continue;
      if (!faces_light(scene, g, slanted, i)) continue;
      ++asked;
      count += map.mask[i] != 0;
    }
    EXPECT_GT(asked, 50);
    return count;
  };
  EXPECT_GT(leaks("stored=second"), 20);
  EXPECT_EQ(leaks("stored=midpoint"), 0);
  EXPECT_EQ(leaks("stored=dual"), 0);
}

TEST_F(StoredDepths, every_image_counts) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::ground(1, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 16, 12);
  const auto texels = [&](const std::string& stored) {
    return small_world::value(run("stored=" + stored, scene, sun, g).technique->counts(), "texels") / (256 * 256);
  };
  EXPECT_EQ(texels("first"), 1);
  EXPECT_EQ(texels("second"), 2);
  EXPECT_EQ(texels("midpoint"), 3);
  EXPECT_EQ(texels("dual"), 3);
}

}  // namespace stored_depth_test
