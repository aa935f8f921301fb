// Curves of the transmittance map: exact, within a tolerance, of so many nodes, whatever the order in which surfaces arrive.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <array>

#include "techniques/transmittance_map/curve.h"

namespace transmittance_curve_test {
using namespace gnomon;
using namespace gnomon::transmittance_map;
using Kind = Keep::Kind;

/// Three surfaces that let 1/2, 3/4 and 1/5 through.
const std::vector<Surface> paper_stack = {{0.2f, 0.5f}, {0.5f, 0.75f}, {0.7f, 0.2f}};

std::vector<Node> curve(std::vector<Surface> surfaces, const Keep& keep) {
  CurveMaker maker(keep);
  const std::span<const Node> nodes = maker.make(surfaces);
  return {nodes.begin(), nodes.end()};
}
/// The definition: the product of all that is nearer.
double product(std::span<const Surface> surfaces, double depth) {
  double share = 1;
  for (const Surface& surface : surfaces)
    if (surface.depth < depth) share *= surface.transmission;
  return share;
}
/// Right before and behind each surface and halfway to the next, where T and lines are farthest apart.
std::vector<double> places(std::span<const Surface> surfaces) {
  std::vector<double> depths = {0, 1};
  for (const Surface& a : surfaces) depths.push_back(a.depth);
  std::ranges::sort(depths);
  for (std::size_t i = 0, count = depths.size(); i + 1 < count; ++i) {
    const double gap = depths[i + 1] - depths[i];
    for (const double share : {1e-9, 0.5, 1 - 1e-9}) depths.push_back(depths[i] + share * gap);
  }
  return depths;
}
/// 1 to 64 surfaces; some have equal depths, some let all or nothing through.
std::vector<Surface> random_stack(Random& random) {
  std::vector<Surface> surfaces(1 + random.below(64));
  // Thin smoke takes next to nothing away, glass half, foil nearly all.
  const double least = std::array{0.95, 0.5, 0.01}[random.below(3)];
  for (Surface& surface : surfaces) {
    surface.depth = static_cast<float>(random.uniform(0.01, 0.99));
    if (random.below(8) == 0) surface.depth = std::round(8 * surface.depth) / 8;
    surface.transmission = static_cast<float>(random.uniform(least, 1));
    if (random.below(50) == 0) surface.transmission = static_cast<float>(random.below(2));
  }
  return surfaces;
}

const Keep all{}, close{Kind::error, 0.01}, loose{Kind::error, 0.2}, four{Kind::nodes, 0, 4};

// 1, 1/2, 1/2 * 3/4, 1/2 * 3/4 * 1/5.
TEST(transmittance_curve, of_the_stack_on_paper_is_exact) {
  const std::vector<Node> nodes = curve(paper_stack, all);
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(share_at(nodes, all, 0.1), 1);
  EXPECT_EQ(share_at(nodes, all, 0.35), 0.5);
  EXPECT_EQ(share_at(nodes, all, 0.6), 0.375);
  EXPECT_FLOAT_EQ(static_cast<float>(share_at(nodes, all, 0.9)), 0.075f);
  // A receiver at the depth of a surface is not behind it.
  EXPECT_EQ(share_at(nodes, all, 0.5f), 0.5);
}

// Areas: the first (.5 - .2)(1 - .5) = .15, the second (.7 - .5)(.5 - .375) = .025: it goes, and its step is made at .7. Of the
// two that are left the first goes: behind .7 there is .075 still.
TEST(transmittance_curve, drops_the_node_of_the_least_area) {
  const Keep two{Kind::nodes, 0, 2}, one{Kind::nodes, 0, 1};
  const std::vector<Node> nodes = curve(paper_stack, two);
  ASSERT_EQ(nodes.size(), 2u);
  EXPECT_EQ(share_at(nodes, two, 0.1), 1);
  EXPECT_EQ(share_at(nodes, two, 0.35), 0.5);
  EXPECT_EQ(share_at(nodes, two, 0.6), 0.5);
  EXPECT_FLOAT_EQ(static_cast<float>(share_at(nodes, two, 0.9)), 0.075f);
  const std::vector<Node> last = curve(paper_stack, one);
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(share_at(last, one, 0.6), 1);
  EXPECT_FLOAT_EQ(static_cast<float>(share_at(last, one, 0.9)), 0.075f);
}

// Smoke of 64 layers, each of which lets 0.99 through: T falls from 1 to .99^64 = .5256 nearly on a line, bent by less than
// (ln .5256)^2 / 8 = .05.
TEST(transmittance_curve, one_line_stands_for_many_thin_layers) {
  std::vector<Surface> smoke;
  for (int i = 0; i < 64; ++i) smoke.push_back({(static_cast<float>(i) + 0.5f) / 64, 0.99f});
  EXPECT_EQ(curve(smoke, all).size(), 64u);
  EXPECT_LE(curve(smoke, {Kind::error, 0.06}).size(), 3u);
  EXPECT_LE(curve(smoke, {Kind::error, 0.02}).size(), 6u);
}

TEST(transmittance_curve, has_no_nodes_where_nothing_takes_light_away) {
  for (const Keep& keep : {all, close, four}) {
    EXPECT_TRUE(curve({}, keep).empty());
    EXPECT_TRUE(curve({{0.5f, 1.0f}, {0.7f, 1.0f}}, keep).empty());
    EXPECT_EQ(share_at({}, keep, 0.9), 1);
  }
}

// Steps of exactly twice the tolerance are the highest that a line may cross: 1/4 at 1/8.
TEST(transmittance_curve, crosses_steps_of_twice_the_tolerance) {
  const Keep eighth{Kind::error, 0.125};
  const std::vector<Surface> surfaces = {{0.25f, 0.75f}, {0.5f, 2.0f / 3}, {0.75f, 0.5f}};
  const std::vector<Node> nodes = curve(surfaces, eighth);
  for (const double depth : places(surfaces)) {
    const double share = share_at(nodes, eighth, depth);
    ASSERT_TRUE(std::isfinite(share)) << depth;
    EXPECT_LE(std::abs(share - product(surfaces, depth)), 0.125 + 1e-7) << depth;
  }
}

class RandomCurves : public testing::Test {
 protected:
  /// Calls check(surfaces, case).
  template <class Check>
  static void for_stacks(const Check& check) {
    Random random(7);
    for (int i = 0; i < 4000; ++i) {
      const std::vector<Surface> surfaces = random_stack(random);
      check(surfaces, i);
      if (HasFatalFailure()) return;
    }
  }
};

TEST_F(RandomCurves, of_all_surfaces_are_exact) {
  for_stacks([](const std::vector<Surface>& surfaces, int i) {
    const std::vector<Node> nodes = curve(surfaces, all);
    // Rounded once to float32.
    for (const double depth : places(surfaces))
      ASSERT_NEAR(share_at(nodes, all, depth), product(surfaces, depth), 3e-8) << i << ' ' << depth;
  });
}

TEST_F(RandomCurves, are_nowhere_off_by_more_than_the_tolerance) {
  std::size_t fewer = 0;
  for_stacks([&](const std::vector<Surface>& surfaces, int i) {
    for (const Keep& keep : {close, loose, Keep{Kind::error, 0.001}}) {
      const std::vector<Node> nodes = curve(surfaces, keep);
      for (const double depth : places(surfaces))
        ASSERT_LE(std::abs(share_at(nodes, keep, depth) - product(surfaces, depth)), keep.tolerance + 1e-7)
            << i << ' ' << depth << ' ' << keep.tolerance;
      for (std::size_t k = 1; k < nodes.size(); ++k) ASSERT_LE(nodes[k - 1].depth, nodes[k].depth) << i;
      fewer += nodes.size() < curve(surfaces, all).size();
    }
  });
  EXPECT_GT(fewer, 4000u) << "of 12,000 curves";
}

// The rule, word by word: of all nodes but the last the one with the least (d_{i+1} - d_i) (T_{i-1} - T_i) goes, again and
// again.
TEST_F(RandomCurves, of_few_nodes_are_those_of_the_rule) {
  for_stacks([](const std::vector<Surface>& surfaces, int i) {
    std::vector<Node> left = curve(surfaces, all);
    for (std::uint32_t most = 64; most >= 1; --most) {
      while (left.size() > most) {
        const auto area = [&](std::size_t k) {
          return (double(left[k + 1].depth) - left[k].depth) * ((k ? left[k - 1].share : 1.0) - left[k].share);
        };
        std::size_t least = 0;
        for (std::size_t k = 1; k + 1 < left.size(); ++k)
          if (area(k) < area(least)) least = k;
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(least));
      }
      if (most % 7 != 1) continue;
      ASSERT_EQ(curve(surfaces, {Kind::nodes, 0, most}), left) << i << ' ' << most;
    }
  });
}

