#include <gnomon/kit/maps/light_camera.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "device/context.h"
#include "map_scenes.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_cascaded_map(gnomon::Registry&);
extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);
extern "C" void gnomon_technique_warped_map(gnomon::Registry&);

// Rules that have numbers of their own: adaptive depth bias, oriented depth bias and the defaults of engines.
namespace map_bias_test {
using namespace gnomon;

class MapBias : public testing::Test {
 protected:
  MapBias() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_shadow_map, settings, scene, light, g);
  }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};
/// 69 and 20 degrees from the normal of a ground.
const Light low_sun{.name = "low", .kind = DirectionalLight{{1, -0.4f, 0.3f}}};
const Light high_sun{.name = "high", .kind = DirectionalLight{{0.3f, -1, 0.2f}}};

Scene ground_alone() {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  return scene;
}

int count_dark(const std::vector<float>& mask) {
  return static_cast<int>(std::ranges::count_if(mask, [](float v) { return v < 1; }));
}

// The depths of a plane differ from that of a texel's center by up to w / 2 (a + b), w the texel and a, b the slopes along its
// axes, of which the larger one is at least tan / sqrt 2: at most w tan / sqrt 2.
// - The slope of 1 of oriented, and the 2 of filament, are w times the larger slope: enough.
// - unity is w + w (1 - cos) / cos = w / cos along the ray, bevy 2.5 w / cos: more than w tan.
// - unreal is w (2.5 + 3.75 min(tan, 1)): enough up to 83 degrees.
// - adaptive compares with the plane itself.
// - godot moves the look-up by w sin across the ray, which is w sin tan of depth: enough from 45 degrees on.
// No bias is acne at about half of the points: the plane is before the texel's center there.
TEST_F(MapBias, on_a_slope_all_rules_but_no_bias_and_an_offset_across_the_ray_are_clean) {
  const Scene scene = ground_alone();
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : {low_sun, high_sun})
    for (const std::string rule : {"adaptive", "oriented", "unity", "unreal", "bevy", "filament"})
      EXPECT_EQ(count_dark(run("resolution=128,bias=" + rule, scene, light, g).mask), 0) << rule << ' ' << light.name;
  EXPECT_EQ(count_dark(run("resolution=128,bias=godot", scene, low_sun, g).mask), 0);
  EXPECT_GT(count_dark(run("resolution=128,bias=godot", scene, high_sun, g).mask), 20);
  const auto seen = std::ranges::count_if(g.mesh, [](std::uint32_t mesh) { return mesh == 0; });
  for (const Light& light : {low_sun, high_sun}) {
    const double acne = count_dark(run("resolution=128,bias=three_js", scene, light, g).mask) / static_cast<double>(seen);
    EXPECT_NEAR(acne, 0.5, 0.2) << light.name;
  }
}

// Filters compare with texels farther away; adaptive asks the plane at each of them.
TEST_F(MapBias, adaptive_is_clean_under_wide_filters_and_all_lights) {
  const Scene scene = ground_alone();
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : map_scenes::all_kinds)
    for (const std::string filter : {"pcf,filter_radius=4", "disc,filter_radius=3", "bilinear"})
      EXPECT_EQ(count_dark(run("resolution=128,bias=adaptive,filter=" + filter, scene, light, g).mask), 0)
          << filter << ' ' << light.name;
}

/// What a rule is along parallel rays, meters, on a plane: c and s are cosine and sine between its normal and the light, w the
/// larger width of a texel, `raster` what depth changes by from texel to texel along the steeper axis.
double expected_bias(std::string_view rule, double c, double s, double w, double raster, double diagonal) {
  if (rule == "adaptive") return 1e-4 * diagonal / (c * c);
  if (rule == "oriented") return 0.002 + raster;
  if (rule == "godot") return 0.001;                // the shift lies across the ray
  if (rule == "unity") return w + (1 - c) * w * c;  // the shift along the normal is its cosine along the ray
  if (rule == "unreal") return 2.5 * w + 3.75 * w * std::min(s / c, 1.0);
  if (rule == "bevy") return 0.02 + 1.8 * std::sqrt(2.0) * w * c;
  if (rule == "filament") return 0.001 + 2 * raster + s * w * c;
  return 0;
}

