// The SVBSP tree on paper: light space, shadow planes and cells.
#include <gnomon/kit/geometry/exact.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"
#include "techniques/svbsp/detail.h"

namespace gnomon::svbsp_tree_test {

using namespace svbsp;

// A lamp at (1, 2, 3) sees (1, 6, 3) straight along +y at the distance 4, (2, 6, 1) where y's face has z / y = -2 / 4 and x
// / y = 1 / 4; and (-4, 2, 3) straight along -x.
TEST(Svbsp, a_lamp_sees_in_perspective) {
  const ProjectedSpace space({1, 2, 3, 1}, {});
  EXPECT_EQ(space.face_count(), 6);
  ASSERT_EQ(space.face_of({1, 6, 3}), 2);
  EXPECT_EQ(space.of_world(2, {1, 6, 3}), glm::dvec3(0, 0, 0.25));
  EXPECT_EQ(space.of_world(2, {2, 6, 1}), glm::dvec3(-0.5, 0.25, 0.25));
  ASSERT_EQ(space.face_of({-4, 2, 3}), 1);
  EXPECT_EQ(space.of_world(1, {-4, 2, 3}), glm::dvec3(0, 0, 0.2));
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 p = random.uniform(glm::dvec3(-5), glm::dvec3(5));
    const int face = space.face_of(p);
    const glm::dvec3 seen = space.of_world(face, p);
    EXPECT_LE(std::max(std::abs(seen.x), std::abs(seen.y)), 1);
    EXPECT_GT(seen.z, 0);
    EXPECT_LT(glm::distance(space.to_world(face, seen), p), 1e-14);
  }
}

// Straight lines stay straight, nearer is greater, and a plane's value over `meter` is the distance: on either kind of
// light.
TEST(Svbsp, planes_are_planes_in_light_space) {
  Random random(2);
  for (int i = 0; i < 300; ++i) {
    const Light light = hard_scenes::hard_light(random);
    const glm::dvec4 at = homogeneous(light);
    const ProjectedSpace space(at, {{-2, -2, -2}, {2, 2, 2}});
    glm::vec3 corners[3];
    for (glm::vec3& p : corners) p = glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2)));
    const int facing = orient3d_sign(corners[0], corners[1], corners[2], at);
    if (facing == 0) continue;
    const glm::dvec3 p = random.uniform(glm::dvec3(-3), glm::dvec3(3)), a(corners[0]);
    const int face = space.face_of(p);
    glm::dvec3 normal = glm::normalize(glm::cross(glm::dvec3(corners[1]) - a, glm::dvec3(corners[2]) - a));
    if (glm::dot(normal, to_light(at, a)) < 0) normal = -normal;
    const glm::dvec3 seen = space.of_world(face, p);
    EXPECT_NEAR(space.plane(face, corners, facing).at(seen) / space.meter(seen), glm::dot(normal, p - a), 1e-12);
    // Half way to a lamp, or one meter toward a sun.
    const glm::dvec3 nearer = at.w != 0 ? p + 0.5 * to_light(at, p) : p + glm::normalize(glm::dvec3(at));
    const glm::dvec3 higher = space.of_world(face, nearer);
    EXPECT_NEAR(higher.x, seen.x, 1e-12 * (1 + std::abs(seen.x)));
    EXPECT_NEAR(higher.y, seen.y, 1e-12 * (1 + std::abs(seen.y)));
    EXPECT_NEAR(higher.z, at.w != 0 ? 2 * seen.z : seen.z + 1, 1e-12 * higher.z * higher.z + 1e-12);
  }
}

/// Pieces at a height over x and y, in a tree of their own.
struct Paper {
  ProjectedSpace space{{0, 0, 1, 0}, {}};
  Rules rules{.epsilon = {1e-10, 1e-10}};
  std::vector<Node> nodes;
  TreeWork work;
  std::vector<double> heights;
  Link root = out_cell;
  struct Plane {
    const std::vector<double>* heights;
    ClipPlane operator()(std::uint32_t piece) const { return {{0, 0, 1}, -(*heights)[piece]}; }
  };
  Builder<Plane> builder{space, rules, {&heights}, nodes, work};

  void add(double height, std::vector<Corner> corners) {
    for (Corner& corner : corners) corner.at.z = height;
    heights.push_back(height);
    builder.add(corners, static_cast<std::uint32_t>(heights.size() - 1), root);
  }
  Link at(double x, double y) const {
    std::uint64_t visits = 0;
    Query query{.x = x, .y = y, .nodes = nodes.data(), .link = root};
    locate<1>({&query, 1}, visits);
    return query.link;
  }
};

const std::vector<Corner> left_half = {{{0, 0, 0}}, {{4, 4, 0}}, {{0, 4, 0}}},
                          right_half = {{{0, 0, 0}}, {{4, 0, 0}}, {{4, 4, 0}}};

