// The regular BSP tree on paper: cuts, sets and choices whose answer is derived.
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include "svbsp_bsp_rig.h"
#include "techniques/svbsp/bsp_dividing.h"

namespace gnomon::svbsp_bsp_paper_test {

using namespace bsp_rig;
using Choice = BspOptions::Choice;
using hand_made::mesh_of, hand_made::square;

// Each of the six planes of a box has the rest on its inner side: six nodes, one below the other, two triangles each, no cut.
TEST(Bsp, a_box_is_a_chain_of_its_sides) {
  const Scene scene = scene_of({small_world::box({-1, -2, -3}, {3, 2, 1})});
  for (const Choice choice : {Choice::first, Choice::fewest_splits, Choice::balanced}) {
    const Bsp bsp(scene, {.choice = choice, .free_cuts = false});
    EXPECT_EQ(bsp.node_count(), 6u);
    EXPECT_EQ(bsp.depth(), 6u);
    EXPECT_EQ(bsp.split_count(), 0u);
    for (const auto& set : order(bsp, {0, 0, 0, 1})) EXPECT_EQ(set.size(), 2u);
  }
}

// Choice `first`: the triangle in y = 0 divides the one in x = 0, whose corners are at heights -1, 1, 1: the cut runs through
// the middles of two edges. Below is a triangle, above a quadrilateral, each with one edge of the cut.
TEST(Bsp, a_cut_on_paper) {
  const Scene scene = scene_of(
      {mesh_of({{-4, 0, -4}, {0, 0, 8}, {4, 0, -4}}, {{0, 1, 2}}), mesh_of({{0, -1, 0}, {0, 1, -1}, {0, 1, 1}}, {{0, 1, 2}})});
  const Bsp bsp(scene, {.choice = Choice::first});
  EXPECT_EQ(bsp.split_count(), 1u);
  EXPECT_EQ(bsp.node_count(), 3u);
  EXPECT_EQ(bsp.depth(), 2u);
  EXPECT_EQ(bsp.epsilon(), 8e-10);
  std::vector<std::size_t> corners;
  bsp.front_to_back({3, 5, 0, 1}, [&](std::span<const BspPolygon> set) {
    ASSERT_EQ(set.size(), 1u);
    const auto polygon = bsp.corners(set[0]);
    corners.push_back(polygon.size());
    std::uint32_t marks = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      marks += polygon[i].edge;
      if (set[0].triangle == 1 && polygon[i].at.y == 0) {
        EXPECT_EQ(std::abs(polygon[i].at.z), 0.5);
      }
      const glm::dvec3 next = polygon[(i + 1) % polygon.size()].at;
      if (polygon[i].edge == 1) {
        EXPECT_TRUE(polygon[i].at.y == 0 && next.y == 0);
      }
    }
    EXPECT_EQ(marks, set[0].triangle);
  });
  EXPECT_EQ(corners, (std::vector<std::size_t>{4, 3, 3}));  // above, the first triangle, below
}

// Sheets 2^-44 m apart, far below epsilon, go to their sides by their exact signs; copies, and a neighbor wound the other way,
// lie in one set with the original.
TEST(Bsp, sheets_within_epsilon_keep_their_order) {
  std::vector<Mesh> meshes{square(4, 0)};
  for (const int k : {2, -1, 3, 1, -2})
    meshes.push_back(
        mesh_of({{-1, 0x1p-44f * float(k), -1}, {0, 0x1p-44f * float(k), 2}, {2, 0x1p-44f * float(k), -1}}, {{0, 1, 2}}));
  meshes.push_back(meshes[3]);
  meshes.push_back(mesh_of({{-1, 0, -1}, {2, 0, -1}, {0, 0, 2}}, {{0, 1, 2}}));
  const Scene scene = scene_of(meshes);
  const std::vector<std::vector<std::uint32_t>> down = {{4, 7}, {2}, {5}, {0, 1, 8}, {3}, {6}};
  for (const BspOptions& options : all_options) {
    const Bsp bsp(scene, options);
    EXPECT_GT(bsp.epsilon(), 0x1p-42);
    EXPECT_EQ(bsp.split_count(), 0u);
    EXPECT_EQ(order(bsp, {0, 1, 0, 1}), down);
    EXPECT_EQ(order(bsp, {0.1, 1, 0.1, 0}), down);
    auto up = order(bsp, {0, -1, 0, 1});
    std::ranges::reverse(up);
    EXPECT_EQ(up, down);
  }
}

