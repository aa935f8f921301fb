#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "device/context.h"
#include "map_scenes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace shadow_map_test {
using namespace gnomon;
using map_scenes::all_kinds;
using map_scenes::near_shadow_edge;
using map_scenes::soup_over_ground;
using small_world::make_mesh;

class ShadowMap : public testing::Test {
 protected:
  ShadowMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_shadow_map, settings, scene, light, g);
  }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};

// Orthographic, straight down on a sheet at height 1 over a ground at 0 with half-side 3: the image's taps store 1 meter less
// than the distance to the ground under the sheet, whose own depth is constant.
TEST_F(ShadowMap, stored_depth_of_a_plane_is_the_closed_form) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::ground(1, 1)};
  for (const Light& light : {Light{.kind = DirectionalLight{{0, -1, 0}}}, Light{.kind = PointLight{{0, 3, 0}}}}) {
    const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
    const auto shadow_map = run("resolution=256", scene, light, g);
    int with_tap = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const auto why = shadow_map.technique->explain(i);
      ASSERT_TRUE(why);
      for (const Tap& tap : why->taps) {
        if (tap.stored == INFINITY) continue;
        ++with_tap;
        const double height = (tap.origin + tap.direction * tap.stored).y;
        EXPECT_TRUE(std::abs(height) < 1e-5 || std::abs(height - 1) < 1e-5) << height;
      }
    }
    EXPECT_GT(with_tap, 500);
  }
}

// Point light at height 4 over a triangle at height 1: the shadow is the triangle scaled by 4/3 about the light's foot point.
// A pixel farther than one texel diagonal (world width on the ground times sqrt 2) from its edges must be right.
TEST_F(ShadowMap, shadow_of_a_triangle_is_the_analytic_triangle_within_a_texel_diagonal) {
  Scene scene;
  scene.meshes = {small_world::ground(4), make_mesh({{-1, 1, -1}, {0, 1, 1}, {1.2f, 1, -0.5f}}, {{0, 1, 2}})};
  const Light light{.kind = PointLight{{0.5f, 4, 0.25f}}};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 3, 7}, .target = {0, 0, 0}}, 160, 120);
  const auto shadow_map = run("resolution=512,bias=receiver_plane,depth_bias=0", scene, light, g);
  glm::dvec2 corners[3];
  for (int k = 0; k < 3; ++k) {
    const glm::dvec2 foot(0.5, 0.25), p(scene.meshes[1].positions[k].x, scene.meshes[1].positions[k].z);
    corners[k] = foot + (p - foot) * (4.0 / 3);
  }
  int dark = 0, wrong = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i) || g.mesh[i] != 0) continue;
    // Signed distance to the triangle's edges, positive inside; the corners run one way round.
    const glm::dvec2 p(g.px[i], g.pz[i]);
    double inside = INFINITY;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 edge = glm::normalize(corners[(k + 1) % 3] - corners[k]), to = p - corners[k];
      inside = std::min(inside, to.x * edge.y - to.y * edge.x);
    }
    const double diagonal = shadow_map.technique->explain(i)->texel_width * std::sqrt(2.0);
    dark += inside > diagonal;
    if (std::abs(inside) > diagonal) wrong += shadow_map.mask[i] != (inside > 0 ? 0 : 1);
  }
  EXPECT_GT(dark, 300);
  EXPECT_EQ(wrong, 0);
}

// Receiver-plane bias is exact on planes: with no depth bias at all, boxes and grounds have no acne under any light.
TEST_F(ShadowMap, receiver_plane_bias_alone_leaves_no_acne_on_flat_receivers) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({-1, 0.5f, -1}, {0.5f, 1.5f, 0.2f})};
  for (const float far_away : {0.0f, 200.0f}) {  // rounding grows with the distance from the world's origin
    const glm::vec3 shift(far_away);
    Scene moved = scene;
    for (Mesh& mesh : moved.meshes)
      for (glm::vec3& p : mesh.positions) p += shift;
    const View moved_view{.eye = view.eye + shift, .target = view.target + shift};
    const GBuffer g = small_world::make_gbuffer(moved, moved_view, 128, 96);
    for (Light light : all_kinds) {
      if (auto* l = std::get_if<PointLight>(&light.kind)) l->position += shift;
      if (auto* l = std::get_if<SpotLight>(&light.kind)) l->position += shift;
      for (const int radius : {0, 3}) {
        const std::string settings =
            "resolution=256,bias=receiver_plane,depth_bias=0" + (radius ? ",filter=pcf,filter_radius=3" : std::string());
        const auto shadow_map = run(settings, moved, light, g);
        int acne = 0, dark = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (shadow_map.mask[i] == 1) continue;
          ++dark;
          const double reach = 1.5 * std::sqrt(2.0) * (radius + 1) * shadow_map.technique->explain(i)->texel_width;
          acne += small_world::caster_distance(moved, light, g.position(i), 1e-3) == INFINITY &&
                  !near_shadow_edge(moved, light, g.position(i), g.normal(i), reach, false);
        }
        EXPECT_GT(dark, 20);
        EXPECT_EQ(acne, 0) << light.name << " " << settings << " at " << far_away;
      }
    }
  }
}

