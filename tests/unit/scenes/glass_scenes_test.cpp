// The generated scenes whose casters let a part of the light through: glass_stack, smoke_cards, hair_cards.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "generated_scene.h"

namespace glass_scenes_test {

using namespace gnomon;
using generated::make;
using generated::mesh;

constexpr const char* ids[] = {"glass_stack", "smoke_cards", "hair_cards"};

TEST(GlassScenes, what_lets_light_through_casts_is_not_seen_and_has_what_it_needs) {
  for (const char* id : ids) {
    const Scene scene = make(id);
    EXPECT_TRUE(scene.has_transmission()) << id;
    EXPECT_FALSE(scene.has_colored_transmission()) << id;
    for (const Mesh& each : scene.meshes) {
      EXPECT_EQ(each.seen, each.transmission == nullptr) << each.name;
      EXPECT_EQ(each.uv.size(), each.needs_uv() ? each.positions.size() : 0u) << each.name;
      if (each.transmission) {
        EXPECT_TRUE(each.casts && !each.is_closed()) << each.name;
      }
    }
  }
}

TEST(GlassScenes, without_glass_the_same_casters_are_opaque) {
  for (const char* id : ids) {
    const Scene glass = make(id), opaque = make(id, "glass=false");
    EXPECT_FALSE(opaque.has_transmission());
    ASSERT_EQ(glass.meshes.size(), opaque.meshes.size());
    for (std::size_t m = 0; m < glass.meshes.size(); ++m) {
      EXPECT_EQ(glass.meshes[m].positions, opaque.meshes[m].positions);
      EXPECT_TRUE(opaque.meshes[m].seen);
    }
  }
}

// Below the middle of the stack the sun comes through all three sheets: 0.5 * 0.75 * 0.2.
TEST(GlassScenes, a_stack_of_three_lets_through_what_is_on_paper) {
  const Scene scene = make("glass_stack");
  const ExactScene exact(scene);
  const auto below = [&](const glm::vec3& way) {
    ExactTally tally;
    return exact.transmitted({.point = {-0.3f, 0, 0}}, glm::dvec4(-way, 0), tally).light;
  };
  const Crossings::Product found = below({0, -1, 0});
  EXPECT_EQ(found.surfaces, 3);
  EXPECT_NEAR(found.share.x, 0.075, 1e-8);
  ExactTally tally;
  EXPECT_EQ(exact.transmitted({.point = {0.35f, 0, 0.3f}}, {0, 1, 0, 0}, tally).light.share.x, 0);  // the ball
}

TEST(GlassScenes, sheets_have_the_transmission_that_was_given) {
  const Scene scene = make("glass_stack", "sheets=5,transmission=0.9");
  EXPECT_EQ(std::ranges::count_if(scene.meshes, [](const Mesh& m) { return m.transmission != nullptr; }), 5);
  EXPECT_EQ(mesh(scene, "sheet_5").transmission->at(0, 0).x, 0.9f);
}

// More cards are thinner ones: the puff as a whole lets the same part through, in the mean over ways down through its middle.
TEST(GlassScenes, smoke_is_as_dense_with_more_cards) {
  const auto mean_absorbance = [](const char* settings) {
    const Scene scene = make("smoke_cards", settings);
    const ExactScene exact(scene);
    double sum = 0;
    int count = 0;
    for (int x = -5; x <= 5; ++x)
      for (int z = -5; z <= 5; ++z) {
        ExactTally tally;
        const glm::vec3 point(0.04f * static_cast<float>(x), 0.6f, 0.04f * static_cast<float>(z));
        sum -= std::log(exact.transmitted({.point = point}, {0, 1, 0, 0}, tally).light.share.x);
        ++count;
      }
    return sum / count;
  };
  const double few = mean_absorbance("count=96"), many = mean_absorbance("count=1536");
  EXPECT_GT(few, 0.5);
  EXPECT_NEAR(many / few, 1, 0.35);
}

TEST(GlassScenes, hair_has_thick_strands_among_thin_ones) {
  const Scene scene = make("hair_cards");
  const Transmission& streaks = *mesh(scene, "hair").transmission;
  EXPECT_EQ(streaks.width(), 24);
  EXPECT_EQ(streaks.height(), 1);
  const auto thick = std::ranges::count_if(streaks.values(), [](float t) { return t <= 0.5f; });
  EXPECT_GT(thick, 2);
  EXPECT_LT(thick, 16);
  for (const float t : streaks.values()) EXPECT_TRUE((t >= 0.1f && t <= 0.5f) || (t >= 0.85f && t <= 0.98f)) << t;
}

}  // namespace glass_scenes_test
