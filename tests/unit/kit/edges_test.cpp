// Edge adjacency and silhouettes: facts on small meshes, and brute force over random ones.
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <tuple>

#include "small_world.h"
#include "volume_scenes.h"

namespace edges_test {
using namespace gnomon;
using namespace volume_scenes;

// --- Closed meshes ----------------------------------------------------------------------------------------------------------

Mesh cube(float half = 1) { return small_world::box(glm::vec3(-half), glm::vec3(half)); }

/// Sum of counts at every vertex: the outline leaves every vertex as often as it comes to it.
std::vector<int> balance(const Silhouette& silhouette, std::size_t vertex_count) {
  std::vector<int> sum(vertex_count, 0);
  for (const SilhouetteEdge& edge : silhouette.edges) sum[edge.low] += edge.count, sum[edge.high] -= edge.count;
  return sum;
}

// From outside, the seen half of a closed convex body is one disc, and its outline one cycle: every vertex on it is entered
// once and left once. From inside there is no outline, since all triangles face the light alike.
TEST(Edges, outline_of_a_closed_convex_body_is_one_cycle) {
  Random random(1);
  for (const Mesh& mesh : {tetrahedron({-1, -1, -1}, {1, 0, 0}, {0, 1, 0.5f}, {0, 0, 1}), cube(),
                           tessellate(Sphere{{0, 0, 0}, 1}, 16, "sphere")}) {
    const Scene scene = scene_of({mesh});
    const EdgeAdjacency adjacency(scene);
    EXPECT_EQ(adjacency.irregular_edges().size(), 0u);
    EXPECT_EQ(2 * adjacency.edges().size(), 3 * mesh.triangles.size());
    for (int round = 0; round < 30; ++round) {
      glm::dvec4 light(random_point(random, glm::vec3(-1), glm::vec3(1)), round % 2);
      if (round % 2) light *= glm::dvec4(glm::dvec3(4 / glm::length(glm::dvec3(light))), 1);
      const Silhouette s = silhouette_of(adjacency, light);
      ASSERT_FALSE(s.edges.empty());
      std::map<std::uint32_t, std::uint32_t> next;  // from tail to head
      for (const SilhouetteEdge& edge : s.edges) {
        ASSERT_EQ(std::abs(edge.count), 1);
        ASSERT_LT(edge.low, edge.high);
        ASSERT_TRUE(next.emplace(edge.count > 0 ? edge.low : edge.high, edge.count > 0 ? edge.high : edge.low).second);
      }
      std::uint32_t at = next.begin()->first;
      std::size_t steps = 0;
      do {
        ASSERT_TRUE(next.contains(at));
        at = next[at], ++steps;
      } while (at != next.begin()->first && steps <= next.size());
      EXPECT_EQ(steps, next.size());
    }
  }
  const Scene scene = scene_of({cube()});
  const EdgeAdjacency adjacency(scene);
  const Silhouette inside = silhouette_of(adjacency, {0.1, 0.2, 0.3, 1});
  EXPECT_TRUE(inside.edges.empty());
  for (const std::int8_t facing : inside.facing) EXPECT_EQ(facing, -1);
}

// The outline is the boundary of a sum of oriented triangles, so it leaves every vertex as often as it comes to it, whatever
// the mesh; and its count at an edge is the sum over all triangles there of facing times direction, here by brute force over
// positions instead of vertices.
TEST(Edges, outline_of_any_mesh_is_closed_and_counts_triangles_by_direction) {
  Random random(2);
  int many = 0, rounds_with_all = 0;
  for (int round = 0; round < 150; ++round) {
    Scene scene = scene_of(random_casters(random, 5, glm::vec3(-2), glm::vec3(2)));
    if (round % 2)
      for (Mesh& mesh : scene.meshes) snap(mesh, 0.5f);  // then meshes meet in vertices and edges, and triangles are edge-on
    scene.meshes[0].casts = round % 3 != 0;
    const EdgeAdjacency adjacency(scene);
    for (const glm::dvec4& random_light : random_lights(random, 2)) {
      glm::dvec4 light = random_light;
      if (round % 2) light = glm::dvec4(glm::round(glm::dvec3(2.0 * light)) / 2.0, light.w);
      if (light == glm::dvec4(0)) continue;
      const Silhouette s = silhouette_of(adjacency, light);
      for (const int sum : balance(s, adjacency.positions().size())) ASSERT_EQ(sum, 0);

      using Point = std::array<float, 3>;
      const auto point = [&](std::uint32_t v) {
        const glm::vec3 p = adjacency.positions()[v] + 0.0f;
        return Point{p.x, p.y, p.z};
      };
      std::map<std::pair<Point, Point>, int> expected, found;
      for (std::size_t t = 0; t < s.facing.size(); ++t)
        for (int k = 0; k < 3 && s.facing[t] != 0; ++k) {
          const Point from = point(adjacency.triangles()[t][k]), to = point(adjacency.triangles()[t][(k + 1) % 3]);
          const bool up = from < to;
          expected[up ? std::pair(from, to) : std::pair(to, from)] += up ? s.facing[t] : -s.facing[t];
        }
      std::erase_if(expected, [](const auto& entry) { return entry.second == 0; });
      for (const SilhouetteEdge& edge : s.edges) {
        ASSERT_NE(edge.count, 0);
        ASSERT_LT(edge.low, edge.high);
        ASSERT_EQ(adjacency.first_at_position()[edge.low], edge.low);
        ASSERT_EQ(adjacency.first_at_position()[edge.high], edge.high);
        const Point low = point(edge.low), high = point(edge.high);
        const bool up = low < high;
        ASSERT_TRUE(found.emplace(up ? std::pair(low, high) : std::pair(high, low), up ? edge.count : -edge.count).second);
        many += std::abs(edge.count) > 1;
      }
      ASSERT_EQ(found, expected) << "round " << round;
      ++rounds_with_all;
    }
  }
  EXPECT_GT(many, 100);
  EXPECT_GT(rounds_with_all, 400);
}

// The facing of every triangle that takes part is the exact sign, and those that do not are edge-on, do not cast, or are of
// the half that the other one covers.
TEST(Edges, facing_is_the_exact_sign_but_for_the_half_that_is_left_out) {
  Random random(3);
  int edge_on = 0, left_out = 0, used = 0;
  for (int round = 0; round < 60; ++round) {
    Scene scene = scene_of(random_casters(random, 5, glm::vec3(-2), glm::vec3(2)));
    for (Mesh& mesh : scene.meshes) snap(mesh, 0.25f);
    scene.meshes[1].casts = false;
    const EdgeAdjacency adjacency(scene);
    for (glm::dvec4 light : random_lights(random, 2)) {
      light = glm::dvec4(glm::round(glm::dvec3(4.0 * light)) / 4.0, light.w);
      if (light == glm::dvec4(0)) continue;
      const Silhouette s = silhouette_of(adjacency, light);
      std::size_t t = 0;
      for (const Mesh& mesh : scene.meshes)
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++t) {
          const Triangle corner = corners(mesh, i);
          const int sign = orient3d_sign(corner.points[0], corner.points[1], corner.points[2], light);
          if (!mesh.casts) {
            ASSERT_EQ(s.facing[t], 0);
            ASSERT_EQ(adjacency.part_of()[t], EdgeAdjacency::no_part);
            continue;
          }
          const auto half = adjacency.half(adjacency.parts()[adjacency.part_of()[t]], light);
          const bool wanted = half == EdgeAdjacency::Half::both || static_cast<int>(half) == sign;
          ASSERT_EQ(s.facing[t], wanted ? sign : 0);
          edge_on += sign == 0, left_out += !wanted, used += wanted && sign != 0;
        }
    }
  }
  EXPECT_GT(edge_on, 30);
  EXPECT_GT(left_out, 300);
  EXPECT_GT(used, 2000);
}