// Against brute-force rays, over random scenes and every kind of light: a pixel may be wrong only within 1.5 texel diagonals of
// a shadow edge, or where the occluder is nearer than the bias. A fitted window that cut off a caster would show here.
TEST_F(ShadowMap, fitted_window_never_loses_a_shadow) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Scene scene = soup_over_ground(seed);
    const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
    for (const Light& light : all_kinds) {
      const auto shadow_map = run(seed % 2 ? "resolution=512" : "resolution=512,fit=view", scene, light, g);
      int dark = 0, unexplained = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) {
          EXPECT_EQ(shadow_map.mask[i], 1);
          continue;
        }
        const double distance = small_world::caster_distance(scene, light, g.position(i));
        const bool reference = distance < INFINITY;
        dark += reference;
        if (reference == (shadow_map.mask[i] == 0)) continue;
        const auto why = *shadow_map.technique->explain(i);
        const double reach = 1.5 * std::sqrt(2.0) * why.texel_width;
        unexplained += !near_shadow_edge(scene, light, g.position(i), g.normal(i), reach, reference) &&
                       distance > why.bias + 2 * std::sqrt(2.0) * why.texel_width;
      }
      EXPECT_GT(dark, 10) << light.name;
      EXPECT_EQ(unexplained, 0) << light.name << " seed " << seed;
    }
  }
}

TEST_F(ShadowMap, caster_behind_the_light_or_beyond_the_receivers_casts_nothing) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), make_mesh({{-1, 3, -1}, {0, 3, 1}, {1, 3, -1}}, {{0, 1, 2}}),
                  make_mesh({{-1, -1, -1}, {0, -1, 1}, {1, -1, -1}}, {{0, 1, 2}})};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 2, 5}}, 64, 48);
  for (const Light& light : {Light{.kind = PointLight{{0, 2, 0}}}, Light{.kind = SpotLight{{0, 2, 0}, {0, -1, 0}, 20, 50}}})
    for (const float value : run("", scene, light, g).mask) EXPECT_EQ(value, 1);
}

// The mask follows from the taps: each is dark when the stored surface lies before the point by more than the bias, both
// measured along the tap's ray. For receiver_plane the point is where the ray cuts the tangent plane; for the other modes it
// has the look-up point's distance along the axis. Taps where the two sides agree to rounding are left out.
TEST_F(ShadowMap, explain_reproduces_the_mask_from_its_taps) {
  const Scene scene = soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const std::string filter : {"nearest", "pcf,filter_radius=2", "disc,filter_radius=2", "bilinear", "bilinear,fit=view"})
    for (const std::string depth : {"first", "second", "midpoint", "dual"})
      for (const Light& light : {all_kinds[0], all_kinds[1], all_kinds[2], all_kinds[6]}) {
        const auto shadow_map =
            run("resolution=256,bias=receiver_plane,stored=" + depth + ",filter=" + filter, scene, light, g);
        int compared = 0, different = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(scene, g, light, i)) continue;
          const auto why = *shadow_map.technique->explain(i);
          EXPECT_TRUE(why.covered);
          const glm::dvec3 point = g.position(i), normal = g.normal(i);
          double lit = why.taps.empty() ? 1 : 0;
          bool decided = true;
          for (const Tap& tap : why.taps) {
            const double facing = -glm::dot(normal, tap.direction);
            const double expected = facing > 0 ? glm::dot(normal, tap.origin - point) / facing : INFINITY;
            if (std::abs(tap.stored - (expected - why.bias)) < 0.02 * why.bias + 1e-5) decided = false;
            lit += tap.stored < expected - why.bias ? 0 : tap.weight;
          }
          if (!decided) continue;
          ++compared;
          different += std::abs(lit - shadow_map.mask[i]) > 1e-5;
        }
        EXPECT_GT(compared, 1500);
        EXPECT_EQ(different, 0) << filter << " " << depth << " " << light.name;
      }
}

