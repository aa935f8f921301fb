#include <gnomon/kit/maps/map_comparison.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_scene_fence(gnomon::Registry&);
extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace shadow_map_filter_test {
using namespace gnomon;

class ShadowMapFilter : public testing::Test {
 protected:
  ShadowMapFilter() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_shadow_map, settings, scene, light, g);
  }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

// Wide filters compare with texels farther away, over which depth spreads more: the bias grows with them, so a lit slope has no
// acne at all, be it less than half of the taps.
TEST_F(ShadowMapFilter, filters_leave_no_acne_on_a_slope_that_one_texel_leaves_none_on) {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : {Light{.name = "sun", .kind = DirectionalLight{{1, -0.4f, 0.3f}}},
                             Light{.name = "point", .kind = PointLight{{2, 1, 2}}}})
    for (const std::string bias : {"slope", "receiver_plane"})
      for (const std::string filter :
           {"nearest", "pcf,filter_radius=1", "pcf,filter_radius=4", "disc,filter_radius=3", "bilinear"}) {
        const auto shadow_map = run("resolution=128,bias=" + bias + ",filter=" + filter, scene, light, g);
        EXPECT_EQ(std::ranges::count_if(shadow_map.mask, [](float v) { return v < 1; }), 0)
            << light.name << ' ' << bias << ' ' << filter;
      }
}

// Of every filter: weights sum to 1, none is negative, and all texels lie within the margin; the disc's and the bilinear
// filter's centers of weight follow the point to a tenth of a texel and exactly.
TEST(shadow_map_filter, weights_are_shares_around_the_point) {
  using Filter = MapFilter;
  using FilterKind = MapFilter::Kind;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(10, 20);
  for (const Filter filter : {Filter{FilterKind::nearest, 0}, Filter{FilterKind::pcf, 3}, Filter{FilterKind::disc, 1},
                              Filter{FilterKind::disc, 5}, Filter{FilterKind::bilinear, 0}})
    for (int round = 0; round < 200; ++round) {
      const glm::dvec2 point{place(random), place(random)};
      double sum = 0, farthest = 0;
      glm::dvec2 center(0);
      for (const auto& [texel, weight] : filter.texels(point)) {
        EXPECT_GE(weight, 0);
        sum += weight;
        center += weight * (glm::dvec2(texel) + 0.5);
        const glm::ivec2 aside = glm::abs(texel - glm::ivec2(point));
        EXPECT_LE(std::max(aside.x, aside.y), filter.margin());
        if (weight > 0) farthest = std::max(farthest, glm::distance(glm::dvec2(texel) + 0.5, point));
      }
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_LE(farthest, filter.reach() * std::sqrt(0.5) + 1e-9);
      if (filter.kind == FilterKind::bilinear) {
        EXPECT_NEAR(glm::distance(center, point), 0, 1e-9);
      }
      if (filter.kind == FilterKind::disc) {
        EXPECT_LT(glm::distance(center, point), 0.25);
      }
    }
}

// A filter and an offset may reach farther than the image has texels: then nothing would be left to fit, and all be lit.
TEST_F(ShadowMapFilter, filter_and_offset_that_leave_too_little_of_the_image_are_unsupported) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto supports = [&](const std::string& settings) {
    const auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique->supports({}, {.kind = PointLight{}}, {});
  };
  const Support refused = supports("resolution=64,bias=normal_offset,filter=pcf,filter_radius=8");
  EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
  EXPECT_EQ(refused.why(), "filter and offset reach 35 texels beyond what an image of 64 is fitted to: it needs 140 or more");
  EXPECT_TRUE(supports("resolution=140,bias=normal_offset,filter=pcf,filter_radius=8"));
  EXPECT_TRUE(supports("resolution=64,filter=pcf,filter_radius=8"));
}

// Wrong pixels follow the width of texels: fitted to the view, a map has at least 0.8 of the gain that its texels predict.
TEST_F(ShadowMapFilter, a_fit_to_the_view_gains_what_its_texels_predict) {
  Registry registry;
  gnomon_scene_fence(registry);
  const Scene fence = registry.scenes()[0].make()->make();
  double before = 0, after = 0, texels_before = 0, texels_after = 0;
  for (const View& from : fence.views)
    for (const Light& light : fence.lights) {
      if (has_area(light)) continue;
      const GBuffer g = small_world::make_gbuffer(fence, from, 240, 135);
      std::vector<bool> dark(g.size());
      for (std::size_t i = 0; i < g.size(); ++i)
        dark[i] = faces_light(fence, g, light, i) && small_world::caster_distance(fence, light, g.position(i)) < INFINITY;
      const auto count = [&](const std::string& fit, double& wrong, double& width) {
        const auto map = run("resolution=512,fit=" + fit, fence, light, g);
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(fence, g, light, i)) continue;
          wrong += dark[i] != (map.mask[i] < 0.5f);
          width += map.technique->explain(i)->texel_width;
        }
      };
      count("scene", before, texels_before);
      count("view", after, texels_after);
    }
  const double predicted = texels_before / texels_after - 1, reached = before / after - 1;
  EXPECT_GT(predicted, 0.3);
  EXPECT_GE(reached, 0.8 * predicted) << before << " wrong pixels became " << after;
}

}  // namespace shadow_map_filter_test