// The first triangle makes three planes. Its neighbor across the diagonal lies beyond the diagonal's plane, so two more are
// enough; with only cut edges dropped it makes three.
TEST(Svbsp, an_edge_in_common_has_one_plane) {
  Paper shared;
  shared.add(1, left_half);
  EXPECT_EQ(shared.nodes.size(), 3u);
  shared.add(1, right_half);
  EXPECT_EQ(shared.nodes.size(), 5u);
  EXPECT_EQ(shared.work.cuts, 0u);
  EXPECT_EQ(shared.work.lit, 2u);
  for (const Drop drop : {Drop::cut, Drop::none}) {
    Paper all;
    all.rules.drop = drop;
    all.add(1, left_half), all.add(1, right_half);
    EXPECT_EQ(all.nodes.size(), 6u);
  }
  for (const auto& [x, y] : {std::pair{1, 3}, {3, 1}}) EXPECT_EQ(shared.at(x, y), in_cell(x > y));
  for (const auto& [x, y] : {std::pair{-1, 3}, {5, 1}, {1, 5}, {3, -1}}) EXPECT_EQ(shared.at(x, y), out_cell);
}

// A square across the left edge, x = 0, of a triangle is cut once by it: a shadowed part and a lit one, whose planes are
// those of its three own edges. Were the cut's plane made too, there would be four, and the shadow the same.
TEST(Svbsp, cuts_make_no_planes) {
  const std::vector<Corner> square = {{{-1, 2, 0}}, {{1, 2, 0}}, {{1, 3, 0}}, {{-1, 3, 0}}};
  for (const auto& [drop, planes] : {std::pair{Drop::shared, 3u}, {Drop::cut, 3u}, {Drop::none, 4u}}) {
    Paper paper;
    paper.rules.drop = drop;
    paper.add(2, left_half), paper.add(1, square);
    EXPECT_EQ(paper.nodes.size(), 3 + planes);
    EXPECT_EQ(paper.work.cuts, 1u);
    EXPECT_EQ(paper.work.lit, 2u);
    EXPECT_EQ(paper.work.shadowed, 1u);
    EXPECT_EQ(paper.at(-0.5, 2.5), in_cell(1));
    EXPECT_EQ(paper.at(0.5, 2.5), in_cell(0));
    EXPECT_EQ(paper.at(-1.5, 2.5), out_cell);
  }
}