// --- Welding, parts, halves -------------------------------------------------------------------------------------------------

// Two triangles of different meshes share the edge from the origin to x: written 0 in one and -0 in the other, it is one edge.
TEST(Edges, vertices_at_equal_positions_are_one_across_meshes) {
  const Scene scene = scene_of({mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}),
                                mesh_of({{1, -0.0f, 0}, {-0.0f, 0, -0.0f}, {0, 0, -1}}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  const auto first = adjacency.first_at_position();
  EXPECT_EQ(std::vector<std::uint32_t>(first.begin(), first.end()), (std::vector<std::uint32_t>{0, 1, 2, 1, 0, 5}));
  ASSERT_EQ(adjacency.edges().size(), 1u);
  EXPECT_EQ(adjacency.edges()[0].low, 0u);
  EXPECT_EQ(adjacency.edges()[0].high, 1u);
  EXPECT_EQ(adjacency.edges()[0].first, 0u);   // runs from vertex 0 to 1
  EXPECT_EQ(adjacency.edges()[0].second, 1u);  // from 1 to 0
  EXPECT_EQ(adjacency.irregular_edges().size(), 4u);
  EXPECT_EQ(adjacency.parts().size(), 1u);
  // Both face a light above, so their shared edge is not on the outline.
  EXPECT_EQ(silhouette_of(adjacency, {0.2, 3, 0.1, 1}).edges.size(), 4u);
}

// A mesh that does not cast takes no part in edges: the neighbor's edge stays open.
TEST(Edges, mesh_that_does_not_cast_takes_no_part) {
  Scene scene = scene_of(
      {mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}), mesh_of({{1, 0, 0}, {0, 0, 0}, {0, 0, -1}}, {{0, 1, 2}})});
  scene.meshes[0].casts = false;
  const EdgeAdjacency adjacency(scene);
  EXPECT_EQ(adjacency.edges().size(), 0u);
  EXPECT_EQ(adjacency.irregular_edges().size(), 3u);
  EXPECT_EQ(adjacency.parts().size(), 1u);
  EXPECT_EQ(adjacency.part_of()[0], EdgeAdjacency::no_part);
  EXPECT_EQ(adjacency.part_of()[1], 0u);
  const Silhouette s = silhouette_of(adjacency, {0.2, 3, -0.1, 1});
  EXPECT_EQ(s.facing[0], 0);
  EXPECT_NE(s.facing[1], 0);
  ASSERT_EQ(s.edges.size(), 3u);
  for (const SilhouetteEdge& edge : s.edges) EXPECT_GE(edge.low, 3u);  // vertices of the caster
  EXPECT_EQ(adjacency.depth_at({0.1f, -1, 0.1f}, s).volumes, 0);
}

