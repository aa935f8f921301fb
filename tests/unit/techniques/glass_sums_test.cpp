// Techniques that add absorbance up in the texels of a map, drawn: moment_transmittance and fourier_opacity.
#include <gnomon/kit/pictures/layers.h>

#include "glass_maps_rig.h"
#include "plate_stack.h"
#include "techniques/fourier_opacity/curve.h"
#include "techniques/moment_transmittance/curve.h"

namespace glass_sums_test {
using namespace glass_maps_rig;
using plate_stack::Plate;

class GlassSums : public TestRig {};

/// Straight from above: of level sheets all points have one depth.
const Light lights[] = {
    {.name = "sun", .kind = DirectionalLight{{0, -1, 0}}},
    {.name = "point", .kind = PointLight{{0, 6, 0}}},
    {.name = "spot", .kind = SpotLight{.position = {0, 6, 0}, .direction = {0, -1, 0}, .outer_degrees = 45}}};

constexpr double receiver_depths[] = {.1, .35, .6, .9};

/// Between a ground at depth 1, y = 0, and a small plate at depth 0, y = 1: sheets as on paper, and opaque plates side by side
/// that receive at the depths of the tables.
Scene stack() {
  Scene scene;
  scene.name = "stack";
  scene.meshes = {hand_made::square(2, 0), moved(hand_made::square(0.02f, 1), {0, 0, 1.5f})};
  for (const Plate& plate : plate_stack::on_paper())
    scene.meshes.push_back(
        of_glass(hand_made::square(1.8f, static_cast<float>(1 - plate.t)), clear(static_cast<float>(1 - plate.alpha)), false));
  for (std::size_t k = 0; k < 4; ++k)
    scene.meshes.push_back(moved(hand_made::square(0.25f, static_cast<float>(1 - receiver_depths[k])),
                                 {-1.05f + 0.7f * static_cast<float>(k), 0, 0}));
  for (Mesh& mesh : scene.meshes) finish(mesh);
  scene.views = {{.name = "view", .eye = {0, 5, 0.5f}, .target = {0, 0, 0}}};
  return scene;
}

// The shader's formula is that of the tests on paper, in float32. A bias of 1/100 of a texel of some 8 mm is nothing.
TEST_F(GlassSums, masks_are_the_formulas_in_the_stack_on_paper) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  moment_transmittance::Moments<double> moments;
  fourier_opacity::Series<double> series[] = {fourier_opacity::Series<double>(3), fourier_opacity::Series<double>(7),
                                              fourier_opacity::Series<double>(15)};
  for (const Plate& plate : plate_stack::on_paper()) {
    moments.add(plate.t, plate.absorbance());
    for (auto& one : series) one.add(plate.t, plate.absorbance());
  }
  struct Case {
    const char *id, *settings;
    std::function<double(double)> share;
  };
  const auto of_moments = [&](double bias, double beta) {
    return [&, bias, beta](double t) { return moment_transmittance::transmittance(moments, t, bias, beta); };
  };
  const auto of_series = [&](int k) { return [&, k](double t) { return fourier_opacity::transmittance(series[k], t); }; };
  const Case cases[] = {
      {"moment_transmittance", "", of_moments(5e-7, 0.25)},
      {"moment_transmittance", "filter=bilinear", of_moments(5e-7, 0.25)},
      {"moment_transmittance", "moment_bias=1e-2,overestimation=0.5", of_moments(1e-2, 0.5)},
      {"fourier_opacity", "terms=3", of_series(0)},
      {"fourier_opacity", "", of_series(1)},
      {"fourier_opacity", "terms=15,filter=bilinear", of_series(2)},
  };
  for (const Case& one : cases) {
    const std::string settings =
        std::string(one.settings) + (*one.settings ? "," : "") + "depth_bias=0.01,slope_bias=0,resolution=512";
    auto run = TestRig::run(one.id, settings, scene, lights[0], gbuffer);
    for (const Light& light : lights) {
      answer(run, light, gbuffer);
      int tested[5] = {};
      for (std::size_t i = 0; i < gbuffer.size(); ++i) {
        if (gbuffer.is_background(i)) continue;
        const glm::vec3 point = gbuffer.position(i);
        // Receivers, and of the ground what lies before their row, under the sheets.
        const bool is_ground = gbuffer.mesh[i] == 0 && point.z > 0.6f && point.z < 1.2f && std::abs(point.x) < 1;
        if (!is_ground && gbuffer.mesh[i] < 5) continue;
        const std::size_t k = is_ground ? 4 : gbuffer.mesh[i] - 5;
        if (!is_ground && std::max(std::abs(point.x - (-1.05f + 0.7f * static_cast<float>(k))), std::abs(point.z)) > 0.22f)
          continue;
        ++tested[k];
        EXPECT_NEAR(run.mask[i], one.share(k < 4 ? receiver_depths[k] : 1), 1e-3)
            << one.id << ' ' << settings << ' ' << light.name << ", receiver " << k;
      }
      for (const int count : tested) EXPECT_GT(count, 20);
    }
  }
}

