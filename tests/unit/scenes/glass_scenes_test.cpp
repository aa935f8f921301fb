// The generated scenes whose casters let a part of the light through: glass_stack, smoke_cards, hair_cards, stained_window.
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

TEST(GlassScenes, a_stained_window_has_panes_between_lead_and_a_cloth_behind) {
  const Scene scene = make("stained_window", "columns=3,rows=2,texels=5"), gray = make("stained_window", "colored=false");
  EXPECT_TRUE(scene.has_colored_transmission());
  EXPECT_TRUE(gray.has_transmission() && !gray.has_colored_transmission());
  const Transmission& panes = *mesh(scene, "window").transmission;
  EXPECT_EQ(panes.width(), 16);
  EXPECT_EQ(panes.height(), 11);
  int lead = 0;
  for (int row = 0; row < panes.height(); ++row)
    for (int column = 0; column < panes.width(); ++column) {
      const glm::vec3 light = panes.at(column, row);
      if (light == glm::vec3(0)) ++lead;
      EXPECT_EQ(light, panes.at(column - column % 5 + (column % 5 ? 1 : 0), row - row % 5 + (row % 5 ? 1 : 0)))
          << "one color a pane";
    }
  EXPECT_EQ(lead, 16 * 11 - 6 * 4 * 4) << "six panes of four by four texels";
  // From the floor toward the sun through cloth and window: the product of both, channel by channel.
  const glm::vec3 in_cloth{0.75f, 1.4f, 0.85f}, way{-0.25f, 0.9f, -0.75f};
  const glm::dvec2 at_window = glm::dvec2(in_cloth) + glm::dvec2(way) * (0.85 / 0.75);
  const Scene full = make("stained_window");
  const Transmission& five = *mesh(full, "window").transmission;
  const glm::vec3 pane = five.at(int((at_window.x + 1) / 2 * five.width()), int((at_window.y - 0.8) / 2.4 * five.height()));
  const glm::vec3 floor = in_cloth - way * (1.4f / 0.9f);
  ExactTally tally;
  const Crossings::Product found =
      ExactScene(full).transmitted({.point = {floor.x, 0, floor.z}}, glm::dvec4(way, 0), tally).light;
  ASSERT_EQ(found.surfaces, 2);
  const glm::vec3 product = pane * mesh(full, "cloth").transmission->at(0, 0);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(found.share[c], product[c], 1e-7) << c;
}

}  // namespace glass_scenes_test
