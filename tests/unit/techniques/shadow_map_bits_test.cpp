// What texels store depth in, and which faces of closed casters they show.
#include <gtest/gtest.h>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace shadow_map_bits_test {
using namespace gnomon;

class ShadowMapBits : public testing::Test {
 protected:
  ShadowMapBits() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_shadow_map, settings, scene, light, g);
  }
};

/// A ground that a sun sees under a right angle, and a box on a mast that makes the range of depth as long as `height`.
Scene tower(float height) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-0.5f, 0, -0.5f}, {0.5f, height, 0.5f})};
  return scene;
}
const Light noon{.name = "noon", .kind = DirectionalLight{{0.02f, -1, 0.03f}}};
const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

// Under parallel rays stored depths are rounded to half a step, the range of depth over 2^bits, each way: 16 bits over 1 km are
// 15 mm, and without a bias about half of a plane that rises through many steps is dark.
TEST_F(ShadowMapBits, stored_depths_are_rounded_to_half_a_step) {
  const Scene scene = tower(1000);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const auto& [bits, step] : {std::pair("16", 0x1p-16), std::pair("24", 0x1p-24), std::pair("32", 0x1p-24)}) {
    const auto map = run(std::string("resolution=512,bias=constant,depth_bias=0,depth_bits=") + bits, scene, noon, g);
    const auto fine = run("resolution=512,bias=constant,depth_bias=0", scene, noon, g);
    double most = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, noon, i)) continue;
      const auto a = map.technique->explain(i), b = fine.technique->explain(i);
      if (a->taps.empty() || !std::isfinite(a->taps[0].stored) || !std::isfinite(b->taps[0].stored)) continue;
      most = std::max(most, std::abs(a->taps[0].stored - b->taps[0].stored));
    }
    EXPECT_LE(most, 0.5 * 1001 * step * 1.01 + 2e-4) << bits;
    if (std::string(bits) == "16") {
      EXPECT_GT(most, 0.25 * 1001 * step);
    }
  }
}

// The bias of the receiver's plane has room for what texels round.
TEST_F(ShadowMapBits, receiver_planes_leave_no_acne_with_any_bits) {
  for (const float height : {2.0f, 1000.0f}) {
    const Scene scene = tower(height);
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : {noon, Light{.name = "point", .kind = PointLight{{3, height + 2, 1}}}})
      for (const std::string bits : {"16", "24", "32"}) {
        const auto map = run("resolution=512,bias=receiver_plane,depth_bias=0,depth_bits=" + bits, scene, light, g);
        int acne = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          const bool is_aside = glm::length(glm::dvec2(g.position(i).x, g.position(i).z)) > 1.5;
          if (map.mask[i] != 0 || !faces_light(scene, g, light, i) || g.normal(i).y < 0.99 || !is_aside) continue;
          const auto why = map.technique->explain(i);  // dark by itself, not by the tower's edge
          acne += std::ranges::any_of(why->taps, [&](const Tap& tap) {
            return tap.stored > glm::distance(glm::dvec3(g.position(i)), tap.origin) - 0.5;
          });
        }
        EXPECT_EQ(acne, 0) << light.name << ' ' << height << ' ' << bits;
      }
  }
}

// 16 bits over 100 km leave steps of 1.5 m, which the table notes.
TEST_F(ShadowMapBits, coarse_steps_are_noted_with_their_length) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto technique = registry.techniques()[0].make();
  technique->apply("depth_bits=16");
  const Scene scene = tower(100'000);
  const Support support = technique->supports(scene, noon, view);
  EXPECT_EQ(support.kind(), Support::Kind::approximate);
  EXPECT_EQ(support.why(), "16 bits of depth leave steps of 1.5 m where the scene ends");
  technique->apply("depth_bits=24");
  EXPECT_EQ(technique->supports(scene, noon, view).kind(), Support::Kind::full);
}

// Of a closed box, front faces are the top, back faces the bottom: without a bias the top darkens itself by what the map shows
// of it, and not by what lies a meter below. Open casters are drawn whole.
TEST_F(ShadowMapBits, back_faces_leave_the_lit_side_alone) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-1, 1, -1}, {1, 2, 1})};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {3, 6, 5}, .target = {0, 1.5f, 0}}, 120, 90);
  const Light sun{.name = "sun", .kind = DirectionalLight{{0.3f, -1, 0.2f}}};
  const auto dark_on_top = [&](const std::string& faces) {
    const auto map = run("resolution=256,bias=constant,depth_bias=0,faces=" + faces, scene, sun, g);
    int dark = 0;
    for (std::size_t i = 0; i < g.size(); ++i) dark += g.normal(i).y > 0.99 && g.position(i).y > 1.9 && map.mask[i] == 0;
    return dark;
  };
  EXPECT_GT(dark_on_top("front"), 200);
  EXPECT_EQ(dark_on_top("back"), 0);
  EXPECT_EQ(run("faces=both", scene, sun, g).mask, run("faces=front", scene, sun, g).mask);

  Scene open = scene;
  open.meshes[1].triangles.resize(2);
  finish(open.meshes[1]);
  EXPECT_EQ(run("faces=back", open, sun, g).mask, run("faces=front", open, sun, g).mask);
}

}  // namespace shadow_map_bits_test
