#include <gnomon/kit/maps/map_comparison.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

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
      for (const std::string filter : {"nearest", "pcf,filter_radius=1", "pcf,filter_radius=4", "disc,filter_radius=3",
                                       "bilinear", "optimized,filter_radius=3", "bicubic", "rotated,filter_radius=4",
                                       "rotated,filter_radius=2,filter_taps=64", "pcf,filter_radius=4,early_bail=true"}) {
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
                              Filter{FilterKind::disc, 5}, Filter{FilterKind::bilinear, 0}, Filter{FilterKind::optimized, 1},
                              Filter{FilterKind::optimized, 3}, Filter{FilterKind::bicubic, 0}, Filter{FilterKind::rotated, 3}})
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
      if (filter.kind == FilterKind::bilinear || filter.kind == FilterKind::optimized || filter.kind == FilterKind::bicubic) {
        EXPECT_NEAR(glm::distance(center, point), 0, 1e-9);
      }
      if (filter.kind == FilterKind::disc) {
        EXPECT_LT(glm::distance(center, point), 0.25);
      }
    }
}

// Of one axis, at a share s of a texel behind a corner: (1, 2, 1) moved by s is (1 - s, 2 - s, 1 + s, s) / 4, and the cubic
// spline at s = 0 is (1, 4, 1, 0) / 6.
TEST(shadow_map_filter, fixed_weights_move_with_the_point) {
  const auto along = [](const MapFilter& filter, double share) {
    std::map<int, double> sums;
    for (const auto& [texel, weight] : filter.texels({10.5 + share, 20.5})) sums[texel.x] += weight;
    return sums;
  };
  using Kind = MapFilter::Kind;
  for (const double s : {0.0, 0.25, 0.75}) {
    const auto sums = along({Kind::optimized, 1}, s);
    ASSERT_EQ(sums.size(), 4u);
    for (const auto& [x, weight] : {std::pair(9, 1 - s), std::pair(10, 2 - s), std::pair(11, 1 + s), std::pair(12, s)})
      EXPECT_NEAR(sums.at(x), weight / 4, 1e-12) << s;
  }
  const auto sums = along({Kind::bicubic, 0}, 0);
  for (const auto& [x, weight] : {std::pair(9, 1.0), std::pair(10, 4.0), std::pair(11, 1.0), std::pair(12, 0.0)})
    EXPECT_NEAR(sums.at(x), weight / 6, 1e-12);
}

// A spiral has as many of its places within a share q of the radius as the disc has of its area there, q^2. Frames turn it.
TEST(shadow_map_filter, spiral_fills_the_disc_and_frames_turn_it) {
  const MapFilter filter{.kind = MapFilter::Kind::rotated, .radius = 4, .taps = 64};
  for (const double q : {0.25, 0.5, 0.75}) {
    int within = 0;
    for (int k = 0; k < filter.taps; ++k) within += glm::length(filter.spiral(k)) <= 4.5 * q;
    EXPECT_NEAR(within, filter.taps * q * q, 1) << q;
  }
  const auto texels = [](int first, int frames, const glm::ivec2& pixel) {
    const MapFilter turned{.kind = MapFilter::Kind::rotated, .radius = 4, .taps = 8, .first_frame = first, .frames = frames};
    std::vector<std::pair<int, int>> found;
    for (const auto& [texel, weight] : turned.texels({50, 50}, pixel)) found.emplace_back(texel.x, texel.y);
    return found;
  };
  auto both = texels(3, 1, {7, 9});
  EXPECT_NE(both, texels(4, 1, {7, 9}));
  EXPECT_NE(both, texels(3, 1, {8, 9}));
  std::ranges::copy(texels(4, 1, {7, 9}), std::back_inserter(both));
  EXPECT_EQ(texels(3, 2, {7, 9}), both);
}

// What the shader answers is what its explanation adds up to, of every filter, at all but a few pixels where float32 decides.
TEST_F(ShadowMapFilter, masks_are_the_sums_of_their_taps) {
  Scene scene;
  std::mt19937 random(11);
  scene.meshes = {small_world::ground(3), small_world::random_soup(random, 12, 2, 0.5f, 2, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  const Light light{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}};  // depth is then along the rays
  for (const std::string filter :
       {"pcf,filter_radius=2", "disc,filter_radius=2", "optimized,filter_radius=2", "bicubic", "rotated,filter_radius=3",
        "rotated,noise_frame=5,noise_frames=3", "pcf,filter_radius=3,early_bail=true", "bicubic,early_bail=true",
        "rotated,filter_radius=3,early_bail=true", "optimized,early_bail=true"}) {
    const auto run_of = run("resolution=256,bias=constant,depth_bias=1,filter=" + filter, scene, light, g);
    int partly = 0, other = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const auto why = run_of.technique->explain(i);
      ASSERT_TRUE(why) << filter;
      if (why->taps.empty()) continue;  // nothing casts there
      double lit = 0;
      for (const Tap& tap : why->taps)
        lit += tap.stored < glm::dot(glm::dvec3(g.position(i)) - tap.origin, tap.direction) - why->bias ? 0 : tap.weight;
      partly += run_of.mask[i] > 0 && run_of.mask[i] < 1;
      other += std::abs(run_of.mask[i] - lit) > 1e-4;
    }
    EXPECT_GT(partly, 50) << filter;
    EXPECT_LE(other, 20) << filter;
  }
}

// Where all texels of a filter agree, so do five of them: bailing early changes no answer that is 0 or 1 for the whole filter.
TEST_F(ShadowMapFilter, bailing_early_changes_answers_between_alone) {
  Registry registry;
  gnomon_scene_fence(registry);
  const Scene fence = registry.scenes()[0].make()->make();
  const GBuffer g = small_world::make_gbuffer(fence, fence.views[0], 160, 90);
  for (const std::string filter : {"pcf,filter_radius=3", "disc,filter_radius=4", "optimized,filter_radius=3", "bicubic"}) {
    const auto whole = run("resolution=512,filter=" + filter, fence, fence.lights[0], g).mask;
    const auto early = run("resolution=512,early_bail=true,filter=" + filter, fence, fence.lights[0], g).mask;
    int between = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (whole[i] == 0 || whole[i] == 1) {
        EXPECT_EQ(whole[i], early[i]) << filter << ' ' << i;
      }
      between += early[i] > 0 && early[i] < 1;
    }
    EXPECT_GT(between, 20) << filter;
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
  EXPECT_EQ(supports("filter=optimized,filter_radius=4").why(),
            "filter=optimized has weights for filter_radius 1 to 3, not for 4");
  EXPECT_TRUE(supports("filter=optimized,filter_radius=3"));
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
