// The parts of rays in OpenGL: the tree of boxes, and the casters in its order.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <numeric>

#include "masked.h"
#include "small_world.h"
#include "techniques/gl_rays/casters.h"
#include "walking_world.h"

namespace gl_rays_tree_test {
using namespace gnomon;
using namespace gnomon::gl_rays;

// --- The tree --------------------------------------------------------------------------------------------------------------

Bounds box_of(const glm::vec3& low, const glm::vec3& high) { return {low, high}; }

std::vector<Bounds> random_boxes(std::size_t count, double size, std::uint64_t seed) {
  Random random(seed);
  std::vector<Bounds> boxes(count);
  for (Bounds& box : boxes) {
    const glm::dvec3 corner = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    box = box_of(glm::vec3(corner), glm::vec3(corner + random.uniform(glm::dvec3(0), glm::dvec3(size))));
  }
  return boxes;
}

void expect_same(const Bounds& box, const Bounds& expected, std::size_t node) {
  EXPECT_EQ(box.min, expected.min) << node;
  EXPECT_EQ(box.max, expected.max) << node;
}

/// Visits the subtree at a node as its links say, and checks them. Returns what its leaves hold, which must be exactly in its
/// box, and appends their places.
Bounds expect_subtree(std::span<const Node> nodes, std::size_t index, const std::vector<Bounds>& at,
                      std::vector<std::uint32_t>& places) {
  const Node& node = nodes[index];
  const auto end = static_cast<std::size_t>(node.skip);
  EXPECT_GT(end, index);
  EXPECT_LE(end, nodes.size());
  Bounds held;
  if (node.is_leaf()) {
    EXPECT_EQ(end, index + 1);
    EXPECT_GE(node.count(), 1u);
    EXPECT_LE(node.count(), leaf_size);
    for (std::uint32_t k = 0; k < node.count(); ++k) {
      places.push_back(node.first() + k);
      held.add(at[node.first() + k]);
    }
  } else {
    held = expect_subtree(nodes, index + 1, at, places);
    const auto second = static_cast<std::size_t>(nodes[index + 1].skip);
    EXPECT_LT(second, end) << "an inner node has two children";
    held.add(expect_subtree(nodes, second, at, places));
    EXPECT_EQ(static_cast<std::size_t>(nodes[second].skip), end) << "what follows the second child follows its parent";
  }
  expect_same(node.box(), held, index);
  return held;
}

/// `at[place]` is the box of the item there.
void expect_tree(std::span<const Node> nodes, const std::vector<Bounds>& at) {
  std::vector<std::uint32_t> places, all(at.size());
  std::iota(all.begin(), all.end(), 0u);
  if (!nodes.empty()) {
    EXPECT_EQ(static_cast<std::size_t>(nodes[0].skip), nodes.size());
    expect_subtree(nodes, 0, at, places);
  }
  EXPECT_EQ(places, all) << "leaves hold all places, each once, in order";
  EXPECT_LE(nodes.size(), 2 * at.size());
}

std::vector<Bounds> in_order(const BoxNodes& tree, const std::vector<Bounds>& boxes) {
  std::vector<Bounds> at;
  for (const std::uint32_t item : tree.order) at.push_back(boxes[item]);
  return at;
}

void expect_built(const std::vector<Bounds>& boxes) {
  const BoxNodes tree = build_nodes(boxes);
  std::vector<std::uint32_t> items = tree.order, all(boxes.size());
  std::ranges::sort(items);
  std::iota(all.begin(), all.end(), 0u);
  EXPECT_EQ(items, all) << "each item has one place";
  expect_tree(tree.nodes, in_order(tree, boxes));
}

// More than 4096 items are built by several threads.
TEST(gl_rays_tree, holds_each_item_in_one_leaf_and_in_all_boxes_above) {
  for (const std::size_t count : {0, 1, 2, 4, 5, 17, 1000, 4096, 4097, 30000}) {
    SCOPED_TRACE(count);
    expect_built(random_boxes(count, 0.05, count));
  }
}

// Where centers tell nothing apart nodes are halved: 13 bits of 5,000 make no level more than 48.
TEST(gl_rays_tree, of_one_center_is_halved) {
  std::vector<Bounds> boxes;
  for (int k = 1; k <= 5000; ++k) boxes.push_back(box_of(glm::vec3(static_cast<float>(-k)), glm::vec3(static_cast<float>(k))));
  expect_built(boxes);
  expect_built(std::vector<Bounds>(100, box_of({1, 2, 3}, {1, 2, 3})));
}

// Sizes and gaps that each are half of the one before: no split halves them, and no recursion becomes deep.
TEST(gl_rays_tree, of_boxes_that_get_smaller_and_smaller_ends) {
  std::vector<Bounds> boxes;
  for (int k = 0; k < 20000; ++k) {
    const auto size = static_cast<float>(std::exp2(-k % 120)), at = 2 * size;
    boxes.push_back(box_of({at, 0, 0}, {at + size, size, size}));
  }
  expect_built(boxes);
}

// Cubes of side 1 at x = 0, 2 and 10: half areas are 3 each, 3 + 2 + 3 ... of the boxes around two, 1 x 1 x 3, 7, and around
// all, 1 x 1 x 11, 23. A leaf of all counts 23 * 3 = 69 beside the root's box; the split before the last one 7 * 3 + 3 * 2
// = 27. A leaf of the first two counts 7 * 2 = 14 beside its box, their split 3 * 2 + 3 * 2 = 12. So every cube has a leaf, and
// the whole tree counts 23 + 7 + 3 * 2 * 3 = 48 of 23.
TEST(gl_rays_tree, splits_where_the_heuristic_says) {
  const auto cube = [](float x) { return box_of({x, 0, 0}, {x + 1, 1, 1}); };
  const std::vector<Bounds> boxes{cube(2), cube(10), cube(0)};
  const BoxNodes tree = build_nodes(boxes);
  ASSERT_EQ(tree.nodes.size(), 5u);
  EXPECT_EQ(tree.order, (std::vector<std::uint32_t>{2, 0, 1}));
  EXPECT_FALSE(tree.nodes[0].is_leaf());
  EXPECT_EQ(tree.nodes[1].high, glm::vec3(3, 1, 1));
  EXPECT_EQ(tree.nodes[1].skip, 4);
  EXPECT_EQ(tree.nodes[4].low, glm::vec3(10, 0, 0));
  EXPECT_DOUBLE_EQ(cost(tree.nodes), 48.0 / 23);
}

// Two cubes in one place: their split counts 3 * 2 + 3 * 2, the leaf 3 * 2 beside its box.
TEST(gl_rays_tree, keeps_in_a_leaf_what_a_split_would_not_part) {
  const std::vector<Bounds> boxes(4, box_of({0, 0, 0}, {1, 1, 1}));
  const BoxNodes tree = build_nodes(boxes);
  ASSERT_EQ(tree.nodes.size(), 1u);
  EXPECT_EQ(tree.nodes[0].count(), 4u);
  EXPECT_DOUBLE_EQ(cost(tree.nodes), 5.0);
}

TEST(gl_rays_tree, refitted_has_the_boxes_of_what_it_holds) {
  BoxNodes tree = build_nodes(random_boxes(10000, 0.05, 3));
  const double before = cost(tree.nodes);
  const std::vector<Bounds> moved = in_order(tree, random_boxes(10000, 0.05, 4));
  refit(std::span(tree.nodes), [&](std::size_t place) { return moved[place]; });
  expect_tree(tree.nodes, moved);
  EXPECT_TRUE(is_decayed(cost(tree.nodes), before)) << "what is near in the tree is now anywhere";
}

// --- Casters ---------------------------------------------------------------------------------------------------------------

/// Triangles at their places are those of the scene, scaled, and a tree is over them.
void expect_casters(const Casters& casters, const Scene& scene, float scale) {
  EXPECT_EQ(casters.scale(), scale);
  const TriangleNumbers numbers(scene);
  std::vector<Bounds> at(casters.triangle_count());
  std::vector<std::uint32_t> found;
  for (std::size_t place = 0; place < at.size(); ++place) {
    const Corner* const corners = &casters.corners()[3 * place];
    const auto number = static_cast<std::uint32_t>(corners[0].tag), mesh = numbers.mesh_of(number);
    const Triangle triangle = scene.meshes[mesh].corners(number - numbers.first_of(mesh));
    EXPECT_TRUE(scene.meshes[mesh].casts);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(corners[k].at, scale * triangle.points[k]) << number;
      at[place].add(corners[k].at);
    }
    // 2^-23 of the largest coordinate more on all sides, rounded.
    const Bounds grown = casters.box_at(place);
    const double growth = 0x1p-23 * scale * scene.bounds().extent();
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(grown.min[k], at[place].min[k]);
      EXPECT_GT(grown.max[k], at[place].max[k]);
      EXPECT_NEAR(grown.min[k], at[place].min[k], 2 * growth);
      EXPECT_NEAR(grown.max[k], at[place].max[k], 2 * growth);
    }
    at[place] = grown;
    found.push_back(number);
  }
  std::ranges::sort(found);
  EXPECT_EQ(std::ranges::adjacent_find(found), found.end());
  EXPECT_EQ(found.size(), caster_count(scene));
  expect_tree(casters.nodes(), at);
}

