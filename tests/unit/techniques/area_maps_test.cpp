#include <gtest/gtest.h>

#include <cmath>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_percentage_closer_soft(gnomon::Registry&);
extern "C" void gnomon_technique_backprojected_map(gnomon::Registry&);

namespace area_maps_test {
using namespace gnomon;

class AreaMaps : public testing::Test {
 protected:
  AreaMaps() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

struct Kind {
  std::string name, settings;
  void (*enter)(Registry&);
};
const Kind kinds[] = {
    {"percentage_closer_soft", "search_taps=64,filter_taps=256,pattern=shared", gnomon_technique_percentage_closer_soft},
    {"backprojected_map", "", gnomon_technique_backprojected_map}};

const View from_aside{.eye = {2.5f, 0.8f, 0}, .target = {0, 0, 0}};

/// A ground at 0 and what covers x < 0 at height 1: one open face, or a closed body below it.
Scene half_plane(bool is_closed) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  if (is_closed)
    scene.meshes.push_back(small_world::box({-3, 0.9f, -3}, {0, 1, 3}));
  else
    scene.meshes.push_back(small_world::make_mesh({{-3, 1, -3}, {-3, 1, 3}, {0, 1, 3}, {0, 1, -3}}, {{0, 1, 2}, {0, 2, 3}}));
  return scene;
}

/// The share of a light at height 4, from -half to half along x, that a point (x, 0, z) sees past the edge over x = 0 at
/// height 1. The edge lies before the light's place 4/1 * (0 - x) + x = -3 x, and hides what has a smaller x.
double share_of_square(double x, double half) { return std::clamp((half + 3 * x) / (2 * half), 0.0, 1.0); }
double share_of_disc(double x, double radius) {
  const double s = std::clamp(3 * x / radius, -1.0, 1.0);
  return 0.5 + (s * std::sqrt(1 - s * s) + std::asin(s)) / 3.14159265358979;
}

// The penumbra goes from x = -half / 3 to half / 3 and is linear under a square light. Texels of 2.7 m / 300 stretch that, in
// shares of half = 0.3 by 3 * 0.009 / 0.6 = 0.045; 256 taps add 1/128, and the square that stands for a disc 0.023. Of the
// closed body the lower edge hides more where x < 0, up to -(4 / 0.9 - 1) x: by 0.44 * 0.087 / 0.6 = 0.064 at most.
TEST_F(AreaMaps, one_straight_edge_gives_the_penumbra_of_closed_form) {
  const Light square{.name = "square", .kind = RectLight{{0, 4, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}}};
  const Light disc{.name = "disc", .kind = DiscLight{{0, 4, 0}, {0, -1, 0}, 0.3f}};
  for (const Kind& kind : kinds)
    for (const bool is_closed : {false, true})
      for (const Light& light : {square, disc}) {
        const Scene scene = half_plane(is_closed);
        const GBuffer g = small_world::make_gbuffer(scene, from_aside, 160, 120);
        const auto run = small_world::run(kind.enter, kind.settings, scene, light, g);
        int in_penumbra = 0, wrong = 0, asked = 0;
        double sum = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (g.is_background(i) || g.mesh[i] != 0 || std::abs(g.position(i).z) > 1 || std::abs(g.position(i).x) > 0.6)
            continue;
          const double x = g.position(i).x;
          const double share = light.name == "disc" ? share_of_disc(x, 0.3) : share_of_square(x, 0.3);
          ++asked;
          in_penumbra += share > 0.05 && share < 0.95;
          wrong += std::abs(run.mask[i] - share) > (is_closed ? 0.15 : 0.08);
          sum += std::abs(run.mask[i] - share);
        }
        EXPECT_GT(in_penumbra, 100) << kind.name;
        EXPECT_LE(wrong, asked / 50) << kind.name << ' ' << light.name << ' ' << is_closed;
        EXPECT_LT(sum / asked, is_closed ? 0.03 : 0.02) << kind.name << ' ' << light.name << ' ' << is_closed;
      }
}

// A light of two millimeters has a penumbra of less than one. Farther than a texel from the edge all is dark or lit.
TEST_F(AreaMaps, a_small_light_gives_the_hard_shadow) {
  const Scene scene = half_plane(false);
  const GBuffer g = small_world::make_gbuffer(scene, from_aside, 96, 72);
  const Light lights[] = {{.name = "square", .kind = RectLight{{0, 4, 0}, {1e-3f, 0, 0}, {0, 0, 1e-3f}}},
                          {.name = "disc", .kind = DiscLight{{0, 4, 0}, {0, -1, 0}, 1e-3f}},
                          {.name = "sphere", .kind = SphereLight{{0, 4, 0}, 1e-3f}}};
  for (const Kind& kind : kinds)
    for (const Light& light : lights) {
      const auto run = small_world::run(kind.enter, kind.settings, scene, light, g);
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (g.is_background(i) || g.mesh[i] != 0 || std::abs(g.position(i).z) > 1 || std::abs(g.position(i).x) > 1) continue;
        if (std::abs(g.position(i).x) < 0.03) continue;
        EXPECT_NEAR(run.mask[i], g.position(i).x > 0 ? 1 : 0, 1e-3)
            << kind.name << ' ' << light.name << " at " << g.position(i).x;
      }
    }
}

// Lights without area are refused by the name of who can do them; a margin that leaves too little of the image is refused.
TEST_F(AreaMaps, lights_without_area_and_margins_without_an_image_are_refused) {
  const Scene scene = half_plane(false);
  for (const Kind& kind : kinds) {
    Registry registry;
    kind.enter(registry);
    const auto technique = registry.technique(kind.name).make();
    const Support hard = technique->supports(scene, {.name = "point", .kind = PointLight{{0, 4, 0}}}, from_aside);
    EXPECT_FALSE(hard);
    EXPECT_NE(hard.why().find("shadow_map"), std::string::npos);
    technique->apply("resolution=128,most_radius=31");
    const Support tight = technique->supports(scene, {.name = "disc", .kind = DiscLight{{0, 4, 0}}}, from_aside);
    EXPECT_FALSE(tight);
    EXPECT_NE(tight.why().find("132"), std::string::npos) << tight.why();
  }
}

}  // namespace area_maps_test