TEST_F(MapBias, a_rule_is_its_formula_in_meters) {
  const Scene scene = ground_alone();
  const GBuffer g = small_world::make_gbuffer(scene, view, 48, 36);
  for (const Light& light : {low_sun, high_sun})
    for (const std::string rule : {"adaptive", "oriented", "godot", "unity", "unreal", "bevy", "filament", "three_js"}) {
      const auto map = run("resolution=128,bias=" + rule, scene, light, g);
      const int margin = rule == "bevy" ? 4 : rule == "godot" || rule == "unity" || rule == "filament" ? 2 : 1;
      const LightImage image = fit_to_scene(light, mesh_boxes(scene), 128, margin).images[0];
      const glm::dvec3 to = glm::normalize(glm::dvec3(homogeneous(light))), up(0, 1, 0), n = image.turned(up);
      const double c = to.y, s = std::sqrt(1 - c * c), diagonal = std::sqrt(72.0);
      const glm::dvec2 width = 1.0 / image.scale;
      const double w = std::max(width.x, width.y);
      const double raster = std::max(std::abs(n.x) * width.x, std::abs(n.y) * width.y) / c;
      int asked = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        ++asked;
        const auto why = *map.technique->explain(i);
        ASSERT_NEAR(why.texel_width, w, 1e-9 * w) << rule;
        ASSERT_NEAR(why.bias, expected_bias(rule, c, s, w, raster, diagonal), 1e-6) << rule << ' ' << light.name;
        if (rule != "godot") continue;
        const glm::dvec3 moved = *why.shifted - glm::dvec3(g.position(i));
        ASSERT_NEAR(glm::length(moved), s * w, 1e-6);
        ASSERT_NEAR(glm::dot(moved, to), 0, 1e-6);
      }
      EXPECT_GT(asked, 200);
    }
}

// Around a light at height 3 an axis looks down, and at a point whose ray leans by an angle of cosine c a length along the ray
// is 1 / c of one along the axis. Bevy's point lights: 0.08 m along the ray, and 0.6 diagonals along the normal, which is the
// axis.
TEST_F(MapBias, around_a_point_light_meters_are_along_the_ray_and_texels_those_at_the_point) {
  const Scene scene = ground_alone();
  const Light light{.name = "point", .kind = PointLight{{0, 3, 0}}};
  const GBuffer g = small_world::make_gbuffer(scene, view, 48, 36);
  const auto map = run("resolution=128,bias=bevy", scene, light, g);
  int asked = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i)) continue;
    ++asked;
    const auto why = *map.technique->explain(i);
    const double c = 3 / glm::distance(glm::dvec3(g.position(i)), glm::dvec3(0, 3, 0));
    ASSERT_NEAR(why.bias, 0.08 + 0.6 * std::sqrt(2.0) * why.texel_width / c, 1e-4);
  }
  EXPECT_GT(asked, 200);
}

// A sheet 1 cm over a ground, under a sun straight above: a bias below 1 cm keeps its shadow, a longer one loses all of it.
// With 128 texels on 6 m, each 4.8 cm wide: oriented 2 mm, godot and filament 1 mm, adaptive 1e-4 of 8.5 m, three_js none;
// unity a texel, unreal 2.5, bevy 2.5 and 2 cm.
TEST_F(MapBias, a_contact_shadow_is_lost_by_rules_in_texels_where_texels_are_coarse) {
  Scene scene = ground_alone();
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);  // it shows the ground below the sheet
  scene.meshes.push_back(small_world::ground(1, 0.01f));
  const Light light{.kind = DirectionalLight{{0, -1, 0}}};
  const std::vector<std::pair<std::string, bool>> rules = {{"adaptive", false}, {"oriented", false}, {"godot", false},
                                                           {"filament", false}, {"three_js", false}, {"unity", true},
                                                           {"unreal", true},    {"bevy", true}};
  for (const auto& [rule, is_lost] : rules) {
    const auto map = run("resolution=128,bias=" + rule, scene, light, g);
    int below = 0, dark = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.is_background(i) || std::abs(g.px[i]) > 0.8f || std::abs(g.pz[i]) > 0.8f) continue;
      ++below;
      dark += map.mask[i] == 0;
    }
    EXPECT_GT(below, 50);
    EXPECT_EQ(dark, is_lost ? 0 : below) << rule;
  }
}

