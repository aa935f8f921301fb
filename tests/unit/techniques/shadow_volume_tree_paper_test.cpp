// Parts of the shadow volume tree on paper: planes, ways, wedges and visits.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include "hand_made.h"
#include "techniques/shadow_volume_tree/tree.h"

namespace gnomon::shadow_volume_tree_paper_test {

using namespace hand_made;
using namespace shadow_volume_tree;

constexpr std::uint32_t some_mesh = 7;

/// Turned to the light, as the tree needs it.
Caster caster(const Frame& frame, glm::vec3 a, glm::vec3 b, glm::vec3 c, std::uint32_t triangle = 0) {
  if (orient3d_sign(a, b, c, frame.light) < 0) std::swap(b, c);
  Caster made{{a, b, c}, some_mesh, triangle};
  made.steepness = frame.steepness(made);
  return made;
}

/// The triangle (0, 1, 0), (0, 1, 4), (4, 1, 0) under the sun straight down has the shadow planes x = 0, x + z = 4 and z = 0
/// in this order, and shades 0 < x, x + z < 4, 0 < z, y < 1.
struct Paper {
  Frame frame;
  Caster first;
  Planes planes;
  explicit Paper(const glm::dvec4& light = {0, 1, 0, 0})
      : frame(light, Bounds{{-8, -8, -8}, {8, 8, 8}}),
        first(caster(frame, {0, 1, 0}, {0, 1, 4}, {4, 1, 0})),
        planes(first, frame) {}
  Way way(const Caster& other, Wedges& wedges) const {
    SignCounts counts;
    return way_of(other, first, planes, frame, Planes::error(frame.reach), wedges, counts);
  }
  Way way(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) const {
    Wedges wedges;
    return way(caster(frame, a, b, c), wedges);
  }
};

// Normals are scaled to component sums of 1: x; (4 - x - z) / 2; z; and y - 1.
TEST(ShadowVolumeTree, planes_on_paper) {
  const Paper paper;
  const Four values = paper.planes.at({0.5f, 3, 1});
  EXPECT_EQ(values[0], 0.5f);
  EXPECT_EQ(values[1], 1.25f);
  EXPECT_EQ(values[2], 1);
  EXPECT_EQ(values[3], 2);
}

// All children, for casters beside the planes, touching them and across. What only touches a plane from inside goes inside.
TEST(ShadowVolumeTree, ways_on_paper) {
  const Paper paper;
  const auto outside = [](int k) { return static_cast<Way>(outside_plane + 2 * k); };
  const auto across = [](int k) { return static_cast<Way>(crosses_plane + 2 * k); };
  EXPECT_EQ(paper.way({-1, 0, 0}, {-1, 0, 4}, {-2, 0, 0}), outside(0));
  EXPECT_EQ(paper.way({0, 1, 0}, {0, 1, 4}, {-4, 1, 0}), outside(0));  // a neighbor
  EXPECT_EQ(paper.way({0, 5, 9}, {0, -5, 7}, {-4, 1, 0}), outside(0));
  EXPECT_EQ(paper.way({-1, 0, 0}, {1, 0, 1}, {1, 0, 2}), across(0));
  EXPECT_EQ(paper.way({0, 0, 1}, {1, 0, 5}, {-0x1p-120f, 0, 1}), across(0));  // by exact signs
  EXPECT_EQ(paper.way({3, 0, 3}, {4, 0, 3}, {3, 0, 4}), outside(1));
  EXPECT_EQ(paper.way({0, 1, 4}, {4, 1, 0}, {4, 1, 4}), outside(1));
  EXPECT_EQ(paper.way({0, 1, 0}, {4, 1, 4}, {4, 1, 2}), across(1));
  EXPECT_EQ(paper.way({1, 0, -1}, {2, 0, -1}, {1, 0, -2}), outside(2));
  EXPECT_EQ(paper.way({4, 1, 0}, {0, 1, 0}, {0, 1, -4}), outside(2));
  EXPECT_EQ(paper.way({1, 0, -1}, {2, 0, -1}, {1, 0, 2}), across(2));
  EXPECT_EQ(paper.way({0, 0, 0}, {0, 0, 4}, {4, 0, 0}), behind_cap);
  EXPECT_EQ(paper.way({0, 2, 0}, {0, 2, 4}, {4, 1, 0}), before_cap);
  EXPECT_EQ(paper.way({1, 0, 1}, {1, 2, 2}, {2, 2, 1}), crosses_cap);
  EXPECT_EQ(paper.way({1, 1, 1}, {1, 0, 2}, {2, 1, 1}), behind_cap);
  EXPECT_EQ(paper.way({1, 1, 1}, {1, 1, 2}, {2, 1, 1}), no_way);  // a piece of the triangle itself
  EXPECT_EQ(paper.way({0, 1, 0}, {0, 1, 4}, {4, 1, 0}), no_way);
  Wedges wedges;
  Caster copy = paper.first;
  copy.mesh = some_mesh + 1;  // not so where it can be left out alone
  EXPECT_EQ(paper.way(copy, wedges), before_cap);
  EXPECT_EQ(wedges.hold(Four{}, 0, 1), 0u);

  // From (0, 9, 0), 8 above it, the triangle's planes x = 0 and z = 0 stay and the third is 2 x + 2 z + y = 9: its trace at the
  // height -7 is x + z = 8.
  const Paper lamp({0, 9, 0, 1});
  EXPECT_EQ(lamp.way({1, -7, 1}, {6, -7, 1}, {1, -7, 6}), behind_cap);
  EXPECT_EQ(lamp.way({1, -7, 1}, {7.5f, -7, 1}, {1, -7, 6}), across(1));
  EXPECT_EQ(lamp.way({7.5f, -7, 1}, {7.5f, -7, 2}, {8, -7, 1}), outside(1));
  // Beyond the lamp the planes go on, and its cone does not: at y = 10 it would be x < 0, z < 0, x + z > -1/2.
  EXPECT_EQ(lamp.way({-0.1f, 10, -0.1f}, {-0.2f, 10, -0.1f}, {-0.1f, 10, -0.2f}), outside(0));
}

// A caster at x = -1 .. 2 across the plane x = 0 shades -1 < x < 2 under the sun. Under a lamp at (0, 9, 0), reaching from
// (-1, 1, 1) to (2, 1, 1) and (2, 1, 2), its least distance from the lamp is at least the square root of d^2 = 66 - 10 / 3; the
// wedge is then -1 / d .. 2 / d, and a point at the distance 2 d may be at x = -2 .. 4.
TEST(ShadowVolumeTree, wedges_on_paper) {
  for (const glm::dvec4& light : {glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 9, 0, 1)}) {
    const Paper paper(light);
    Wedges wedges;
    const Caster across = caster(paper.frame, {-1, 1, 1}, {2, 1, 1}, {2, 1, 2});
    ASSERT_EQ(paper.way(across, wedges), crosses_plane);
    const double d = light.w == 0 ? 1 : std::sqrt(66 - 10 / 3.0);
    EXPECT_NEAR(wedges.low[0], -1 / d, 1e-4);
    EXPECT_NEAR(wedges.high[0], 2 / d, 1e-4);
    const float error = Planes::error(8);
    const auto holds = [&](float x, double farther) {
      return wedges.hold(Four{x, 0, 0, 0}, error, static_cast<float>(1 / (d * farther))) & 1u;
    };
    const float farther = light.w == 0 ? 1 : 2;
    EXPECT_TRUE(holds(-0.999f * farther, farther));
    EXPECT_FALSE(holds(-1.001f * farther, farther));
    EXPECT_TRUE(holds(1.999f * farther, farther));
    EXPECT_FALSE(holds(2.001f * farther, farther));
    EXPECT_EQ(wedges.hold(Four{}, error, 1) & ~1u, 0u);  // nothing crosses the others
  }
}

