// Registered planar shadows of glass: for each point of the light the exact product, summed.
#include "device/context.h"
#include "glass_masks.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_registered_planar(gnomon::Registry&);

namespace registered_glass_test {
using namespace glass_masks;

class RegisteredGlass : public testing::Test {
 protected:
  RegisteredGlass() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
  static small_world::Run run(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings) {
    return small_world::run(gnomon_technique_registered_planar, settings, scene, light, g);
  }
};

const std::vector<Light> area_lights = {
    {.name = "rect", .kind = RectLight{{-0.5f, 4, 0.5f}, {0.5f, 0, 0}, {0, 0, 0.5f}}},
    {.name = "disc", .kind = DiscLight{{-0.5f, 4, 0.5f}, {0.2f, -1, 0}, 0.5f}},
    {.name = "globe", .kind = SphereLight{{-0.5f, 4, 0.5f}, 0.5f}},
};

// Texels of the ground are 8 m / 254, and what is looked up is blurred over one or two: the mean error is that of a shadow's
// edges, each a step of one point in 16.
TEST_F(RegisteredGlass, masks_are_means_of_the_exact_products_to_the_points_of_the_light) {
  Random random(12);
  double sum = 0, shaded = 0, tested = 0;
  for (int round = 0; round < 2; ++round) {
    const Scene scene = stacks_and_nests(random, true);
    const GBuffer g = seen_of(scene, from_above, 60, 45);
    const ExactScene exact(scene);
    for (const Light& light : area_lights) {
      const small_world::Run found = run(scene, light, g, "samples=16,resolution=256");
      ExactTally tally;
      for (std::size_t i = 0; i < g.size(); i += 7) {
        const auto why = found.technique->explain(i);
        if (!why || why->samples.empty()) continue;
        double expected = 0;
        for (const LightSample& sample : why->samples)
          expected +=
              sample.weight *
              exact.transmitted({g.position(i), g.mesh[i], g.triangle[i]}, glm::dvec4(sample.place, 1), tally).light.share.x;
        ++tested;
        shaded += expected > 0.01 && expected < 0.99;
        sum += std::abs(found.mask[i] - expected);
      }
    }
  }
  EXPECT_GT(tested, 1000);
  EXPECT_GT(shaded, tested / 4);
  EXPECT_LT(sum / tested, 0.004);
}

// The light is 1 m wide; a card of 0.4 at half its height ends under its middle: half of the light is seen through it from
// below its edge, 0.5 + 0.5 * 0.4 = 0.7. Far under the card 0.4, as each point's.
TEST_F(RegisteredGlass, half_of_a_lamp_behind_glass) {
  Mesh card = glass::glass_card(1.5f, 2, 0.4f);
  for (glm::vec3& p : card.positions) p.x -= 1.5f;
  finish(card);
  const Scene scene = scene_of({hand_made::square(4, 0), unseen(card)});
  hand_made::Picture picture(2, 1);
  picture.set(0, {0, 0, 0.1f}, {0, 1, 0}, 0, 0);
  picture.set(1, {-1.5f, 0, 0.1f}, {0, 1, 0}, 0, 0);
  const Light lamp{.name = "lamp", .kind = RectLight{{0, 4, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}};
  const std::vector<float> found = run(scene, lamp, picture.gbuffer, "samples=64,resolution=256").mask;
  EXPECT_NEAR(found[0], 0.7, 0.02);
  EXPECT_NEAR(found[1], 0.4, 1e-5);
}

TEST_F(RegisteredGlass, black_glass_is_opaque) {
  Random random(2);
  Scene black = stacks_and_nests(random, true);
  for (Mesh& mesh : black.meshes)
    if (mesh.transmission) mesh.transmission = glass::constant(glm::vec3(0));
  Scene opaque = black;
  for (Mesh& mesh : opaque.meshes) mesh.transmission = nullptr;
  const GBuffer g = seen_of(opaque, from_above, 80, 60);
  for (const Light& light : area_lights) {
    const std::vector<float> a = run(black, light, g, "resolution=256").mask, b = run(opaque, light, g, "resolution=256").mask;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-6) << light.name;
    EXPECT_LT(std::ranges::count(a, 1.0f), std::ssize(a) * 9 / 10);
  }
}

}  // namespace registered_glass_test
