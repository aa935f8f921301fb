// Products of what crossed triangles let through: in any order the same bits, and stacks, boxes and edges on paper.
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gtest/gtest.h>

#include <map>

#include "glass.h"
#include "small_world.h"

namespace gnomon::crossings_test {

using glass::glass_card;

/// Some random triangles with what they let through.
std::map<Crossings::Crossed, glm::vec3> random_factors(Random& random) {
  std::map<Crossings::Crossed, glm::vec3> factors;
  const std::uint32_t count = random.below(24);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t mesh = random.below(3), triangle = random.below(20);
    glm::vec3 factor(random.uniform(glm::dvec3(0.3), glm::dvec3(1)));
    if (random.below(4) == 0) factor = glm::vec3(1);
    if (random.below(40) == 0) factor.y = 0;
    factors[{mesh, triangle}] = factor;
  }
  return factors;
}

// The product by mesh and triangle, each once, whatever the order in which they come and how often. In the order in which they
// come it would differ in the last bits, which is counted to show that the question is one.
TEST(crossings, the_product_is_the_same_bits_in_any_order_and_with_any_duplicates) {
  Random random(3);
  int differ = 0, several = 0;
  for (int round = 0; round < 300; ++round) {
    const auto factors = random_factors(random);
    glm::dvec3 expected(1);
    int surfaces = 0;
    std::vector<Crossings::Crossed> all;
    for (const auto& [crossed, factor] : factors) {
      expected *= glm::dvec3(factor);
      surfaces += factor != glm::vec3(1);
      for (std::uint32_t copies = random.below(3) + 1; copies > 0; --copies) all.push_back(crossed);
    }
    several += surfaces > 2;
    Crossings crossings;
    for (int order = 0; order < 8; ++order) {
      random.shuffle(all);
      crossings.clear();
      EXPECT_TRUE(crossings.empty());
      for (const auto& [mesh, triangle] : all) crossings.add(mesh, triangle);
      EXPECT_EQ(crossings.empty(), all.empty());
      int asked = 0;
      const Crossings::Product product = crossings.product([&](std::uint32_t mesh, std::uint32_t triangle) {
        ++asked;
        return factors.at({mesh, triangle});
      });
      EXPECT_EQ(product.share, expected) << round << ' ' << order;
      EXPECT_EQ(product.surfaces, surfaces) << round << ' ' << order;
      EXPECT_EQ(asked, static_cast<int>(factors.size())) << round << ' ' << order;
      glm::dvec3 as_they_come(1);
      std::map<Crossings::Crossed, int> met;
      for (const Crossings::Crossed& crossed : all)
        if (met[crossed]++ == 0) as_they_come *= glm::dvec3(factors.at(crossed));
      differ += as_they_come != expected;
    }
  }
  EXPECT_GT(several, 150);
  EXPECT_GT(differ, 300);
}

TEST(crossings, are_sorted_by_mesh_and_then_triangle_each_once) {
  Crossings crossings;
  for (const auto& [mesh, triangle] :
       std::vector<std::pair<std::uint32_t, std::uint32_t>>{{1, 0}, {0, 7}, {1, 0}, {0, 2}, {0, 7}})
    crossings.add(mesh, triangle);
  const std::vector<Crossings::Crossed> expected = {{0, 2}, {0, 7}, {1, 0}};
  EXPECT_TRUE(std::ranges::equal(crossings.sorted(), expected));
  EXPECT_TRUE(std::ranges::equal(crossings.sorted(), expected));
}

ExactShare from(const std::vector<Mesh>& meshes, const glm::vec3& point, const glm::vec3& light) {
  Scene scene;
  scene.meshes = meshes;
  ExactTally tally;
  return ExactScene(scene).transmitted({point}, glm::dvec4(glm::dvec3(light), 1), tally);
}
/// Aside of the diagonal of a card.
constexpr glm::vec3 below(0.3f, 0, 0.1f), above(0.3f, 9, 0.1f);

// Surfaces that let .5, .75 and .2 through, from the light on: .5 * .75 * .2 = .075; between the second and the third .375.
TEST(crossings, a_stack_lets_the_product_through) {
  const std::vector<Mesh> stack = {glass_card(1, 3, 0.5f), glass_card(1, 2, 0.75f), glass_card(1, 1, 0.2f)};
  const ExactShare behind = from(stack, below, above);
  EXPECT_NEAR(behind.light.share.x, 0.375 * static_cast<double>(0.2f), 1e-12);
  EXPECT_NEAR(behind.light.share.x, 0.075, 1e-8);  // 0.2f is 3e-9 above 0.2
  EXPECT_EQ(behind.light.share, glm::dvec3(behind.light.share.x));
  EXPECT_EQ(behind.light.surfaces, 3);
  EXPECT_FALSE(behind.degenerate);
  for (const auto& [height, share, surfaces] :
       std::vector<std::tuple<float, double, int>>{{1.5f, 0.375, 2}, {2.5f, 0.5, 1}, {3.5f, 1, 0}}) {
    const ExactShare found = from(stack, {below.x, height, below.z}, above);
    EXPECT_EQ(found.light.share.x, share) << height;
    EXPECT_EQ(found.light.surfaces, surfaces) << height;
  }
}