// Longest edges of 1.1 and 1.7 are in one class, 8.9 and 10 in another, 0.01 in a third; in a class they stay as they came.
TEST(ShadowVolumeTree, larger_casters_go_first) {
  std::vector<Caster> casters;
  for (const float size : {1.0f, 0.01f, 8.0f, 1.5f, 9.0f, 1.0f}) {
    const auto triangle = static_cast<std::uint32_t>(casters.size());
    casters.push_back({{{0, 0, 0}, {size, 0, 0}, {0, size / 2, 0}}, some_mesh, triangle});
  }
  put_large_first(casters);
  std::vector<std::uint32_t> order;
  for (const Caster& caster : casters) order.push_back(caster.triangle);
  EXPECT_EQ(order, (std::vector<std::uint32_t>{2, 4, 0, 3, 5, 1}));
  std::vector<Caster> same = casters;
  Random(3).shuffle(casters);
  Random(3).shuffle(same);
  std::vector<std::uint32_t> shuffled, sorted;
  for (const Caster& caster : casters) shuffled.push_back(caster.triangle);
  for (const Caster& caster : same) sorted.push_back(caster.triangle);
  EXPECT_EQ(shuffled, sorted);
  EXPECT_NE(shuffled, order);
  std::ranges::sort(sorted);
  EXPECT_EQ(sorted, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
}

// One caster: a point is outside the first plane after 1 node, the second after 2, the third after 3, and 4 settle the rest.
// Then with one more in the tree outside, across and behind.
TEST(ShadowVolumeTree, visits_on_paper) {
  const Paper paper;
  Tree tree;
  tree.reserve(4);
  tree.casters()[0] = paper.first;
  tree.grow(1, paper.frame, true, true);
  const Scene scene{.meshes = {{.positions = {{0, 1, 0}, {0, 1, 4}, {4, 1, 0}}, .triangles = {{0, 1, 2}}}}};
  const auto visits = [&](const glm::vec3& point, std::uint32_t expected) {
    QueryWork work = tree.make_work();
    EXPECT_EQ(tree.shading_triangle(scene, {{.point = point}}, work), expected);
    return work.visits;
  };
  EXPECT_EQ(visits({-1, 0, 1}, none), 1u);
  EXPECT_EQ(visits({3, 0, 3}, none), 2u);
  EXPECT_EQ(visits({1, 0, -1}, none), 3u);
  EXPECT_EQ(visits({1, 0, 1}, 0), 4u);
  EXPECT_EQ(visits({1, 2, 1}, none), 4u);
  EXPECT_EQ(visits({1, 1, 1}, none), 4u);  // on it
  EXPECT_EQ(visits({0, 0, 1}, 0), 4u);     // through its edge

  // Behind the first: a query goes there only if the first is its own.
  tree.casters()[0] = paper.first;
  tree.casters()[1] = caster(paper.frame, {1, 0, 1}, {1, 0, 2}, {2, 0, 1}, 1);
  tree.casters()[2] = caster(paper.frame, {-1, 0, 1}, {-1, 0, 2}, {1, 0, 1}, 2);   // across x = 0
  tree.casters()[3] = caster(paper.frame, {-3, 0, 1}, {-3, 0, 2}, {-2, 0, 1}, 3);  // outside x = 0
  tree.grow(4, paper.frame, true, true);
  EXPECT_EQ(tree.triangles(), 4u);
  EXPECT_EQ(tree.depth(), 2u);
  EXPECT_EQ(visits({1.2f, -1, 1.2f}, 0), 4u);
  QueryWork work = tree.make_work();
  EXPECT_EQ(tree.shading_triangle(scene, TriangleNumbers(scene).numbered({{1.2f, -1, 1.2f}, 0, 0}), work), 1u);
  EXPECT_EQ(visits({-0.5f, -1, 1.1f}, 2), 1u + 2u + 4u);  // inside x = -3, and outside the second plane of caster 3
  EXPECT_EQ(visits({-2.9f, -1, 1.05f}, 3), 1u + 4u);      // beyond the wedge of caster 2
  EXPECT_EQ(visits({-2.9f, 0.5f, 1.05f}, none), 1u);      // and before all there
  EXPECT_EQ(visits({3, -1, 3}, none), 2u);                // nothing there
}

}  // namespace gnomon::shadow_volume_tree_paper_test
