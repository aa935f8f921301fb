// Triangles that a pose leaves without area: no ray meets them, they share no edges, and no plane is theirs.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/planes.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/rays/rays.h>
#include <gtest/gtest.h>

#include <cmath>

#include "small_world.h"
#include "volume_scenes.h"

namespace degenerate_triangles_test {

using namespace gnomon;

/// A scene that moves, in some pose: what is left of its triangles stays.
Scene posed(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  scene.motion = std::make_shared<const Motion>();
  scene.pose_number = 1;
  return scene;
}

/// The same without them.
Scene without_degenerate(Scene scene) {
  for (Mesh& mesh : scene.meshes) finish(mesh);
  return scene;
}

Mesh unfinished(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  return mesh;
}

/// Three, five and seven times a point of 20 bits: exactly in a line, while float32 rounds every product of its coordinates.
std::array<glm::vec3, 3> line(Random& random) {
  const glm::vec3 step(glm::round(random.uniform(glm::dvec3(0.1), glm::dvec3(0.5)) * 0x1p20) * 0x1p-20);
  return {3.0f * step, 5.0f * step, 7.0f * step};
}

TEST(degenerate_triangles, are_told_exactly) {
  Random random(1);
  for (int round = 0; round < 100; ++round) {
    const auto [a, b, c] = line(random);
    EXPECT_TRUE(is_degenerate(a, b, c));
    EXPECT_TRUE(is_degenerate(a, a, c));
    EXPECT_TRUE(is_degenerate(b, b, b));
    EXPECT_FALSE(is_degenerate(a, b, {c.x, c.y, std::nextafter(c.z, 9.0f)}));
  }
}

TEST(degenerate_triangles, are_met_by_no_ray) {
  Random random(2);
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t k = 0; k < 200; ++k) {
    const auto [a, b, c] = line(random);
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back(k % 4 == 0 ? glm::uvec3(3 * k, 3 * k, 3 * k + 1) : glm::uvec3(3 * k, 3 * k + 1, 3 * k + 2));
  }
  const Scene scene = posed({unfinished(positions, triangles)});
  const RayScene rays(scene, Truth::mesh, RayScene::Which::seen);
  for (int round = 0; round < 20'000; ++round) {
    const glm::uvec3& triangle = triangles[random.below(200)];
    const glm::dvec3 a(positions[triangle.x]), c(positions[triangle.z]);
    const glm::dvec3 at = round % 3 == 0 ? a : a + random.uniform(0, 1) * (c - a);
    const glm::dvec3 origin(glm::vec3(random.uniform(glm::dvec3(-6), glm::dvec3(6))));
    EXPECT_EQ(rays.closest(origin, at - origin).mesh, no_mesh) << round;
    EXPECT_TRUE(rays.met(origin, 2.0 * (at - origin)).empty()) << round;
  }
}

// Of a cube one corner comes to another: the two triangles at their edge become lines, and those beside them share edges.
TEST(degenerate_triangles, have_no_edges_and_no_part_where_two_corners_are_one) {
  Mesh cube = small_world::box(glm::vec3(0), glm::vec3(1));
  cube.positions[7] = cube.positions[3];
  const Scene scene = posed({cube});
  const EdgeAdjacency adjacency(scene);
  EXPECT_TRUE(adjacency.irregular_edges().empty());
  ASSERT_EQ(adjacency.parts().size(), 1u);
  EXPECT_TRUE(adjacency.parts()[0].closed);
  EXPECT_GT(adjacency.parts()[0].volume, 0.5);
  std::size_t without_part = 0;
  for (std::size_t t = 0; t < cube.triangles.size(); ++t) {
    const auto [a, b, c] = cube.corners(t).points;
    EXPECT_EQ(adjacency.part_of()[t] == EdgeAdjacency::no_part, is_degenerate(a, b, c)) << t;
    without_part += adjacency.part_of()[t] == EdgeAdjacency::no_part;
  }
  EXPECT_EQ(without_part, 2u);
  // The outline is that of the same body without these triangles, whose other triangles keep their vertices.
  const Scene sound = without_degenerate(scene);
  const EdgeAdjacency of_sound(sound);
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const glm::dvec4 light(glm::vec3(random.uniform(glm::dvec3(-3), glm::dvec3(3))), round % 2);
    Silhouette one, other;
    adjacency.find_silhouette(light, one);
    of_sound.find_silhouette(light, other);
    ASSERT_EQ(one.edges.size(), other.edges.size());
    for (std::size_t k = 0; k < one.edges.size(); ++k) {
      EXPECT_EQ(one.edges[k].low, other.edges[k].low);
      EXPECT_EQ(one.edges[k].high, other.edges[k].high);
      EXPECT_EQ(one.edges[k].count, other.edges[k].count);
    }
  }
}