TEST(crossings, an_opaque_card_anywhere_in_a_stack_lets_nothing_through) {
  const std::vector<Mesh> stack = {glass_card(1, 3, 0.5f), glass_card(1, 2, 0.75f), glass_card(1, 1, 0.2f)};
  for (const float height : {0.5f, 1.5f, 2.5f, 3.5f})
    for (const Mesh& opaque : {hand_made::square(1, height), glass_card(1, height, 0), glass_card(1, height, -0.0f)}) {
      std::vector<Mesh> meshes = stack;
      meshes.push_back(opaque);
      for (int turn = 0; turn < 4; ++turn) {
        std::ranges::rotate(meshes, meshes.begin() + 1);
        EXPECT_EQ(from(meshes, below, above).light.share, glm::dvec3(0)) << height << ' ' << turn;
      }
    }
}

TEST(crossings, a_surface_that_lets_all_through_is_none) {
  const ExactShare found = from({glass_card(1, 3, 1), glass_card(1, 2, 0.5f)}, below, above);
  EXPECT_EQ(found.light.share, glm::dvec3(0.5));
  EXPECT_EQ(found.light.surfaces, 1);
}

// A box of .5 in a box of .9. A way through both crosses each twice: .9^2 .5^2 = .2025; from inside of both .9 * .5 = .45.
TEST(crossings, a_box_is_crossed_where_the_way_enters_and_where_it_leaves) {
  const std::vector<Mesh> boxes = {glass::with_transmission(small_world::box({-2, 1, -2}, {2, 4, 2}), glm::vec3(0.9f)),
                                   glass::with_transmission(small_world::box({-1, 2, -1}, {1, 3, 1}), glm::vec3(0.5f))};
  const double outer = 0.9f;
  const ExactShare through = from(boxes, below, above);
  EXPECT_EQ(through.light.share.x, outer * outer * 0.25);
  EXPECT_NEAR(through.light.share.x, 0.2025, 1e-7);
  EXPECT_EQ(through.light.surfaces, 4);
  EXPECT_FALSE(through.degenerate);
  const ExactShare inside = from(boxes, {0.3f, 2.5f, 0.1f}, above);
  EXPECT_EQ(inside.light.share.x, outer * 0.5);
  EXPECT_NEAR(inside.light.share.x, 0.45, 1e-7);
  EXPECT_EQ(inside.light.surfaces, 2);
}

// Triangles are closed: a way through the diagonal meets both, .5 * .5. The tests of the reference leave such ways out.
TEST(crossings, a_way_through_the_diagonal_of_a_quad_counts_both_triangles_and_says_so) {
  const ExactShare diagonal = from({glass_card(1, 1, 0.5f)}, {0.25f, 0, 0.25f}, {0.25f, 9, 0.25f});
  EXPECT_EQ(diagonal.light.share, glm::dvec3(0.25));
  EXPECT_EQ(diagonal.light.surfaces, 2);
  EXPECT_TRUE(diagonal.degenerate);
  const ExactShare aside = from({glass_card(1, 1, 0.5f)}, {0.25f, 0, 0.125f}, {0.25f, 9, 0.125f});
  EXPECT_EQ(aside.light.share, glm::dvec3(0.5));
  EXPECT_FALSE(aside.degenerate);
  // Behind what blocks it properly, an edge of glass decides nothing.
  EXPECT_FALSE(from({glass_card(1, 1, 0.5f), small_world::make_mesh({{-3, 2, -3}, {3, 2, -3}, {0, 2, 5}}, {{0, 1, 2}})},
                    {0.25f, 0, 0.25f}, {0.25f, 9, 0.25f})
                   .degenerate);
}

TEST(crossings, each_color_has_a_product_of_its_own) {
  const ExactShare found = from({glass::with_transmission(hand_made::square(1, 1), {0.5f, 0.25f, 1}),
                                 glass::with_transmission(hand_made::square(1, 2), {0.5f, 1, 1})},
                                below, above);
  EXPECT_EQ(found.light.share, glm::dvec3(0.25, 0.25, 1));
  EXPECT_EQ(found.light.surfaces, 2);
}

}  // namespace gnomon::crossings_test
