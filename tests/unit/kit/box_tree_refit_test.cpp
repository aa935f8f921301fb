// A tree of boxes whose items move: it finds what a new one finds, and is built anew in time.
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/refit.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "generated_scene.h"
#include "measure/scene/posed_scene.h"

namespace box_tree_refit_test {

using namespace gnomon;

std::vector<Bounds> random_boxes(Random& random, std::size_t count, double size) {
  std::vector<Bounds> boxes(count);
  for (Bounds& box : boxes) {
    const glm::dvec3 corner = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    box.add(glm::vec3(corner));
    box.add(glm::vec3(corner + random.uniform(glm::dvec3(0), glm::dvec3(size))));
  }
  return boxes;
}

/// Gives every item of a tree its new box.
void refit(BoxTree& tree, const std::vector<Bounds>& boxes) {
  tree.refit([&](std::uint32_t place) { return boxes[tree.order()[place]]; });
}

/// A segment and the boxes that the tree gives for it, in order.
std::vector<std::uint32_t> items_on(const BoxTree& tree, const Segment& segment) {
  std::vector<std::uint32_t> items;
  tree.any(SegmentSlabs(segment), 0.0, [&](std::uint32_t place) {
    items.push_back(tree.order()[place]);
    return false;
  });
  std::ranges::sort(items);
  return items;
}

Segment random_segment(Random& random) {
  return {glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2))),
          glm::dvec4(random.uniform(glm::dvec3(-2), glm::dvec3(2)), random.below(2))};
}

void expect_all_found(const BoxTree& tree, const std::vector<Bounds>& boxes, Random& random) {
  for (int round = 0; round < 300; ++round) {
    const Segment segment = random_segment(random);
    const std::vector<std::uint32_t> items = items_on(tree, segment);
    const SegmentSlabs slabs(segment);
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const glm::vec3 &low = boxes[i].min, &high = boxes[i].max;
      const float side[2][3] = {{low.x, low.y, low.z}, {high.x, high.y, high.z}};
      if (slabs.meets(side, 0)) {
        EXPECT_TRUE(std::ranges::binary_search(items, i)) << i;
      }
    }
  }
}

TEST(refit, finds_every_item_wherever_it_went) {
  for (const std::size_t count : {1, 4, 5, 300}) {
    Random random(count);
    BoxTree tree(random_boxes(random, count, 0.2));
    for (const double size : {0.2, 0.0, 1000.0, 0.01}) {
      const std::vector<Bounds> moved = random_boxes(random, count, size);
      refit(tree, moved);
      expect_all_found(tree, moved, random);
    }
  }
  BoxTree none(std::span<const Bounds>{});
  refit(none, {});
  EXPECT_EQ(none.cost(), 0);
}

TEST(refit, of_items_that_stay_changes_no_answer_and_no_cost) {
  Random random(2);
  const std::vector<Bounds> boxes = random_boxes(random, 500, 0.1), others = random_boxes(random, 500, 0.3);
  const BoxTree built(boxes);
  BoxTree tree = built;
  refit(tree, others);
  EXPECT_GT(tree.cost(), rebuild_cost * built.cost()) << "other boxes have other neighbors";
  refit(tree, boxes);
  EXPECT_EQ(tree.cost(), built.cost());
  EXPECT_EQ(tree.bytes(), built.bytes());
  for (int round = 0; round < 300; ++round) {
    const Segment segment = random_segment(random);
    EXPECT_EQ(items_on(tree, segment), items_on(built, segment));
  }
}

// One leaf of two unit cubes side by side: a ray that meets the box of both takes that box and two items. Half of its area is
// 2 + 2 + 1 = 5 square meters, whatever is in it.
TEST(cost, is_in_boxes_and_items) {
  std::vector<Bounds> boxes(2);
  boxes[0].add({{0, 0, 0}, {1, 1, 1}});
  boxes[1].add({{1, 0, 0}, {2, 1, 1}});
  BoxTree tree(boxes);
  EXPECT_EQ(half_area(tree.bounds()), 5);
  EXPECT_EQ(tree.weighted_area(), 15);
  EXPECT_EQ(tree.cost(), 3);
  // All at one place there is no area and no cost, and as soon as there is one again the tree counts as decayed.
  const double before = tree.cost();
  refit(tree, {{glm::vec3(7), glm::vec3(7)}, {glm::vec3(7), glm::vec3(7)}});
  EXPECT_EQ(tree.cost(), 0);
  EXPECT_FALSE(is_decayed(tree.cost(), before));
  refit(tree, boxes);
  EXPECT_TRUE(is_decayed(tree.cost(), 0));
  EXPECT_FALSE(is_decayed(tree.cost(), before));
  EXPECT_FALSE(is_decayed(1.4 * 3, 3));
  EXPECT_TRUE(is_decayed(1.4001 * 3, 3));
}