TEST(degenerate_triangles, leave_no_part_of_a_mesh_that_is_a_point) {
  Mesh cube = small_world::box(glm::vec3(0), glm::vec3(1));
  cube.positions.assign(8, glm::vec3(0.25f));
  const Scene scene = posed({cube, small_world::ground(4)});
  const EdgeAdjacency adjacency(scene);
  EXPECT_EQ(adjacency.parts().size(), 1u);  // the ground's
  EXPECT_TRUE(cube.is_closed());            // at rest
  EXPECT_TRUE(solid_parts(cube).empty());
}

// Three corners in a line: every light sees it edge-on, and it keeps its edges.
TEST(degenerate_triangles, in_a_line_face_no_light) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    const auto [a, b, c] = line(random);
    const Scene scene = posed({unfinished({a, b, c}, {{0, 1, 2}})});
    const EdgeAdjacency adjacency(scene);
    Silhouette silhouette;
    adjacency.find_silhouette(glm::dvec4(glm::vec3(random.uniform(glm::dvec3(-3), glm::dvec3(3))), round % 2), silhouette);
    EXPECT_EQ(silhouette.facing[0], 0);
    EXPECT_TRUE(silhouette.edges.empty());
  }
}

/// A square at y = 0, and over its middle triangles without area and a sound one.
Scene square_below() {
  Mesh bent = unfinished({{-1, 1, -1}, {1, 1, -1}, {0, 1, -1}, {0, 1, 1}, {1, 1, -1}, {0.25f, 1, 0.25f}},
                         {{0, 2, 1}, {1, 4, 3}, {0, 3, 1}, {5, 5, 5}});
  bent.facts = measure_facts(bent.positions, bent.triangles);
  return posed({small_world::ground(3), bent});
}

TEST(degenerate_triangles, lie_in_no_plane_of_receivers) {
  const Scene scene = square_below();
  const ReceiverPlanes with = find_receiver_planes(scene, 0.01),
                       without = find_receiver_planes(without_degenerate(scene), 0.01);
  ASSERT_EQ(with.planes.size(), 2u);
  ASSERT_EQ(without.planes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(with.planes[k].plane, without.planes[k].plane);
  EXPECT_EQ(with.receiving_area, without.receiving_area);
  EXPECT_EQ(with.tolerance, without.tolerance);
  const auto bent = std::span(with.plane_of).subspan(with.first_triangle[1]);
  const std::vector<std::uint32_t> planes(bent.begin(), bent.end());
  EXPECT_EQ(planes, (std::vector<std::uint32_t>{no_plane, no_plane, 1, no_plane}));
}

TEST(degenerate_triangles, are_not_seen_and_break_no_pixel) {
  const Scene scene = square_below();
  const RayScene seen(scene, Truth::mesh, RayScene::Which::seen);
  const View view{.name = "view", .eye = {0, 4, 0.5f}, .target = {0, 0, 0}};
  const GBuffer gbuffer = make_gbuffer(scene, seen, view, 64, 64, Truth::mesh);
  std::size_t bent = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i)) continue;
    EXPECT_NEAR(glm::length(gbuffer.normal(i)), 1, 1e-6);
    if (gbuffer.mesh[i] != 1) continue;
    EXPECT_EQ(gbuffer.triangle[i], 2u);
    ++bent;
  }
  EXPECT_GT(bent, 100u);
}

TEST(degenerate_triangles, block_no_exact_way_and_bound_no_margin) {
  Random random(5);
  const auto [a, b, c] = line(random);
  const Scene scene = posed({unfinished({a, b, c, a, a}, {{0, 1, 2}, {0, 3, 4}, {0, 3, 1}})});
  const ExactScene exact(scene);
  const AreaScene area(scene);
  LightPieces pieces;
  ExactTally tally;
  AreaTally area_tally;
  for (int round = 0; round < 100; ++round) {
    const glm::vec3 point(random.uniform(glm::dvec3(-2), glm::dvec3(0)));
    const glm::dvec4 light(2.0f * (round % 2 ? a : b) - point, 1);  // beyond a corner
    EXPECT_FALSE(exact.occluded({point}, light, tally).blocked);
    EXPECT_EQ(exact.edge_margin({point}, light, 10).clearance, INFINITY);
    const Light lamp{.name = "lamp", .kind = SphereLight{glm::vec3(light), 0.5f}};
    const LightFigure figure(lamp, point, glm::normalize(glm::dvec3(light) - glm::dvec3(point)));
    EXPECT_NEAR(area.seen({point}, figure, pieces, area_tally).area.best, 1, 1e-12);
  }
}

}  // namespace degenerate_triangles_test