TEST_F(RandomCurves, of_few_nodes_never_darken_and_end_with_the_same_share) {
  for_stacks([](const std::vector<Surface>& surfaces, int i) {
    const std::vector<Node> exact = curve(surfaces, all);
    for (const std::uint32_t most : {1u, 4u, 8u, 16u}) {
      const Keep keep{Kind::nodes, 0, most};
      const std::vector<Node> nodes = curve(surfaces, keep);
      ASSERT_EQ(nodes.size(), std::min<std::size_t>(most, exact.size())) << i;
      ASSERT_TRUE(exact.empty() || nodes.back() == exact.back()) << i;
      for (const double depth : places(surfaces))
        ASSERT_GE(share_at(nodes, keep, depth), share_at(exact, all, depth)) << i << ' ' << depth;
    }
    for (const Keep& keep : {close, loose}) {
      const std::vector<Node> nodes = curve(surfaces, keep);
      ASSERT_TRUE(exact.empty() || nodes.back() == exact.back()) << i;
    }
  });
}

TEST_F(RandomCurves, do_not_depend_on_the_order_of_arrival) {
  Random random(8);
  for_stacks([&](std::vector<Surface> surfaces, int i) {
    std::vector<Surface> other = surfaces;
    random.shuffle(other);
    for (const Keep& keep : {all, close, loose, four}) ASSERT_EQ(curve(surfaces, keep), curve(other, keep)) << i;
  });
}

// Why lists are sorted first: had the first two of the stack to share one node before the third arrives, that would be the one
// at .5. Of all three those at .2 and .7 stay.
TEST(transmittance_curve, of_a_part_that_was_reduced_is_another) {
  const Keep one{Kind::nodes, 0, 1};
  std::vector<Surface> first = {paper_stack[0], paper_stack[1]};
  const std::vector<Node> reduced = curve(first, one);
  std::vector<Surface> then = {{reduced[0].depth, reduced[0].share}, paper_stack[2]};
  EXPECT_NE(curve(then, {Kind::nodes, 0, 2}), curve(paper_stack, {Kind::nodes, 0, 2}));
}

}  // namespace transmittance_curve_test
