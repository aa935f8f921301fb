// Filtered maps with every prefilter and number of bits: what they answer is what the taps of explain() say.
#include <gtest/gtest.h>

#include <cmath>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_variance_map(gnomon::Registry&);
extern "C" void gnomon_technique_exponential_map(gnomon::Registry&);
extern "C" void gnomon_technique_exponential_variance_map(gnomon::Registry&);
extern "C" void gnomon_technique_moment_map(gnomon::Registry&);

namespace prefiltered_maps_test {
using namespace gnomon;

class PrefilteredMaps : public testing::Test {
 protected:
  PrefilteredMaps() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
};

struct Contender {
  void (*enter)(Registry&);
  std::string settings;
  double tolerance;
};

// A square over a ground, both across the axis of the image: texels hold one of two depths, and of those that are the ground's
// a share s of light arrives that is their share of the weights. The bias looks up 0.25 texel = 0.008 before the ground, of a
// depth range of 1: mean and ground are apart by 1 - s less that, and Chebyshev's bound moves by 2 * 0.008 s, and to 1 where
// 1 - s is no more. What a variance is off by where 16 bits round, v, leaks by v: 0.01 of the squares of floats.
double lit_share(const Explanation& why) {
  double lit = 0;
  for (const Tap& tap : why.taps)
    if (tap.origin.y + tap.direction.y * tap.stored < 0.5) lit += tap.weight;
  return lit;
}

TEST_F(PrefilteredMaps, answer_what_the_weights_of_their_taps_say) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::ground(1, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 2, 9}, .target = {0, 0, 0}}, 96, 72);
  const Light lights[] = {{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}},
                          {.name = "point", .kind = PointLight{{0, 4.5f, 0}}}};
  const Contender contenders[] = {{gnomon_technique_variance_map, "", 0.02},
                                  {gnomon_technique_variance_map, "bits=16", 0.02},
                                  {gnomon_technique_moment_map, "", 0.01},
                                  {gnomon_technique_moment_map, "bits=16", 0.015},
                                  {gnomon_technique_exponential_variance_map, "", 0.01},
                                  {gnomon_technique_exponential_variance_map, "bits=16,exponent=5,negative_exponent=5", 0.03}};
  for (const Light& light : lights)
    for (const std::string filter : {"prefilter=blur", "prefilter=mips", "prefilter=mips,widest_footprint=6,blur_radius=0",
                                     "prefilter=table,bits=32", "prefilter=table,bits=32,widest_footprint=40"})
      for (const Contender& contender : contenders) {
        const bool is_table = filter.starts_with("prefilter=table");
        if (is_table && (light.name == "point" || contender.settings.starts_with("bits"))) continue;
        std::string settings = "resolution=256," + filter;
        if (!contender.settings.empty()) settings += "," + contender.settings;
        if (is_table && contender.enter == gnomon_technique_exponential_variance_map) settings += ",exponent=5";
        const auto run = small_world::run(contender.enter, settings, scene, light, g);
        int partly = 0;
        double worst = 0;
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(scene, g, light, i) || g.mesh[i] != 0) continue;
          const auto why = *run.technique->explain(i);
          if (why.taps.empty() || !why.covered) continue;
          const double lit = lit_share(why);
          partly += lit > 0.02 && lit < 0.98;
          worst = std::max(worst, std::abs(run.mask[i] - lit));
        }
        EXPECT_GE(partly, 12) << settings << ' ' << light.name;
        EXPECT_LE(worst, contender.tolerance) << settings << ' ' << light.name;
      }
}

struct Refusal {
  void (*enter)(Registry&);
  std::string settings, light, reason;
};

TEST_F(PrefilteredMaps, what_a_texel_cannot_hold_is_refused_with_the_reason) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  const Light sun{.name = "sun", .kind = DirectionalLight{}}, point{.name = "point", .kind = PointLight{}};
  const Refusal refusals[] = {
      {gnomon_technique_variance_map, "prefilter=table", "point", "prefilter=table takes no lights with six"},
      {gnomon_technique_moment_map, "prefilter=table,bits=16", "sun", "prefilter=table takes bits=32"},
      {gnomon_technique_moment_map, "prefilter=mips,resolution=1000", "sun", "a resolution that 16 divides"},
      {gnomon_technique_exponential_map, "bits=16,exponent=11.1", "sun", "exponents up to 11.08"},
      {gnomon_technique_exponential_map, "prefilter=table", "sun", "exponents up to 10"},
      {gnomon_technique_exponential_variance_map, "bits=16", "point", "exponents up to 5.54"},
      {gnomon_technique_exponential_variance_map, "bits=16,exponent=5,negative_exponent=6", "sun", "exponents up to 5.54"},
      {gnomon_technique_exponential_variance_map, "prefilter=table", "sun", "squares of exponents up to 5"}};
  const auto support = [&](const Refusal& asked) {
    Registry registry;
    asked.enter(registry);
    const auto technique = registry.techniques()[0].make();
    technique->apply(asked.settings);
    return technique->supports(scene, asked.light == "sun" ? sun : point, {});
  };
  for (const Refusal& refusal : refusals) {
    const Support answer = support(refusal);
    EXPECT_FALSE(answer) << refusal.settings;
    EXPECT_NE(answer.why().find(refusal.reason), std::string::npos) << answer.why();
  }
  for (const Refusal& allowed :
       {Refusal{gnomon_technique_exponential_map, "bits=16,exponent=11.08", "point", ""},
        Refusal{gnomon_technique_exponential_variance_map, "bits=16,exponent=5.54,components=2", "sun", ""},
        Refusal{gnomon_technique_moment_map, "bits=16,prefilter=mips", "point", ""}})
    EXPECT_TRUE(support(allowed)) << support(allowed).why();
}

// Half the bytes of what is looked up; the depth images and the blur's own image stay what they are.
TEST_F(PrefilteredMaps, sixteen_bits_take_half_of_the_bytes) {
  Scene scene;
  scene.meshes = {small_world::ground(4), small_world::ground(1, 1)};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 3, 7}, .target = {0, 0, 0}}, 32, 24);
  const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  const auto bytes = [&](const std::string& settings) {
    const auto run = small_world::run(gnomon_technique_moment_map, settings, scene, sun, g);
    return small_world::value(run.technique->counts(), "bytes");
  };
  const double texels = 256.0 * 256;
  EXPECT_EQ(bytes("resolution=256,blur_radius=0") - bytes("resolution=256,blur_radius=0,bits=16"), texels * 8);
  EXPECT_EQ(bytes("resolution=256") - bytes("resolution=256,bits=16"), texels * 16);
}

}  // namespace prefiltered_maps_test
