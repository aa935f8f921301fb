// Causes of soft errors beside casters that let a part of the light through.
#include "glass.h"
#include "soft_world.h"

namespace soft_glass_causes_test {

using namespace gnomon;
using namespace gnomon::soft_world;
using cause_world::on_ground;
using cause_world::plate;

constexpr float half = 0.6f;

/// A plate of 2.4 m square that only casts, at 2 m below a lamp of 1.2 m square at 6 m: all of the lamp is dimmed in a square
/// of 3 m on the ground, its penumbra is 0.6 m wide.
Mesh pane(float share) {
  Mesh mesh = glass::with_transmission(plate(-1.2f, 1.2f, -1.2f, 1.2f, 2), glm::vec3(share));
  mesh.seen = false;
  return mesh;
}
World pane_and_lamp(float share = 0.4f) { return World(on_ground({pane(share)}), lamp(half)); }

double unexplained(std::map<std::string, double> shares) { return shares["unexplained"]; }

TEST(soft_glass_causes, a_right_mask_has_no_cause_but_the_reference_s_own_error) {
  World world = pane_and_lamp();
  EXPECT_TRUE(world.shares().empty());
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = std::clamp(world.mask[i] + 0.002f, 0.0f, 1.0f);
  for (const Cause cause : world.causes()) EXPECT_TRUE(cause == Cause::none || cause == Cause::reference_error);
}

TEST(soft_glass_causes, a_pane_that_casts_no_shadow_is_missing) {
  for (const float share : {0.0f, 0.4f, 0.9f, 0.985f}) {
    World world = pane_and_lamp(share);
    std::ranges::fill(world.mask, 1.0f);
    EXPECT_GT(world.shares()["missing_caster"], 0.9) << share;
    EXPECT_EQ(unexplained(world.shares()), 0) << share;
  }
}

TEST(soft_glass_causes, a_pane_taken_for_opaque_is_a_dark_region) {
  World world = pane_and_lamp();
  world.mask = world.seen_of(world.light, on_ground({plate(-1.2f, 1.2f, -1.2f, 1.2f, 2)}));
  // Of the error 0.6 * 9 m2 is where all of the lamp is dimmed, the rest in the penumbra.
  EXPECT_GT(world.shares()["region"], 0.6);
  EXPECT_EQ(unexplained(world.shares()), 0);
}

TEST(soft_glass_causes, the_form_of_a_penumbra_of_glass) {
  for (const float share : {0.2f, 0.7f}) {
    World world = pane_and_lamp(share);
    world.mask = world.seen_of(lamp(1.5f * half));
    EXPECT_GT(world.shares()["too_wide"], 0.9) << share;
    world.mask = world.seen_of(lamp(0.6f * half));
    EXPECT_GT(world.shares()["too_narrow"], 0.85) << share;
    world.mask = world.seen_of(lamp(half, {0.3f, 0.1f}));
    EXPECT_GT(world.shares()["shifted"], 0.85) << share;
    trace_shadows(world.casters, world.scene, world.gbuffer, hand_made::point_light({0, 6, 0}), world.mask);
    EXPECT_GT(world.shares()["hard_shadow"], 0.9) << share;
  }
}

// The places are those of the reference; what is seen of them is not.
TEST(soft_glass_causes, samples_that_take_glass_for_opaque_are_false) {
  World world = pane_and_lamp();
  const Scene opaque_scene = on_ground({plate(-1.2f, 1.2f, -1.2f, 1.2f, 2)});
  const RayScene opaque(opaque_scene, Truth::mesh, RayScene::Which::casters);
  const auto samples_of = [&](std::uint32_t i, const RayScene& casters) {
    const LightFigure figure(world.light, world.gbuffer.position(i), world.gbuffer.normal(i));
    const FaceRays rays(casters, world.gbuffer, i, figure);
    const Scramble scramble(i);
    Explanation why;
    for (std::uint32_t group = 0; group < 4; ++group) {
      const Squares squares = scramble.of_first(group);
      const FaceHits hits = rays.ask(squares);
      for (int k = 0; k < 16; ++k) {
        const glm::dvec2 place = figure.box().at({squares.x[k], squares.y[k]});
        why.samples.push_back({glm::dvec3(world.gbuffer.position(i)) + figure.at(place), 1.0 / 64, hits.seen(k)});
      }
    }
    return why;
  };
  const auto take = [&](const RayScene& casters) {
    for (std::uint32_t i = 0; i < world.mask.size(); ++i) {
      if (world.truth.classes[i] != PixelClass::T) continue;
      double sum = 0;
      for (const LightSample& sample : samples_of(i, casters).samples) sum += sample.weight * sample.visibility;
      world.mask[i] = static_cast<float>(sum);
    }
  };
  take(opaque);
  EXPECT_GT(world.shares([&](std::uint32_t i) { return samples_of(i, opaque); })["false_sample"], 0.95);
  take(world.casters);
  const std::map<std::string, double> shares = world.shares([&](std::uint32_t i) { return samples_of(i, world.casters); });
  EXPECT_FALSE(shares.contains("false_sample"));
}

// Where two panes overlap, the product of what each leaves is more than their minimum: a technique that takes the minimum errs.
TEST(soft_glass_causes, panes_that_are_not_multiplied) {
  const auto pane_at = [](float x0, float x1, float share, float height) {
    Mesh mesh = glass::with_transmission(plate(x0, x1, -2, 2, height), glm::vec3(share));
    mesh.seen = false;
    return mesh;
  };
  const Mesh left = pane_at(-2, 1, 0.4f, 2), right = pane_at(-1, 2, 0.6f, 2.5f);
  World world(on_ground({left, right}), lamp(half));
  const std::vector<float> by_left = world.seen_of(world.light, on_ground({left})),
                           by_right = world.seen_of(world.light, on_ground({right}));
  for (std::size_t i = 0; i < world.mask.size(); ++i) world.mask[i] = std::min(by_left[i], by_right[i]);
  EXPECT_GT(world.shares()["caster_fusion"], 0.85);
  EXPECT_EQ(unexplained(world.shares()), 0);
}

}  // namespace soft_glass_causes_test