// Two layers of an open surface that fold at an edge, both seen: the edge is entered twice. A third sheet the other way
// gives 1.
TEST(Edges, count_at_an_edge_is_a_sum_with_multiplicity) {
  const glm::vec3 p(0, 1, 0), q(0, 1, 1);
  std::vector<glm::uvec3> sheets{{0, 1, 2}, {0, 1, 3}};
  for (const int expected : {2, 1}) {
    const Scene scene = scene_of({mesh_of({p, q, {1, 0, 0}, {1, 0.5f, 0}, {-1, 0, 0}}, sheets)});
    const EdgeAdjacency adjacency(scene);
    const Silhouette s = silhouette_of(adjacency, {0, 5, 0, 1});
    int count = 0;
    for (const SilhouetteEdge& edge : s.edges)
      if (edge.low == 0 && edge.high == 1) count += edge.count;
    EXPECT_EQ(std::abs(count), expected);
    sheets.push_back({0, 1, 4});
  }
}

// The corner tetrahedron has volume 1/6, the cube of half-side 1 has 8; each is one closed part, the loose triangle an open
// one.
TEST(Edges, parts_know_whether_they_are_closed_and_how_they_are_wound) {
  Mesh inside_out = cube();
  turn_inside_out(inside_out);
  const auto moved = [](Mesh mesh, float x) {
    for (glm::vec3& p : mesh.positions) p.x += x;
    return mesh;
  };
  const Scene scene = scene_of({tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), moved(cube(), 10),
                                moved(inside_out, 20), mesh_of({{30, 0, 0}, {31, 0, 0}, {30, 1, 0}}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  ASSERT_EQ(adjacency.parts().size(), 4u);
  const double volumes[] = {1.0 / 6, 8, -8};
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(adjacency.parts()[i].closed);
    EXPECT_NEAR(adjacency.parts()[i].volume, volumes[i], 1e-12);
  }
  EXPECT_FALSE(adjacency.parts()[3].closed);
  EXPECT_EQ(adjacency.parts()[1].bounds.min, glm::vec3(9, -1, -1));
  EXPECT_EQ(adjacency.parts()[1].bounds.max, glm::vec3(11, 1, 1));
  using Half = EdgeAdjacency::Half;
  for (const glm::dvec4& light : {glm::dvec4(15, 0, 0, 1), glm::dvec4(0, 1, 0, 0)}) {
    const Half expected[] = {Half::counter_clockwise, Half::counter_clockwise, Half::clockwise, Half::both};
    for (int i = 0; i < 4; ++i) EXPECT_EQ(adjacency.half(adjacency.parts()[i], light), expected[i]) << i;
  }
  // From inside the bounds a way to the light may leave the body without having entered it.
  EXPECT_EQ(adjacency.half(adjacency.parts()[1], {10, 0.5, 0, 1}), Half::both);
  EXPECT_EQ(adjacency.half(adjacency.parts()[2], {19, 1, 1, 1}), Half::both);  // on the corner of the bounds
  // One triangle turned round: its edges are no longer of two triangles in opposite directions.
  Mesh damaged = cube();
  flip(damaged.triangles[0]);
  EXPECT_FALSE(EdgeAdjacency(scene_of({damaged})).parts()[0].closed);
}

// Two cubes that touch in an edge have four triangles there: one part, not closed. In a vertex: two parts, each closed.
TEST(Edges, bodies_that_share_an_edge_are_one_open_part) {
  for (const bool edge : {true, false}) {
    const Scene scene = scene_of(
        {small_world::box({0, 0, 0}, {1, 1, 1}), small_world::box({1, 1, edge ? 0.0f : 1.0f}, {2, 2, edge ? 1.0f : 2.0f})});
    const EdgeAdjacency adjacency(scene);
    EXPECT_EQ(adjacency.irregular_edges().size(), edge ? 1u : 0u);
    ASSERT_EQ(adjacency.parts().size(), edge ? 1u : 2u);
    EXPECT_EQ(adjacency.parts()[0].closed, !edge);
  }
}

// A lamp in a closed box: what it lights inside is blocked nowhere, and outside all is dark, through the walls' inner side,
// which the half for lights outside would not hold.
TEST(Edges, light_inside_a_closed_box_uses_both_halves) {
  for (const bool turned : {false, true}) {
    Mesh mesh = cube();
    if (turned) turn_inside_out(mesh);
    const Scene scene = scene_of({mesh});
    const EdgeAdjacency adjacency(scene);
    const Silhouette s = silhouette_of(adjacency, {0.1, 0.2, 0.3, 1});
    Random random(4);
    for (int i = 0; i < 200; ++i) {
      const glm::vec3 p = random_point(random, glm::vec3(-3), glm::vec3(3));
      const bool outside = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 1;
      EXPECT_EQ(adjacency.depth_at(p, s).volumes, outside ? 1 : 0);
    }
  }
}

// A silhouette found in the memory of another one is the same as one found in fresh memory.
TEST(Edges, memory_of_the_last_silhouette_is_reused_without_a_trace) {
  Random random(8);
  Silhouette reused;
  for (int round = 0; round < 10; ++round) {
    const Scene scene = scene_of(random_casters(random, 1 + round % 5, glm::vec3(-2), glm::vec3(2)));
    const EdgeAdjacency adjacency(scene);
    for (const glm::dvec4& light : random_lights(random, 2)) {
      adjacency.find_silhouette(light, reused);
      const Silhouette fresh = silhouette_of(adjacency, light);
      EXPECT_EQ(reused.light, fresh.light);
      EXPECT_EQ(reused.facing, fresh.facing);
      ASSERT_EQ(reused.edges.size(), fresh.edges.size());
      for (std::size_t i = 0; i < fresh.edges.size(); ++i) {
        const SilhouetteEdge &r = reused.edges[i], &f = fresh.edges[i];
        EXPECT_EQ(std::tie(r.low, r.high, r.count, r.part), std::tie(f.low, f.high, f.count, f.part));
      }
    }
  }
}

TEST(Edges, scene_without_casters_has_no_outline) {
  for (const bool empty : {true, false}) {
    Scene scene;
    if (!empty) scene = scene_of({small_world::ground(1, 0, false), Mesh{}});
    const EdgeAdjacency adjacency(scene);
    EXPECT_TRUE(adjacency.parts().empty());
    const Silhouette s = silhouette_of(adjacency, {0, 5, 0, 1});
    EXPECT_TRUE(s.edges.empty());
    EXPECT_EQ(s.facing.size(), scene.triangle_count());
    EXPECT_EQ(adjacency.depth_at({0, -1, 0}, s).volumes, 0);
  }
}

}  // namespace edges_test
