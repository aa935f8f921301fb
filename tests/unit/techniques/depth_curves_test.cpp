// The curve of a picked texel beside the exact one, of the maps that hold what several surfaces let through.
#include "glass_stack.h"

namespace depth_curves_test {
using namespace glass_maps_rig;
using namespace glass_stack;

constexpr const char* ids[] = {"transmittance_map", "stochastic_map", "moment_transmittance", "fourier_opacity"};

class DepthCurves : public TestRig {
 protected:
  /// The pixel nearest to the center of a receiver.
  static std::size_t pixel_of(const GBuffer& gbuffer, std::uint32_t receiver) {
    const glm::vec3 center(static_cast<float>(receiver) - 1, receiver_heights[receiver], 0);
    std::size_t nearest = 0;
    float least = INFINITY;
    for_receivers(gbuffer, [&](std::size_t i, std::size_t k) {
      const float distance = glm::distance(gbuffer.position(i), center);
      if (k != receiver || distance >= least) return;
      nearest = i;
      least = distance;
    });
    EXPECT_LT(least, 0.1f);
    return nearest;
  }
  /// Between two points of a curve that is sampled densely.
  static double at(const SharesAlong& curve, double depth) {
    const std::size_t k = static_cast<std::size_t>(std::ranges::lower_bound(curve.depth, depth) - curve.depth.begin());
    if (k == 0) return curve.share.front();
    if (k == curve.depth.size()) return curve.share.back();
    const double along = (depth - curve.depth[k - 1]) / (curve.depth[k] - curve.depth[k - 1]);
    return curve.share[k - 1] + along * (curve.share[k] - curve.share[k - 1]);
  }
};

// From the point and the spot, 10 m high, a ray meets the sheets at 2, 5 and 7 m times 1 / cos of its angle to the vertical.
// The sun's ray is |(0.02, -1, 0.01)| times as long as it is high: 3 m of height from the first sheet to the second, 2 m from
// there to the third, 2 m on to the lowest receiver. The texel's ray is at most half a texel of some 8 mm beside the point, and
// slants by 1/45: less than 1 mm.
TEST_F(DepthCurves, the_exact_one_falls_at_the_sheets) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const std::size_t pixel = pixel_of(gbuffer, 2);
  const double slant = glm::length(glm::dvec3(0.02, -1, 0.01));
  for (const char* id : ids)
    for (const Light& light : scene.lights) {
      const auto map = run(id, "", scene, light, gbuffer);
      const std::optional<DepthCurve> curve = map.technique->depth_curve(pixel);
      ASSERT_TRUE(curve) << id << ' ' << light.name;
      const double expected[] = {1, 1, .5, .5, .375, .375, .075, .075};
      ASSERT_EQ(curve->exact.share.size(), 8u) << id << ' ' << light.name;
      for (int k = 0; k < 8; ++k) EXPECT_NEAR(curve->exact.share[k], expected[k], 1e-7) << k;
      const std::vector<double>& depth = curve->exact.depth;
      ASSERT_EQ(depth.size(), 8u);
      for (const int k : {1, 3, 5}) EXPECT_EQ(depth[k], depth[k + 1]) << "a step";
      const double looked_up = curve->receiver + map.technique->explain(pixel)->bias;
      if (light.name == "sun") {
        EXPECT_NEAR(depth[3] - depth[1], 3 * slant, 1e-4);
        EXPECT_NEAR(depth[5] - depth[3], 2 * slant, 1e-4);
        EXPECT_NEAR(looked_up - depth[5], 2 * slant, 1e-3);
      } else {
        EXPECT_GE(depth[1], 2 - 1e-6);
        EXPECT_NEAR(depth[3] / depth[1], 5 / 2., 1e-4);
        EXPECT_NEAR(depth[5] / depth[1], 7 / 2., 1e-4);
        EXPECT_NEAR(looked_up / depth[1], 9 / 2., 1e-2) << "in half a texel it is nearer or farther by its slant";
      }
    }
}