// The trap: an edge that the regular BSP tree made lies on no plane of this tree. A polygon whose only edge toward x > 4 is
// such a cut must not shade what is there.
TEST(Svbsp, cuts_of_the_regular_tree_make_planes) {
  Paper paper;
  paper.add(1, {{{0, 0, 0}}, {{4, 0, 0}, bsp_cut}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(paper.nodes.size(), 4u);
  EXPECT_EQ(paper.at(3, 2), in_cell(0));
  EXPECT_EQ(paper.at(5, 2), out_cell);
  Paper wrong;
  wrong.add(1, {{{0, 0, 0}}, {{4, 0, 0}, shadow_cut}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(wrong.at(5, 2), in_cell(0));
}

// An edge without length has no plane: two corners in one place change nothing.
TEST(Svbsp, edges_without_length_make_no_planes) {
  Paper paper;
  paper.add(1, {{{0, 0, 0}}, {{4, 0, 0}}, {{4, 0, 0}}, {{4, 4, 0}}, {{0, 4, 0}}});
  EXPECT_EQ(paper.nodes.size(), 4u);
  EXPECT_EQ(paper.at(3, 2), in_cell(0));
  EXPECT_EQ(paper.at(5, 2), out_cell);
}

// In whatever order: the nearer one is found where it is, and the farther one around it; none counts twice.
TEST(Svbsp, cells_know_what_is_nearest_in_any_order) {
  const std::vector<Corner> large = {{{0, 0, 0}}, {{8, 0, 0}}, {{8, 8, 0}}, {{0, 8, 0}}},
                            small = {{{2, 2, 0}}, {{3, 2, 0}}, {{3, 3, 0}}, {{2, 3, 0}}};
  Paper near_first, far_first;
  near_first.add(5, small), near_first.add(1, large);
  far_first.add(1, large), far_first.add(5, small);
  for (const auto& [x, y] : {std::pair{2.5, 2.5}, {2.5, 1.0}, {1.0, 2.5}, {7.0, 7.0}}) {
    const bool is_small = x == 2.5 && y == 2.5;
    EXPECT_EQ(near_first.at(x, y), in_cell(is_small ? 0 : 1));
    EXPECT_EQ(far_first.at(x, y), in_cell(is_small ? 1 : 0));
  }
  EXPECT_EQ(far_first.work.shadowed, 0u);
  EXPECT_EQ(near_first.work.shadowed, 1u);
}

// All cells IN, the least height 1: what is no higher is hidden, and only that. An OUT cell remains until the square is
// full.
TEST(Svbsp, a_full_tile_hides_what_is_farther) {
  Paper paper;
  const auto bounded = [](std::vector<Corner> corners) {  // the tile's borders are no edges
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 &a = corners[i].at, &b = corners[(i + 1) % corners.size()].at;
      if (a.x == b.x || a.y == b.y) corners[i].edge = shadow_cut;
    }
    return corners;
  };
  paper.builder.start();
  paper.add(2, bounded(left_half));
  EXPECT_FALSE(paper.builder.hides(0));
  paper.add(1, bounded(right_half));
  EXPECT_TRUE(paper.builder.hides(1));
  EXPECT_FALSE(paper.builder.hides(1.5));
  EXPECT_EQ(paper.nodes.size(), 1u);
}

// 90 rows of 90 tiles would be one for each of 8100 slivers that run from border to border, side by side: each would lie in 90.
TEST(Svbsp, pieces_lie_in_64_tiles_at_most_on_average) {
  constexpr int count = 8100;
  const glm::dvec4 light(0, 1, 0, 0);
  for (const bool along_x : {false, true}) {
    std::vector<SceneTriangle> triangles;
    std::vector<std::int8_t> signs;
    for (int i = 0; i < count; ++i) {
      const float left = static_cast<float>(i) / count, right = (static_cast<float>(i) + 0.5f) / count;
      const auto at = [&](float across, float along) {
        return along_x ? glm::vec3(along, 0, across) : glm::vec3(across, 0, along);
      };
      const SceneTriangle& t = triangles.emplace_back(SceneTriangle{{{at(left, 0), at(right, 0), at(left, 1)}}, 0});
      signs.push_back(static_cast<std::int8_t>(orient3d_sign(t.points[0], t.points[1], t.points[2], light)));
    }
    const Facing facing{triangles, signs};
    const ProjectedSpace space(light, {{0, 0, 0}, {1, 0, 1}});
    Pieces pieces;
    pieces.make(space, facing, count, [&](std::size_t i, Corner* corners) -> Pieces::Part {
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles[i].points[k]), own_edge};
      return {static_cast<std::uint32_t>(i), {corners, 3}};
    });
    Forest forest;
    forest.grow(space, pieces, facing, Forest::Order::tiles, {.tile_size = 1}, 1);
    const Grid& grid = forest.grid(0);
    const std::span<const Piece> found = pieces.of_face(0);
    ASSERT_EQ(found.size(), std::size_t{count});
    int tiles = 0;
    for (const Piece& piece : found)
      tiles +=
          (grid.column(piece.high.x) - grid.column(piece.low.x) + 1) * (grid.row(piece.high.y) - grid.row(piece.low.y) + 1);
    EXPECT_LE(tiles, 64 * count);
    EXPECT_GT(tiles, 16 * count);
  }
}

// What lies behind a triangle that covers a tile is nearest to the light nowhere in it.
TEST(Svbsp, what_a_triangle_covers_may_be_left_out) {
  Random random(5);
  std::uint64_t left_out = 0;
  for (const glm::dvec4& light : {glm::dvec4(0.25, 9, 0.125, 1), glm::dvec4(0.25, 1, -0.5, 0)}) {
    std::vector<SceneTriangle> triangles;
    std::vector<std::int8_t> signs;
    Bounds bounds;
    for (int i = 0; i < 600; ++i) {
      const glm::dvec3 center = random.uniform({-4, 0, -4}, {4, 3, 4});
      SceneTriangle& t = triangles.emplace_back();
      for (glm::vec3& p : t.points) p = glm::vec3(center + random.uniform({-3, -0.2, -3}, {3, 0.2, 3}));
      signs.push_back(static_cast<std::int8_t>(orient3d_sign(t.points[0], t.points[1], t.points[2], light)));
      bounds.add(t.points);
    }
    const Facing facing{triangles, signs};
    const ProjectedSpace space(light, bounds);
    Pieces pieces;
    pieces.make(space, facing, triangles.size(), [&](std::size_t i, Corner* corners) -> Pieces::Part {
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles[i].points[k]), own_edge};
      return {static_cast<std::uint32_t>(i), {corners, 3}};
    });
    Forest all, nearest;
    all.grow(space, pieces, facing, Forest::Order::tiles, {.tile_size = 1}, bounds.extent());
    nearest.grow(space, pieces, facing, Forest::Order::tiles, {.tile_size = 1, .very_many = 0}, bounds.extent());
    const auto nearest_at = [&](const Forest& forest, int face, const glm::dvec3& at) {
      Query query = forest.query(face, at);
      std::uint64_t visits = 0;
      locate<1>({&query, 1}, visits);
      return is_in_cell(query.link) ? triangle_in(query.link) : 0xffffffffu;
    };
    for (int i = 0; i < 20'000; ++i) {
      const auto [face, at] = space.of_world(random.uniform({-5, -1, -5}, {5, 3, 5}));
      ASSERT_EQ(nearest_at(nearest, face, at), nearest_at(all, face, at)) << i;
    }
    left_out += nearest.covered_count();
    EXPECT_EQ(all.covered_count(), 0u);
  }
  EXPECT_GT(left_out, 1000u);
}

}  // namespace gnomon::svbsp_tree_test