/// Mean of |V - V_exact| over the pixels that face the light.
double mean_error(const Scene& scene, const Light& light, const GBuffer& gbuffer, std::span<const float> mask,
                  std::span<const float> truth) {
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) continue;
    sum += std::abs(mask[i] - truth[i]);
    ++count;
  }
  return sum / count;
}

// Behind all glass both are exact but for what may lie at the point's own depth, which is nothing: what remains are the edges
// of texels, a few millimeters of cards and holes that cover a tenth of the picture. A texel that lets nothing through shadows
// as an opaque caster does: at t = 0 there is no absorbance to add.
TEST_F(GlassSums, textures_holes_and_opaque_texels_are_those_of_the_scene) {
  const Scene scene = glass_over_ground();
  const GBuffer gbuffer = picture(scene);
  Scene bare = scene;
  for (Mesh& mesh : bare.meshes) mesh.casts = !mesh.transmission;
  for (const Light& light : scene.lights) {
    const std::vector<float> truth = decided(scene, light, gbuffer);
    ASSERT_GT(mean_error(scene, light, gbuffer, decided(bare, light, gbuffer), truth), 0.02) << "glass takes light";
    for (const char* const settings : {"overestimation=0", "overestimation=0,filter=bilinear"}) {
      const auto run = TestRig::run("moment_transmittance", settings, scene, light, gbuffer);
      EXPECT_LT(mean_error(scene, light, gbuffer, run.mask, truth), 0.006) << settings << ' ' << light.name;
    }
    const auto run = TestRig::run("fourier_opacity", "terms=15", scene, light, gbuffer);
    EXPECT_LT(mean_error(scene, light, gbuffer, run.mask, truth), 0.02) << light.name;
  }
}

// Places from -1.5 to 2 in textures of 3 x 2 texels, which the three wraps continue each in its own way: were they taken for
// another, a part of the light as large as that of the texture's differences would be off.
TEST_F(GlassSums, textures_are_wrapped) {
  using Wrap = AlphaMask::Wrap;
  const auto textured = [](std::size_t k, Wrap u, Wrap v) {
    Mesh card = moved(hand_made::square(0.6f, 0.5f), {-1.3f + 1.3f * static_cast<float>(k), 0, 0});
    card.uv = {{-1.5f, -1.5f}, {-1.5f, 2}, {2, 2}, {2, -1.5f}};
    const std::vector<float> values = {0.9f, 0.1f, 0.5f, 0.3f, 0.7f, 0.05f};
    return of_glass(card, std::make_shared<const Transmission>(3, 2, 1, values, u, v), false);
  };
  const auto cards_of = [&](const std::array<Wrap, 6>& wraps) {
    Scene scene = sheet_over_ground(0.5f);
    scene.meshes.resize(1);
    for (std::size_t k = 0; k < 3; ++k) scene.meshes.push_back(textured(k, wraps[2 * k], wraps[2 * k + 1]));
    return scene;
  };
  using enum Wrap;
  const Scene scene = cards_of({repeat, mirror, mirror, clamp, clamp, repeat});
  const Scene other = cards_of({repeat, repeat, repeat, repeat, repeat, repeat});
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : {sun, point}) {
    const std::vector<float> truth = decided(scene, light, gbuffer);
    const auto run = TestRig::run("moment_transmittance", "overestimation=0,resolution=2048", scene, light, gbuffer);
    EXPECT_LT(mean_error(scene, light, gbuffer, run.mask, truth), 0.002) << light.name;
    EXPECT_GT(mean_error(scene, light, gbuffer, decided(other, light, gbuffer), truth), 0.02) << light.name;
  }
}

// With no glass there is nothing to multiply, and no image of it to pay for.
TEST_F(GlassSums, a_scene_without_glass_is_that_of_a_shadow_map) {
  const Scene scene = taken_for(GlassAs::opaque, glass_over_ground());
  const GBuffer gbuffer = picture(scene);
  for (const char* const settings : {"filter=nearest", "filter=bilinear"}) {
    auto map = TestRig::run("shadow_map", settings, scene, sun, gbuffer);
    for (const char* const id : {"moment_transmittance", "fourier_opacity"}) {
      auto run = TestRig::run(id, settings, scene, sun, gbuffer);
      for (const Light& light : scene.lights) {
        answer(map, light, gbuffer);
        answer(run, light, gbuffer);
        EXPECT_EQ(run.mask, map.mask) << id << ' ' << settings << ' ' << light.name;
        const auto bytes = [](const Technique& technique) {
          const Counts counts = technique.counts();
          return std::ranges::find(counts, "bytes", &Count::name)->value;
        };
        EXPECT_EQ(bytes(*run.technique), bytes(*map.technique)) << id;
      }
    }
  }
}