TEST(gl_rays_casters, are_the_triangles_that_cast_with_their_numbers) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), small_world::box({0, 1, 0}, {1, 2, 1}), small_world::ground(2, 3),
                  small_world::ground(1, 4)};
  const auto holes = masked::checker(4, 4), others = masked::checker(2, 2);
  scene.meshes[1].alpha_mask = others;
  scene.meshes[2].alpha_mask = holes;
  scene.meshes[3].alpha_mask = others;
  scene.meshes[2].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
  const Casters casters(scene);
  expect_casters(casters, scene, 1);
  EXPECT_EQ(casters.triangle_count(), 16u);
  for (std::size_t i = 0; i < casters.corners().size(); i += 3) {
    const int number = casters.corners()[i].tag, mask = casters.corners()[i + 1].tag, glass = casters.corners()[i + 2].tag;
    EXPECT_EQ(mask, number >= 14 && number < 16 ? 1 : 0) << number;
    EXPECT_EQ(glass, number >= 14 && number < 16 ? 0 : -1) << number;
  }
  scene.meshes.resize(1);
  expect_casters(Casters(scene), scene, 1);
}

// 2^-40 m times 2^40 is 1; 3 * 2^40 m over 2^41 is 1.5.
TEST(gl_rays_casters, of_tiny_and_huge_scenes_are_scaled_by_a_power_of_two) {
  for (const auto& [size, scale] : {std::pair(0x1p-40f, 0x1p40f), std::pair(3 * 0x1p40f, 0x1p-41f), std::pair(0x1p-9f, 1.0f)}) {
    Scene scene;
    scene.meshes = {small_world::ground(size)};
    expect_casters(Casters(scene), scene, scale);
  }
}

TEST(gl_rays_casters, follow_what_moves) {
  walking_world::Row row("walk");
  Casters casters(row.scene);
  for (const int frame : {1, 8, 4, 0}) {
    row.go_to(frame);
    EXPECT_TRUE(casters.update(row.scene, row.posed.take_changes())) << frame;
    expect_casters(casters, row.scene, 1);
  }
  EXPECT_FALSE(casters.update(row.scene, row.posed.take_changes())) << "nothing moved";
}

// OpenGL promises 65536 texels of a buffer: four for each triangle. Places of leaves have 27 bits.
TEST(gl_rays_casters, that_fit_into_no_buffer_are_refused_with_the_number) {
  EXPECT_TRUE(tree_support(16384, 65536));
  EXPECT_EQ(tree_support(16385, 65536).why(),
            "16385 triangles cast; the OpenGL device can read a tree over 16384 from a buffer");
  EXPECT_TRUE(tree_support(std::size_t{1} << 27, std::nullopt));
  EXPECT_EQ(tree_support((std::size_t{1} << 27) + 1, std::size_t{1} << 40).why(),
            "134217729 triangles cast; the OpenGL device can read a tree over 134217728 from a buffer");
}

}  // namespace gl_rays_tree_test
