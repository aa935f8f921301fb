// What texels store depth in, and which faces of closed casters they show.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <tuple>

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

/// A ground a hundred meters below a lamp that leans by a tenth, a box on it, and a mote one centimeter before the lamp. Images
/// begin no nearer than 1/1024 of their far end. The mote's shadow is 20 cm wide.
Scene mote_before_lamp() {
  Scene scene;
  scene.meshes = {
      small_world::make_mesh({{-4, -0.4f, -4}, {-4, -0.4f, 4}, {4, 0.4f, 4}, {4, 0.4f, -4}}, {{0, 1, 2}, {0, 2, 3}}),
      small_world::box({1, 0, 1}, {2, 1, 2}), small_world::box({-1e-5f, 99.985f, -1e-5f}, {1e-5f, 99.99f, 1e-5f})};
  return scene;
}
const Light lamp{.name = "lamp", .kind = PointLight{{0, 100, 0}}};
const View before_box{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

/// Pixels of the leaning ground that see the lamp.
std::vector<std::size_t> lit_ground(const Scene& scene, const GBuffer& g) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const glm::dvec3 p = g.position(i);
    const bool is_aside = glm::length(glm::dvec2(p.x, p.z)) > 0.4 && std::min(p.x, p.z) < 0.8;
    if (is_aside && std::abs(p.y - 0.1 * p.x) < 1e-4 && faces_light(scene, g, lamp, i)) found.push_back(i);
  }
  return found;
}

// Around a light depth is near / z. Reversed, a float tells 2^-24 of it apart everywhere, z / 2^24 = 6 um; forward, 1 less it,
// only 2^-24 of the range, z^2 / (near 2^24) = 1024 z / 2^24 = 6 mm. What is stored may be off by two such steps.
TEST_F(ShadowMapBits, forward_floats_have_the_steps_of_24_bits) {
  const Scene scene = mote_before_lamp();
  const GBuffer g = small_world::make_gbuffer(scene, before_box, 96, 72);
  const std::vector<std::size_t> pixels = lit_ground(scene, g);
  EXPECT_GT(pixels.size(), 1000u);
  const double step = 100 * 1024 * 0x1p-24;
  for (const auto& [order, least, most] :
       {std::tuple("reversed", 0.0, step / 16), std::tuple("forward", 0.25 * step, 2 * step)}) {
    const auto map = run(fmt::format("resolution=512,depth_order={}", order), scene, lamp, g);
    double off = 0;
    for (const std::size_t i : pixels) {
      const Tap tap = map.technique->explain(i)->taps.at(0);
      const glm::dvec3 up = glm::dvec3(-0.1, 1, 0);  // across the ground, which holds the origin
      off = std::max(off, std::abs(tap.stored + glm::dot(up, tap.origin) / glm::dot(up, tap.direction)));
    }
    EXPECT_GE(off, least) << order;
    EXPECT_LE(off, most) << order;
  }
}

// A bias of a quarter of a texel, 1 mm, holds the 0.3 mm that a texel of the ground spreads by, and not 6 mm of forward depth.
// The plane of the receiver knows of them.
TEST_F(ShadowMapBits, forward_floats_have_acne_far_from_a_lamp_that_something_is_close_to) {
  const Scene scene = mote_before_lamp();
  const GBuffer g = small_world::make_gbuffer(scene, before_box, 96, 72);
  const std::vector<std::size_t> pixels = lit_ground(scene, g);
  const auto dark = [&](const std::string& settings) {
    const auto map = run("resolution=2048," + settings, scene, lamp, g);
    return std::ranges::count_if(pixels, [&](std::size_t i) { return map.mask[i] == 0; });
  };
  const std::string constant = "bias=constant,depth_bias=0.25,depth_order=";
  EXPECT_EQ(dark(constant + "reversed"), 0);
  EXPECT_GT(dark(constant + "forward"), 100);
  EXPECT_EQ(dark("bias=receiver_plane,depth_bias=0,depth_order=forward"), 0);
}

// Under parallel rays depth is linear, and floats are as fine at one end as at the other. Fixed point has the same steps both
// ways. What stores a second surface stays reversed.
TEST_F(ShadowMapBits, orders_are_alike_under_parallel_rays_and_in_fixed_point) {
  const Scene scene = tower(2);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  const Light point{.name = "point", .kind = PointLight{{3, 4, 1}}};
  const auto differing = [&](const std::string& settings, const Light& light) {
    const auto reversed = run("resolution=256," + settings, scene, light, g),
               forward = run("resolution=256,depth_order=forward," + settings, scene, light, g);
    int count = 0;
    for (std::size_t i = 0; i < g.size(); ++i) count += reversed.mask[i] != forward.mask[i];
    return count;
  };
  for (const std::string bits : {"16", "24", "32"}) EXPECT_LE(differing("depth_bits=" + bits, noon), 2) << bits;
  for (const std::string bits : {"16", "24"}) EXPECT_LE(differing("depth_bits=" + bits, point), 2) << bits;
  for (const std::string stored : {"second", "midpoint", "dual"}) EXPECT_EQ(differing("stored=" + stored, point), 0) << stored;
}

// Twenty kilometers from a lamp steps are 1024 * 20 km / 2^24 = 1.2 m.
TEST_F(ShadowMapBits, coarse_steps_of_forward_floats_are_noted) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto technique = registry.techniques()[0].make();
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::box({-0.001f, 19'990, -0.001f}, {0.001f, 19'992, 0.001f})};
  const Light high{.name = "high", .kind = PointLight{{0, 20'000, 0}}};
  EXPECT_EQ(technique->supports(scene, high, view).kind(), Support::Kind::full);
  technique->apply("depth_order=forward");
  const Support support = technique->supports(scene, high, view);
  EXPECT_EQ(support.kind(), Support::Kind::approximate);
  EXPECT_EQ(support.why(), "floats of forward depth leave steps of 1.2 m where the scene ends");
}

}  // namespace shadow_map_bits_test