// A triangle of a mesh whose corners are on a plane, or below epsilon from it, is not cut: a fan around the axis y, whose
// triangles share the corner that lies on the plane of the ground.
TEST(Bsp, shared_corners_on_a_plane_cause_no_cuts) {
  std::vector<glm::vec3> positions{{0.3f, 0, 0.7f}};
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t k = 0; k < 12; ++k) {
    const float angle = 0.5f * static_cast<float>(k);
    positions.push_back({std::cos(angle), 0.5f, std::sin(angle)});
    if (k > 0) triangles.push_back({0, k, k + 1});
  }
  const Scene scene = scene_of({square(2, 0), mesh_of(positions, triangles)});
  EXPECT_EQ(Bsp(scene, {.choice = Choice::first}).split_count(),
            Bsp(scene_of({scene.meshes[1]}), {.choice = Choice::first}).split_count());
}

// Sixty-four copies, half of them turned over, are one set; so are all triangles of a floor, cut as it may be.
TEST(Bsp, copies_and_floors_are_one_set) {
  Mesh copies = mesh_of({{0, 1, 0}, {0.1f, 2, 4}, {4, 3, 0.7f}}, {{0, 1, 2}});
  for (int i = 1; i < 64; ++i) copies.triangles.push_back(i % 2 ? glm::uvec3(0, 2, 1) : glm::uvec3(1, 2, 0));
  for (const BspOptions& options : all_options) {
    const Bsp bsp(scene_of({copies}), options);
    EXPECT_EQ(bsp.node_count(), 1u);
    EXPECT_EQ(bsp.polygons().size(), 64u);
  }
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t x = 0; x < 9; ++x)
    for (std::uint32_t z = 0; z < 9; ++z) {
      positions.push_back({0.1f * float(x), 0.7f, 0.3f * float(z)});
      if (x > 0 && z > 0)
        triangles.push_back({9 * x + z, 9 * x + z - 1, 9 * x + z - 9}),
            triangles.push_back({9 * x + z - 10, 9 * x + z - 9, 9 * x + z - 1});
    }
  const Bsp floor(scene_of({mesh_of(positions, triangles)}), {.free_cuts = false});
  EXPECT_EQ(floor.node_count(), 1u);
  EXPECT_EQ(floor.polygons().size(), 128u);
}

// Faces around an axis, no other one beyond the plane of any, and a wall through the middle of the first and between two
// opposite ones. Of 21 faces a face's plane cuts none and has 21 on one side, the wall's cuts one and has 10 + 10: `balanced`
// takes the wall, 8 against 21, and two chains of 11 parts; `fewest_splits` the first face, and then the wall, which cuts none
// any more: two chains of 10. Of 7 faces `balanced` takes the first one, too, 7 against 8, and then the wall and chains of 3.
// Of 24 faces a wall at z = 1/2 cuts the third and the eleventh and has 7 and 15 beside it: 16 + 8, no less than the 24 of the
// first face, then 23 and 23, 22 and 22; when the third is gone 8 + 6 are less than 21. Chains of 8 and 14 are left.
TEST(Bsp, choices_on_paper) {
  const auto ring = [](int faces, double wall = 0) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), {glm::vec3(a), glm::vec3(b), glm::vec3(c)});
      triangles.push_back({first, first + 1, first + 2});
    };
    for (int k = 0; k < faces; ++k) {
      const double angle = 6.283185307179586 * k / faces;
      const glm::dvec3 middle(std::cos(angle), 0, std::sin(angle)), along(-middle.z, 0, middle.x);
      add(middle - 0.05 * along, middle + 0.05 * along, middle + glm::dvec3(0, 1, 0));
    }
    add({-0.3, 0, wall}, {0.3, 0, wall}, {0, 0.5, wall});
    return scene_of({mesh_of(positions, triangles)});
  };
  const auto expect = [](const Bsp& bsp, std::size_t splits, std::size_t nodes, std::size_t depth) {
    EXPECT_EQ(bsp.split_count(), splits);
    EXPECT_EQ(bsp.node_count(), nodes);
    EXPECT_EQ(bsp.depth(), depth);
  };
  expect(Bsp(ring(21), {.free_cuts = false, .candidates = 99}), 1, 23, 12);
  expect(Bsp(ring(21), {.choice = Choice::fewest_splits, .free_cuts = false, .candidates = 99}), 0, 22, 12);
  expect(Bsp(ring(7), {.free_cuts = false, .candidates = 99}), 0, 8, 5);
  expect(Bsp(ring(24, 0.5), {.free_cuts = false, .candidates = 99}), 1, 26, 18);
}