/// A swarm over 300 frames: the boxes of its triangles in each, and segments through it.
struct Flight {
  std::vector<std::vector<Bounds>> frames;
  std::vector<SegmentSlabs> segments;

  explicit Flight(const char* settings) {
    Scene scene = generated::make("swarm", settings);
    PosedScene posed(scene);
    const Mesh& swarm = scene.meshes[1];
    for (int frame = 0; frame < 300; ++frame) {
      posed.go_to(RowPose{.animation = "fly", .seconds = frame / 60.0, .start = 0, .frame_rate = 60, .frames = 300});
      std::vector<Bounds>& boxes = frames.emplace_back(swarm.triangles.size());
      for (std::size_t t = 0; t < boxes.size(); ++t) boxes[t].add(swarm.corners(t).points);
    }
    Random random(3);
    for (int k = 0; k < 60; ++k) {
      const glm::dvec3 from = random.uniform(glm::dvec3(-1.3, 0.8, -1.3), glm::dvec3(1.3, 0.8, 1.3));
      const glm::dvec3 to = random.uniform(glm::dvec3(-1.3, 4.8, -1.3), glm::dvec3(1.3, 4.8, 1.3));
      segments.emplace_back(Segment{glm::vec3(from), glm::dvec4(to, 1)});
    }
  }

  /// Boxes and items that the segments take.
  double asked(const BoxTree& tree) const {
    std::size_t count = 0;
    for (const SegmentSlabs& segment : segments)
      tree.each(
          [&](const float* low, const float* high) {
            ++count;
            const float side[2][3] = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
            return segment.meets(side, 0);
          },
          [&](std::uint32_t) {
            ++count;
            return false;
          });
    return static_cast<double>(count);
  }

  struct Work {
    double asked = 0;
    int builds = 0;
    /// Counted together: a build looks at each of n items at about log2(n) levels, each as dear as so many boxes of a query.
    double sum(double of_item, double item_count) const {
      return asked + of_item * builds * item_count * std::log2(item_count);
    }
  };
  /// Of all frames, where the tree is built anew in every `period`-th, or, with 0, by the rule.
  Work work(int period) const {
    Work work;
    BoxTree tree;
    double built_cost = 0;
    for (std::size_t frame = 0; frame < frames.size(); ++frame) {
      bool is_due = frame == 0 || (period > 0 && frame % static_cast<std::size_t>(period) == 0);
      if (!is_due) {
        refit(tree, frames[frame]);
        is_due = period == 0 && is_decayed(tree.cost(), built_cost);
      }
      if (is_due) {
        tree = BoxTree(frames[frame]);
        built_cost = tree.cost();
        ++work.builds;
      }
      work.asked += asked(tree);
    }
    return work;
  }
};

TEST(rebuild_rule, counts_at_most_1_3_times_the_best_fixed_period_whatever_a_build_is_worth) {
  for (const char* settings : {"count=512,reach=0.8", "count=512,reach=0.2"}) {
    const Flight flight(settings);
    const auto item_count = static_cast<double>(flight.frames[0].size());
    std::vector<Flight::Work> fixed;
    for (int period = 1; period < 300; period *= 2) fixed.push_back(flight.work(period));
    fixed.push_back(flight.work(300));
    const Flight::Work by_rule = flight.work(0);
    for (const double of_item : {0.0, 0.3, 1.0, 3.0, 10.0}) {
      double best = INFINITY;
      for (const Flight::Work& work : fixed) best = std::min(best, work.sum(of_item, item_count));
      EXPECT_LE(by_rule.sum(of_item, item_count), 1.3 * best) << settings << ", an item for " << of_item;
    }
    // It does follow: not built in every frame, and where triangles go far not once alone.
    EXPECT_LT(by_rule.builds, 60) << settings;
  }
  EXPECT_GT(Flight("count=512,reach=0.8").work(0).builds, 5);
}

}  // namespace box_tree_refit_test