// The first two receivers of the stack: T = 1 and .5. The upper bound at the second is .592496, off by more than 1/20, and
// three terms say .878 at the first; the exact lists of the same texels are right.
TEST_F(GlassSums, a_curve_that_errs_is_named) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto count_named = [&](const Technique& technique, std::size_t k) {
    std::pair<int, int> named;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (gbuffer.is_background(i) || gbuffer.mesh[i] != 5 + k) continue;
      const glm::vec3 point = gbuffer.position(i);
      if (std::max(std::abs(point.x - (-1.05f + 0.7f * static_cast<float>(k))), std::abs(point.z)) > 0.22f) continue;
      ++(cause(technique, i) == "curve" ? named.first : named.second);
    }
    return named;
  };
  auto moments = TestRig::run("moment_transmittance", "overestimation=0,resolution=512", scene, lights[0], gbuffer);
  auto terms = TestRig::run("fourier_opacity", "terms=3,resolution=512", scene, lights[0], gbuffer);
  for (const Light& light : lights) {
    answer(moments, light, gbuffer);
    EXPECT_EQ(count_named(*moments.technique, 0).first, 0) << light.name;
    EXPECT_GT(count_named(*moments.technique, 1).first, 20) << light.name;
    EXPECT_EQ(count_named(*moments.technique, 1).second, 0) << light.name;
    answer(terms, light, gbuffer);
    EXPECT_GT(count_named(*terms.technique, 0).first, 20) << light.name;
    EXPECT_EQ(count_named(*terms.technique, 0).second, 0) << light.name;
  }
}

// Glass of .01 over a twenty-fifth of a bilinear filter: the mean of the light is .96, which is right beside the glass, the
// answer .01^.04 = .83. Over a half of it both are wrong, and texels are too large. The nearest texel is not filtered.
TEST_F(GlassSums, filtered_absorbance_is_named_at_the_edge_of_dark_glass) {
  const Scene scene = sheet_over_ground(0.01f);
  const GBuffer gbuffer = picture(scene);
  const std::vector<float> truth = decided(scene, sun, gbuffer);
  for (const bool is_bilinear : {true, false}) {
    const auto run = TestRig::run("moment_transmittance", is_bilinear ? "filter=bilinear,resolution=64" : "resolution=64",
                                  scene, sun, gbuffer);
    int named = 0, others = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (!faces_light(scene, gbuffer, sun, i) || std::abs(run.mask[i] - truth[i]) <= 0.05f) continue;
      const std::string why = cause(*run.technique, i);
      EXPECT_NE(why, "curve") << i;
      ++(why == "filtered_absorbance" ? named : others);
    }
    EXPECT_GT(others, 20) << "texels of 6 cm";
    if (is_bilinear)
      EXPECT_GT(named, 0);
    else
      EXPECT_EQ(named, 0);
  }
}

TEST_F(GlassSums, debug_layers_are_drawn) {
  const Scene scene = stack();
  const GBuffer gbuffer = picture(scene);
  const auto exact_before = TestRig::run("moment_transmittance", "overestimation=0", scene, lights[0], gbuffer);
  const std::vector<float> curve = exact_before.technique->draw_debug("curve");
  std::vector<float> off(gbuffer.size(), 0);
  int colored = 0;
  const std::vector<float> nothing = heat_layer(gbuffer, off);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const bool is_colored = curve[3 * i] != nothing[3 * i] || curve[3 * i + 1] != nothing[3 * i + 1];
    colored += is_colored;
    if (gbuffer.is_background(i) || gbuffer.mesh[i] != 5) continue;
    const glm::vec3 point = gbuffer.position(i);
    const bool is_inside = std::max(std::abs(point.x + 1.05f), std::abs(point.z)) < 0.22f;
    EXPECT_FALSE(is_inside && is_colored) << "T = 1 is exact";
  }
  EXPECT_GT(colored, 100);
  for (const DebugLayer& layer : exact_before.technique->debug_layers())
    EXPECT_EQ(exact_before.technique->draw_debug(layer.name).size(), 3 * gbuffer.size()) << layer.name;
}

// What the eye does not see is not in the depth of its picture.
TEST_F(GlassSums, unseen_glass_is_not_in_the_depth_of_the_picture) {
  Scene scene = sheet_over_ground(0.5f);
  const GBuffer gbuffer = picture(scene);
  const auto depths_of = [&](const Scene& drawn) {
    return read_texels<float>(depth_stencil(drawn, gbuffer).texture, GL_DEPTH_COMPONENT);
  };
  const std::vector<float> unseen = depths_of(scene);
  scene.meshes[1].seen = true;
  EXPECT_NE(depths_of(scene), unseen);
  scene.meshes.pop_back();
  EXPECT_EQ(depths_of(scene), unseen);
}

TEST_F(GlassSums, glass_that_colors_light_and_lights_with_area_are_unsupported) {
  Scene scene = sheet_over_ground(0.5f);
  for (const char* const id : {"moment_transmittance", "fourier_opacity"}) {
    EXPECT_EQ(support(id, "", scene, sun).kind(), Support::Kind::full) << id;
    EXPECT_FALSE(support(id, "", scene, lamp)) << id;
    scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f, 0.4f, 0.5f));
    EXPECT_FALSE(support(id, "", scene, sun)) << id;
    scene.meshes[1].transmission = clear(0.5f);
  }
}

}  // namespace glass_sums_test