// The mask follows from the taps, as for the biases that are set: the stored surface's axis distance against that of the point,
// less the bias. Adaptive compares where the tap's ray cuts the tangent plane. Ties to rounding are left out.
TEST_F(MapBias, explain_reproduces_the_mask_of_every_rule) {
  const Scene scene = map_scenes::soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : {map_scenes::all_kinds[2], map_scenes::all_kinds[6]})
    for (const std::string rule : {"adaptive", "oriented", "bevy", "filament", "three_js", "godot", "unity", "unreal"}) {
      const auto* spot = std::get_if<SpotLight>(&light.kind);
      if (spot && (rule == "godot" || rule == "unity" || rule == "unreal")) continue;
      const auto map = run("resolution=256,filter=pcf,bias=" + rule, scene, light, g);
      const glm::dvec3 axis =
          spot ? glm::normalize(glm::dvec3(spot->direction)) : -glm::normalize(glm::dvec3(homogeneous(light)));
      int compared = 0, different = 0;
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) continue;
        const auto why = *map.technique->explain(i);
        const glm::dvec3 point = g.position(i), normal = g.normal(i);
        const double axis_bias = why.bias * -glm::dot(glm::normalize(to_light(homogeneous(light), point)), axis);
        double lit = 0;
        bool decided = true;
        for (const Tap& tap : why.taps) {
          const double along = glm::dot(tap.direction, axis), sinks = -glm::dot(normal, tap.direction);
          double expected = glm::dot(point - tap.origin, axis);
          if (rule == "adaptive") expected = sinks > 0 ? glm::dot(normal, tap.origin - point) / sinks * along : INFINITY;
          if (std::abs(tap.stored * along - (expected - axis_bias)) < 0.02 * axis_bias + 1e-4) decided = false;
          lit += tap.stored * along < expected - axis_bias ? 0 : tap.weight;
        }
        if (!decided) continue;
        ++compared;
        different += std::abs(lit - map.mask[i]) > 1e-5;
      }
      EXPECT_GT(compared, 800) << rule << ' ' << light.name;
      EXPECT_EQ(different, 0) << rule << ' ' << light.name;
    }
}

// Slices and warps are for parallel rays and narrow spots: each rule compiles there, and a slope has no acne.
TEST_F(MapBias, rules_are_those_of_cascades_and_warps_too) {
  const Scene scene = ground_alone();
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const auto roll : {gnomon_technique_cascaded_map, gnomon_technique_warped_map})
    for (const std::string rule : {"adaptive", "oriented", "godot", "unity", "unreal", "bevy", "filament"})
      EXPECT_EQ(count_dark(small_world::run(roll, "resolution=128,bias=" + rule, scene, low_sun, g).mask), 0) << rule;
}

// The harness asks before anything runs.
TEST_F(MapBias, a_preset_under_a_light_that_it_does_not_define_is_unsupported) {
  Registry registry;
  gnomon_technique_shadow_map(registry);
  const auto technique = registry.techniques()[0].make();
  technique->apply("bias=unity");
  EXPECT_TRUE(technique->supports(ground_alone(), low_sun, view));
  const Support refused = technique->supports(ground_alone(), {.kind = PointLight{}}, view);
  EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
  EXPECT_EQ(refused.why(), "bias=unity has no number for a point light: its other lights have biases in texels at their range");
}

}  // namespace map_bias_test
