// How deep in shadow a point lies, against the exact crossing of every triangle; and work on many threads.
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "volume_scenes.h"

namespace edges_depth_test {
using namespace gnomon;
using namespace volume_scenes;

/// Whether the point lies on the closed triangle, exactly on a lattice where all products are exact in double.
bool lies_on(const glm::vec3& point, const Triangle& triangle) {
  const glm::dvec3 u = triangle.points[0], v = triangle.points[1], w = triangle.points[2], p = point;
  const glm::dvec3 n = glm::cross(v - u, w - u);
  if (glm::dot(n, p - u) != 0) return false;
  return glm::dot(n, glm::cross(v - u, p - u)) >= 0 && glm::dot(n, glm::cross(w - v, p - v)) >= 0 &&
         glm::dot(n, glm::cross(u - w, p - w)) >= 0;
}

struct BruteForce {
  std::int64_t crossed = 0;  // by triangles that take part
  bool touched = false;      // the way meets an edge or vertex of one, or the point lies on it
  bool blocked = false;      // by any casting triangle
  bool any_touched = false;  // the same of any casting triangle
};

BruteForce brute_force(const Scene& scene, const Silhouette& s, const glm::vec3& point, bool on_lattice) {
  BruteForce answer;
  std::size_t t = 0;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++t) {
      if (!mesh.casts) continue;
      const Crossing crossing = crosses({point, s.light}, corners(mesh, i));
      const bool touches = crossing == Crossing::degenerate || (on_lattice && lies_on(point, corners(mesh, i)));
      answer.blocked |= crossing == Crossing::crosses;
      answer.any_touched |= touches;
      if (s.facing[t] == 0) continue;
      answer.crossed += crossing == Crossing::crosses;
      answer.touched |= touches;
    }
  return answer;
}

// Random points and lights around and among random casters of every kind, half of them on a lattice of 1/4, where ways go
// through vertices and edges, points lie on triangles and lights in their planes. Two facts: the depth is the number of
// triangles taking part that the way to the light crosses; and it is above zero where any casting triangle blocks, taking
// part or not.
TEST(EdgesDepth, depth_counts_the_triangles_in_the_way_and_sees_every_caster) {
  Random random(5);
  int deep = 0, lit = 0, degenerate = 0, left_out = 0;
  for (int round = 0; round < 120; ++round) {
    const bool lattice = round % 2;
    Scene scene = scene_of(random_casters(random, 6, glm::vec3(-2), glm::vec3(2)));
    if (lattice)
      for (Mesh& mesh : scene.meshes) snap(mesh, 0.25f);
    scene.meshes[0].casts = round % 4 != 0;
    const EdgeAdjacency adjacency(scene);
    const auto to_lattice = [&](const glm::dvec3& p) { return lattice ? glm::round(4.0 * p) / 4.0 : p; };
    std::vector<glm::dvec4> lights = random_lights(random, 2);
    // In the middle of a mesh: inside, where it is closed.
    const Mesh& around = scene.meshes[random.below(6)];
    glm::dvec3 middle(0);
    for (const glm::vec3& p : around.positions) middle += glm::dvec3(p) / double(around.positions.size());
    lights.emplace_back(glm::dvec3(glm::vec3(middle)), 1);
    for (glm::dvec4 light : lights) {
      light = glm::dvec4(to_lattice(light), light.w);
      if (light == glm::dvec4(0)) continue;
      const Silhouette s = silhouette_of(adjacency, light);
      for (int i = 0; i < 60; ++i) {
        const glm::vec3 point(to_lattice(random_point(random, glm::vec3(-3), glm::vec3(3))));
        const EdgeAdjacency::Depth depth = adjacency.depth_at(point, s);
        const BruteForce expected = brute_force(scene, s, point, lattice);
        ASSERT_EQ(depth.degenerate, expected.touched) << "round " << round << ", point " << i;
        if (!expected.touched) {
          ASSERT_EQ(depth.volumes, expected.crossed) << "round " << round << ", point " << i;
        }
        if (!expected.any_touched) {
          ASSERT_EQ(depth.volumes > 0, expected.blocked) << "round " << round << ", point " << i;
          left_out += expected.blocked && std::ranges::find(s.facing, 0) != s.facing.end();
        }
        ++(depth.volumes ? deep : lit), degenerate += depth.degenerate;
      }
    }
  }
  EXPECT_GT(deep, 2000);
  EXPECT_GT(lit, 5000);
  EXPECT_GT(degenerate, 200);
  EXPECT_GT(left_out, 1000);
}

