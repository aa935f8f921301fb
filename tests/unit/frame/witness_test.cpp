// The reference under lights without area against masks made by POV-Ray and Cycles, which share no code with it.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "measure/frame/boundary.h"
#include "witness_mask.h"

namespace gnomon::witness_test {

constexpr int width = 640, height = 360;
constexpr double allowed_share = 2e-5;
// Both programs round; a pixel may fall to the other side only where the shadow's edge runs through it. Both sides of the
// edge are marked, so such a pixel is 0 or 1 away, and the square root of 2 across a corner.
constexpr float allowed_distance = 1.5f;

struct Agreement {
  std::size_t facing = 0, dark = 0, different = 0;
  float farthest = 0;  ///< of the different but those of class S, pixels from the edge
  bool holds() const {
    return dark > 1000 && static_cast<double>(different) <= allowed_share * static_cast<double>(facing) &&
           farthest <= allowed_distance;
  }
};

Agreement compare(const WitnessedFrame& frame, const Light& light, std::span<const float> witness) {
  const GBuffer& g = frame.gbuffer;
  std::vector<float> reference(g.size());
  Agreement result{.facing = trace_shadows(frame.casters, frame.scene, g, light, reference)};
  // The edge among the pixels that face the light alone: the others are 1 in the reference and anything in the witness.
  std::vector<PixelClass> classes(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) classes[i] = faces_light(frame.scene, g, light, i) ? PixelClass::T : PixelClass::F;
  const std::vector<float> distance = distance_transform(shadow_boundary(reference, classes, width, height), width, height);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (classes[i] != PixelClass::T) continue;
    result.dark += reference[i] == 0;
    if (is_lit(witness[i]) == is_lit(reference[i])) continue;
    ++result.different;
    if (frame.silhouettes[i]) continue;  // it may show another surface
    result.farthest = std::max(result.farthest, distance[i]);
  }
  return result;
}

class Witness : public testing::TestWithParam<std::tuple<WitnessInfo, const char*, const char*>> {};

TEST_P(Witness, agrees_with_the_reference) {
  const auto [info, scene, light] = GetParam();
  const WitnessedFrame frame(scene, light, info.truth, width, height);
  const std::vector<float> witness = read_witness(info, scene, light, width, height);
  ASSERT_EQ(witness.size(), frame.gbuffer.size()) << "run tests/witness/make_witnesses";
  const Agreement a = compare(frame, frame.light, witness);
  const std::string text = fmt::format(
      "{} {} {}: {} facing, {} dark, {} different ({:.2g}), farthest {:.2f} px from the edge\n", info.id, scene, light,
      a.facing, a.dark, a.different, static_cast<double>(a.different) / static_cast<double>(a.facing), a.farthest);
  std::cout << text;
  EXPECT_TRUE(a.holds()) << text << "if scenes/" << scene << ".cpp has changed, run tests/witness/make_witnesses";
}

INSTANTIATE_TEST_SUITE_P(all, Witness,
                         testing::Combine(testing::Values(pov_ray, cycles),
                                          testing::Values("box_city", "composite", "contact", "cornell_box", "fence", "soup",
                                                          "sphere_field", "sphere_over_plane"),
                                          testing::Values("point", "sun")),
                         [](const auto& info) {
                           return fmt::format("{}_{}_{}", std::get<0>(info.param).id, std::get<1>(info.param),
                                              std::get<2>(info.param));
                         });

// A pixel shows about a centimeter of the ground, on which the shadow moves by a few tenths of what the light does.
TEST(WitnessOfAnotherLight, is_refused) {
  for (const WitnessInfo& info : {pov_ray, cycles}) {
    const WitnessedFrame frame("sphere_over_plane", "point", info.truth, width, height);
    Light moved = frame.light;
    std::get<PointLight>(moved.kind).position.x += 0.005f;
    const std::vector<float> witness = read_witness(info, "sphere_over_plane", "point", width, height);
    ASSERT_EQ(witness.size(), frame.gbuffer.size());
    EXPECT_TRUE(compare(frame, frame.light, witness).holds());
    EXPECT_FALSE(compare(frame, moved, witness).holds());
  }
}

}  // namespace gnomon::witness_test