// A list of all surfaces is exact; of 16 samples each is covered at a sheet, and nowhere else.
TEST_F(DepthCurves, lists_and_samples_step_at_the_sheets_alone) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const std::size_t pixel = pixel_of(gbuffer, 2);
  for (const Light& light : scene.lights)
    for (const char* filter : {"filter=nearest", "filter=bilinear"}) {
      const DepthCurve all = run(ids[0], filter, scene, light, gbuffer).technique->depth_curve(pixel).value(),
                       samples = run(ids[1], filter, scene, light, gbuffer).technique->depth_curve(pixel).value();
      const std::vector<double>& depth = all.held.depth;
      ASSERT_EQ(depth, samples.held.depth);
      const double unit = (depth.back() - depth.front()) / static_cast<double>(depth.size() - 1);
      int compared = 0;
      for (std::size_t k = 0; k + 1 < depth.size(); ++k) {
        // Of the bilinear filter the four rays meet a sheet within a texel's width of each other.
        const auto is_near = [&](double step) { return std::abs(depth[k] - step) < 4 * unit; };
        if (std::ranges::any_of(all.exact.depth, is_near)) continue;
        ++compared;
        EXPECT_NEAR(all.held.share[k], at(all.exact, depth[k]), 1e-6) << light.name << ' ' << filter << ' ' << depth[k];
        EXPECT_NEAR(samples.held.share[k], samples.held.share[k + 1], 1e-6) << light.name << ' ' << filter << ' ' << depth[k];
        if (filter == std::string_view("filter=nearest")) {
          EXPECT_EQ(16 * samples.held.share[k], std::round(16 * samples.held.share[k]));
        }
      }
      EXPECT_GT(compared, 900);
      EXPECT_NEAR(samples.held.share.front(), 1, 1e-6);
      EXPECT_LT(samples.held.share.back(), 0.5);
    }
}

TEST_F(DepthCurves, each_has_the_answer_of_the_mask_at_the_receiver) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  for (const char* id : ids)
    for (const char* filter : {"filter=nearest", "filter=bilinear"})
      for (const Light& light : scene.lights) {
        const auto map = run(id, filter, scene, light, gbuffer);
        for (std::uint32_t receiver = 0; receiver < 3; ++receiver) {
          const std::size_t pixel = pixel_of(gbuffer, receiver);
          const DepthCurve curve = map.technique->depth_curve(pixel).value();
          EXPECT_NEAR(at(curve.held, curve.receiver), map.mask[pixel], 1e-3) << id << ' ' << filter << ' ' << light.name;
          EXPECT_NEAR(at(curve.exact, curve.receiver), left[receiver], 1e-6) << id << ' ' << filter << ' ' << light.name;
        }
      }
}

// Under the spot, which looks straight down, the sheets have one depth in all texels. So what the texel of the lowest receiver
// holds at 3.5 and 6 m of height below the spot is what resolve answers for receivers there. The first sheet is at 2 m.
TEST_F(DepthCurves, one_texel_has_the_answers_of_receivers_at_other_depths) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  for (const char* id : {"moment_transmittance", "fourier_opacity"}) {
    const auto map = run(id, "depth_bias=0.01,slope_bias=0", scene, high_spot, gbuffer);
    const DepthCurve curve = map.technique->depth_curve(pixel_of(gbuffer, 2)).value();
    const double meter = curve.exact.depth[1] / 2;  // of height, along the ray
    for (std::uint32_t receiver = 0; receiver < 2; ++receiver)
      EXPECT_NEAR(at(curve.held, (10 - receiver_heights[receiver]) * meter), map.mask[pixel_of(gbuffer, receiver)], 2e-3) << id;
  }
}

TEST_F(DepthCurves, there_is_none_without_glass_or_a_look_up_or_of_other_techniques) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const std::size_t pixel = pixel_of(gbuffer, 2);
  std::size_t background = 0;
  while (background < gbuffer.size() && !gbuffer.is_background(background)) ++background;
  ASSERT_LT(background, gbuffer.size());
  Scene bare = scene;
  for (Mesh& mesh : bare.meshes) mesh.casts = mesh.casts && !mesh.transmission;
  for (const char* id : ids) {
    EXPECT_FALSE(run(id, "", scene, steep_sun, gbuffer).technique->depth_curve(background)) << id;
    EXPECT_FALSE(run(id, "", bare, steep_sun, gbuffer).technique->depth_curve(pixel)) << id;
  }
  EXPECT_FALSE(run("shadow_map", "", scene, steep_sun, gbuffer).technique->depth_curve(pixel));
  EXPECT_FALSE(run("embree_rays", "", scene, steep_sun, gbuffer).technique->depth_curve(pixel));
}

// Each light has texels of its own; programs are shared.
TEST_F(DepthCurves, another_light_has_its_own) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const std::size_t pixel = pixel_of(gbuffer, 1);
  for (const char* id : ids) {
    const auto map = run(id, "", scene, steep_sun, gbuffer);
    const DepthCurve before = map.technique->depth_curve(pixel).value();
    small_world::Run other{map.technique->for_another_light(), {}};
    answer(other, high_spot, gbuffer);
    const DepthCurve of_spot = run(id, "", scene, high_spot, gbuffer).technique->depth_curve(pixel).value();
    EXPECT_EQ(other.technique->depth_curve(pixel).value().held.share, of_spot.held.share) << id;
    EXPECT_EQ(map.technique->depth_curve(pixel).value().held.share, before.held.share) << id;
    EXPECT_NE(before.held.depth, of_spot.held.depth) << id;
  }
}

}  // namespace depth_curves_test