// Far from the origin and at a large scale the signs stay exact: the answers are those of brute force, whose signs are.
TEST(EdgesDepth, depth_is_exact_far_away_and_at_every_scale) {
  Random random(6);
  for (const auto& [scale, shift] :
       {std::pair(1e-4f, 0.0f), {1e3f, 0.0f}, {1.0f, 4096.0f}, {1e-2f, 300.0f}, {1e13f, 0.0f}, {1e-25f, 0.0f}}) {
    Scene scene = scene_of(random_casters(random, 8, glm::vec3(-2), glm::vec3(2)));
    for (Mesh& mesh : scene.meshes) {
      for (glm::vec3& p : mesh.positions) p = p * scale + shift;
      finish(mesh);
    }
    const EdgeAdjacency adjacency(scene);
    for (const glm::dvec4& light : random_lights(random, 2)) {
      const glm::dvec4 moved = light.w == 0 ? light : glm::dvec4(glm::vec3(light) * scale + shift, 1);
      const Silhouette s = silhouette_of(adjacency, moved);
      for (int i = 0; i < 150; ++i) {
        const glm::vec3 point = random_point(random, glm::vec3(-3), glm::vec3(3)) * scale + shift;
        const BruteForce expected = brute_force(scene, s, point, false);
        if (expected.touched) continue;  // on float32 points by chance
        const EdgeAdjacency::Depth depth = adjacency.depth_at(point, s);
        if (depth.degenerate) continue;
        ASSERT_EQ(depth.volumes, expected.crossed);
      }
    }
  }
}

// A sphere of 90 000 triangles beside a soup of 40 000 with doubled ones: several blocks of work in every loop.
TEST(EdgesDepth, adjacency_outline_and_depth_are_the_same_on_one_thread_and_on_many) {
  Random random(7);
  Mesh loose = soup(random, 40000, glm::vec3(-3), glm::vec3(3), 0.1f);
  double_some(random, loose);
  const Scene scene = scene_of({tessellate(Sphere{{0, 0, 0}, 1}, 300, "sphere"), loose});
  const glm::vec3 point(0.3f, -2.9f, 0.2f);
  const auto work = [&](const glm::dvec4& light) {
    const EdgeAdjacency adjacency(scene);
    const Silhouette s = silhouette_of(adjacency, light);
    std::vector<std::int64_t> all;
    for (const EdgeAdjacency::Edge& e : adjacency.edges()) all.insert(all.end(), {e.low, e.high, e.first, e.second});
    for (const EdgeAdjacency::IrregularEdge& e : adjacency.irregular_edges())
      all.insert(all.end(), {e.low, e.high, e.first_side, e.side_count});
    all.insert(all.end(), adjacency.sides().begin(), adjacency.sides().end());
    all.insert(all.end(), adjacency.part_of().begin(), adjacency.part_of().end());
    all.insert(all.end(), s.facing.begin(), s.facing.end());
    for (const SilhouetteEdge& e : s.edges) all.insert(all.end(), {e.low, e.high, e.count, e.part});
    const EdgeAdjacency::Depth depth = adjacency.depth_at(point, s);
    all.insert(all.end(), {depth.volumes, depth.degenerate});
    return all;
  };
  const glm::dvec4 light(0.5, 4, 0.25, 1);
  const auto on = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return work(light);
  };
  const auto one = on(1);
  EXPECT_GT(one[one.size() - 2], 5);  // the depth
  EXPECT_EQ(one, on(2));
  EXPECT_EQ(one, on(8));
}

}  // namespace edges_depth_test
