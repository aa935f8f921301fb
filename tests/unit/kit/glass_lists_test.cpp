// Exact lists of the glass on rays, which explain what maps of glass answer.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/maps/glass_lists.h>
#include <gtest/gtest.h>

#include "glass.h"

namespace glass_lists_test {
using namespace gnomon;

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

// A direction of 2 m: sheets 2 m and 4 m below the origin are 1 and 2 of it away.
TEST(GlassLists, sheets_are_listed_from_near_to_far) {
  const Scene scene = scene_of(
      {hand_made::square(1, 0), glass::glass_card(1, 1, 0.5f), glass::glass_card(1, 3, 0.9f), glass::glass_card(1, 2, 1.0f)});
  const GlassLists lists(scene);
  const auto list = lists.along({0.2, 5, 0.3}, {0, -2, 0});
  ASSERT_EQ(list.size(), 2u) << "opaque sheets are no glass, and what lets everything through is not there";
  EXPECT_DOUBLE_EQ(list[0].distance, 1);
  EXPECT_DOUBLE_EQ(list[0].transmission, 0.9f);
  EXPECT_DOUBLE_EQ(list[1].distance, 2);
  EXPECT_DOUBLE_EQ(share_before(list, 0.5), 1);
  EXPECT_DOUBLE_EQ(share_before(list, 1.5), 0.9f);
  EXPECT_DOUBLE_EQ(share_before(list, 3), 0.5 * double(0.9f));
  EXPECT_TRUE(lists.along({0.2, 5, 0.3}, {0, 1, 0}).empty()) << "nothing is behind the origin";
}

// The diagonal of a square is an edge of two triangles: one of them counts.
TEST(GlassLists, a_common_edge_counts_once) {
  const Scene scene = scene_of({glass::glass_card(1, 1, 0.5f)});
  const GlassLists lists(scene);
  for (const double x : {-0.75, -0.5, 0.0, 0.25}) {
    EXPECT_EQ(lists.along({x, 3, x}, {0, -1, 0}).size(), 1u) << x;
    EXPECT_EQ(lists.along({0, 3, 0}, {x, -2, x}).size(), 1u) << x;
  }
}

// Down from a light, before a point, is what is on the way up from the point: the product of what the exact oracle crosses.
// Ways through edges and along borders of texels, where double may see the other side, are some in a million.
TEST(GlassLists, lists_hold_what_the_exact_oracle_crosses) {
  Random random(31);
  int crossed = 0;
  for (int round = 0; round < 60; ++round) {
    const int count = 1 + static_cast<int>(random.below(12));
    const auto mask = random.below(2) ? masked::any_mask(random, 6) : nullptr;
    Scene scene = scene_of({glass::random_glass_cards(random, count, 1, 1, glass::any_texels(random, 5)),
                            glass::with_transmission(masked::random_cards(random, count, 1, 1, mask), glm::vec3(0.3f))});
    const GlassLists lists(scene);
    const ExactScene exact(scene);
    ExactTally tally;
    for (int i = 0; i < 200; ++i) {
      const auto point = glm::vec3(random.uniform(glm::dvec3(-1.5), glm::dvec3(1.5)));
      const auto light = glm::vec3(random.uniform(glm::dvec3(-2, 2, -2), glm::dvec3(2, 4, 2)));
      const ExactShare found = exact.transmitted({point}, glm::dvec4(light, 1), tally);
      const auto list = lists.along(light, glm::dvec3(point) - glm::dvec3(light));
      EXPECT_NEAR(share_before(list, 1), found.light.share.x, 1e-12) << "round " << round << ", way " << i;
      crossed += found.light.surfaces > 1;
    }
  }
  EXPECT_GT(crossed, 500);
}

}  // namespace glass_lists_test