// The same for the modes that compare along the axis of the image: the tap is dark when the stored surface's axis distance is
// less than that of the point by more than the bias, which holds what a shifted look-up point is nearer to the light by.
TEST_F(ShadowMap, explain_reproduces_the_mask_in_every_bias_mode) {
  const Scene scene = soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : {all_kinds[2], all_kinds[6]})
    for (const std::string bias : {"constant", "slope", "normal_offset", "slope,fit=view"}) {
      const auto shadow_map = run("resolution=256,filter=pcf,bias=" + bias, scene, light, g);
      const auto* spot = std::get_if<SpotLight>(&light.kind);
      const glm::dvec3 axis =
          spot ? glm::normalize(glm::dvec3(spot->direction)) : -glm::normalize(glm::dvec3(homogeneous(light)));
      int compared = 0, different = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        const auto why = *shadow_map.technique->explain(i);
        EXPECT_EQ(why.shifted.has_value(), bias == "normal_offset");
        const glm::dvec3 point = g.position(i);
        const double axis_bias = why.bias * -glm::dot(glm::normalize(to_light(homogeneous(light), point)), axis);
        double lit = 0;
        bool decided = true;
        for (const Tap& tap : why.taps) {
          const double expected = glm::dot(point - tap.origin, axis) - axis_bias;
          const double stored = tap.stored * glm::dot(tap.direction, axis);
          if (std::abs(stored - expected) < 0.02 * axis_bias + 1e-5) decided = false;
          lit += stored < expected ? 0 : tap.weight;
        }
        if (!decided) continue;
        ++compared;
        different += std::abs(lit - shadow_map.mask[i]) > 1e-5;
      }
      EXPECT_GT(compared, 1000);
      EXPECT_EQ(different, 0) << bias << " " << light.name;
    }
}

// A closed box on a ground: the first surface it shows the light is its top, the second its bottom, which lies on the ground.
// Without any bias the top then has no acne, since it is compared with the bottom; the ground beside it keeps the far plane.
TEST_F(ShadowMap, the_second_surface_needs_no_bias_on_closed_casters) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), small_world::box({-1, 0.5f, -1}, {1, 1, 1})};
  const Light light{.kind = DirectionalLight{{0.5f, -1, 0.25f}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  const auto first = run("resolution=256,bias=constant,depth_bias=0", scene, light, g);
  const auto second = run("resolution=256,bias=constant,depth_bias=0,stored=second", scene, light, g);
  int acne_first = 0, acne_second = 0, dark_ground = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    const bool on_top = g.py[i] > 0.999f && std::abs(g.px[i]) < 0.95f && std::abs(g.pz[i]) < 0.95f;
    acne_first += on_top && first.mask[i] == 0;
    acne_second += on_top && second.mask[i] == 0;
    dark_ground += g.mesh[i] == 0 && second.mask[i] == 0;
  }
  EXPECT_GT(acne_first, 100);
  EXPECT_EQ(acne_second, 0);
  EXPECT_GT(dark_ground, 100);
}

TEST_F(ShadowMap, light_with_area_is_unsupported_with_a_reason) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto technique = registry.techniques()[0].make();
  const Support support = technique->supports({}, {.kind = SphereLight{}}, {});
  EXPECT_EQ(support.kind(), Support::Kind::unsupported);
  EXPECT_FALSE(support.why().empty());
}

// A parameter set on a live object is seen from the stage that it spoils on, and then the mask is that of a fresh object.
TEST_F(ShadowMap, parameter_set_later_gives_the_mask_of_a_fresh_object) {
  const Scene scene = soup_over_ground(5);
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const Light& light = all_kinds[0];
  const auto live = run("resolution=128", scene, light, g);
  for (const std::string settings :
       {"bias=slope", "filter=pcf", "filter_radius=2", "bias=normal_offset", "normal_offset=2", "stored=second", "stored=dual",
        "dual_offset=5", "depth_bias=5", "resolution=64", "bias=constant"}) {
    live.technique->apply(settings);
    const Stage from = live.technique->parameter(settings.substr(0, settings.find('='))).spoils();
    if (from <= Stage::setup) live.technique->setup();
    if (from <= Stage::build) live.technique->build(scene);
    if (from <= Stage::relight) live.technique->relight(light);
    VisibilityMask mask(g.width, g.height);
    live.technique->resolve(g, mask);
    const auto pixels = mask.read();
    const std::vector<float> now(pixels.begin(), pixels.end());
    EXPECT_EQ(now, run(live.technique->settings(), scene, light, g).mask) << settings;
  }
}

TEST_F(ShadowMap, only_fitted_faces_are_drawn) {
  Scene scene;
  scene.meshes = {small_world::ground(0.5f), small_world::ground(0.2f, 0.5f)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 16, 16);
  const auto shadow_map = run("resolution=64", scene, {.kind = PointLight{{0, 4, 0}}}, g);
  for (const Count& count : shadow_map.technique->counts()) {
    if (count.name == "faces") {
      EXPECT_EQ(count.value, 1);
    }
    if (count.name == "texels") {
      EXPECT_EQ(count.value, 64 * 64);
    }
  }
}

TEST_F(ShadowMap, map_layer_is_a_picture_of_the_screen) {
  const Scene scene = soup_over_ground(3);
  const GBuffer g = small_world::make_gbuffer(scene, view, 40, 30);
  for (const Light& light : all_kinds) {
    const auto shadow_map = run("resolution=64", scene, light, g);
    const auto picture = shadow_map.technique->draw_debug("map");
    ASSERT_EQ(picture.size(), g.size() * 3);
    EXPECT_LT(*std::ranges::min_element(picture), 0.9f);
    EXPECT_THROW(shadow_map.technique->draw_debug("nothing"), Error);
  }
}

}  // namespace shadow_map_test