// Of a sliver edges and normal are as good as those of other triangles: within 1e-11 of the product in quadruple precision,
// where double would lose all of the 2^-20 by which edges differ in direction, but 2^-33.
TEST(Bsp, slivers_have_exact_normals) {
  using Quad = __float128;
  Random random(13);
  for (int round = 0; round < 1000; ++round) {
    const glm::dvec3 along = random.uniform(glm::dvec3(1), glm::dvec3(2));
    const glm::vec3 a(0x1p-20 * random.uniform(glm::dvec3(-1), glm::dvec3(1))), b(along),
        c(3.0 * along + 0x1p-20 * random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    const glm::dvec3 u = glm::dvec3(b) - glm::dvec3(a), v = glm::dvec3(c) - glm::dvec3(a),
                     n = glm::normalize(bsp::normal_of({{a, b, c}}));
    Quad wanted[3], square = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      wanted[i] = Quad(u[j]) * v[k] - Quad(u[k]) * v[j], square += wanted[i] * wanted[i];
    }
    const double length = std::sqrt(static_cast<double>(square));
    ASSERT_GT(length, 0);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(n[i], static_cast<double>(wanted[i]) / length, 1e-11) << round;
  }
}

// Of a leaning sheet one corner is in the plane of the floor and the others 2^-44 m above or below it: it lies on that side,
// and not in the floor's set.
TEST(Bsp, sheets_that_touch_a_plane_lie_on_their_side) {
  constexpr float tiny = 0x1p-44f;
  const Scene scene = scene_of({square(4, 0), mesh_of({{-1, 0, -1}, {0, tiny, 2}, {2, tiny, -1}}, {{0, 1, 2}}),
                                mesh_of({{-1, 0, -1}, {0, -tiny, 2}, {2, -tiny, -1}}, {{0, 1, 2}})});
  EXPECT_EQ(order(Bsp(scene, {.choice = Choice::first}), {0, 1, 0, 1}),
            (std::vector<std::vector<std::uint32_t>>{{2}, {0, 1}, {3}}));
}

// A wall cuts two triangles of one plane that overlap; on either side their parts are one set again.
TEST(Bsp, parts_in_one_plane_are_one_set) {
  const Scene scene = scene_of({mesh_of({{0, -1, -9}, {0, 1, 0}, {0, -1, 9}}, {{0, 1, 2}}),
                                mesh_of({{-2, 0, 0}, {3, 0, 1}, {2, 0, 3}, {-3, 0, 0}}, {{0, 1, 2}, {3, 1, 2}})});
  const Bsp bsp(scene, {.choice = Choice::first});
  EXPECT_EQ(bsp.split_count(), 2u);
  EXPECT_EQ(order(bsp, {5, 1, 0, 1}), (std::vector<std::vector<std::uint32_t>>{{1, 2}, {0}, {1, 2}}));
}

// The largest coordinate may be a negative one.
TEST(Bsp, epsilon_goes_with_the_largest_coordinate) {
  const Scene scene = scene_of({mesh_of({{-16, 0, 1}, {2, 3, 1}, {1, 4, -5}}, {{0, 1, 2}})});
  EXPECT_DOUBLE_EQ(Bsp(scene).epsilon(), 1.6e-9);
}

TEST(Bsp, nothing_and_triangles_without_area_make_no_nodes) {
  const auto never = [](std::span<const BspPolygon>) { FAIL(); };
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {1, 0, 0}};
  flat.triangles = {{0, 1, 2}, {0, 1, 1}};
  for (const Scene& scene : {Scene{}, scene_of({Mesh{}}), scene_of({flat})}) {
    const Bsp bsp(scene);
    EXPECT_EQ(bsp.node_count(), 0u);
    EXPECT_EQ(bsp.depth(), 0u);
    bsp.front_to_back({0, 0, 0, 1}, never);
  }
  flat.triangles.push_back({0, 1, 3});
  const Bsp bsp(scene_of({flat}));
  ASSERT_EQ(bsp.polygons().size(), 1u);
  EXPECT_EQ(bsp.polygons()[0].triangle, 2u);
}

TEST(Bsp, options_without_candidates_are_refused) {
  EXPECT_THROW(Bsp(Scene{}, {.candidates = 0}), Error);
  EXPECT_THROW(Bsp(Scene{}, {.sample = 0}), Error);
}

}  // namespace gnomon::svbsp_bsp_paper_test
