// Silhouettes: the side quads of known edges.
#include <gnomon/kit/geometry/exact.h>
#include <gtest/gtest.h>

#include <array>

#include "small_world.h"
#include "volume_scenes.h"

namespace side_quads_test {
using namespace gnomon;
using namespace volume_scenes;

/// The corners of a side quad, by the sentence at SilhouetteEdge.
std::array<glm::dvec4, 4> side_quad(const SilhouetteEdge& edge, std::span<const glm::vec3> positions, const glm::dvec4& light) {
  const glm::dvec3 low = positions[edge.low], high = positions[edge.high];
  if (edge.count > 0) return {glm::dvec4(high, 1), glm::dvec4(low, 1), extruded(low, light), extruded(high, light)};
  return {glm::dvec4(low, 1), glm::dvec4(high, 1), extruded(high, light), extruded(low, light)};
}

using Quads = std::vector<std::array<glm::dvec4, 4>>;

/// The quads of `expected` are those of the silhouette, in any order, each from its own first corner on.
void expect_quads(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const Quads& expected) {
  ASSERT_EQ(silhouette.edges.size(), expected.size());
  for (const auto& wanted : expected) {
    int found = 0;
    for (const SilhouetteEdge& edge : silhouette.edges) {
      const auto quad = side_quad(edge, adjacency.positions(), silhouette.light);
      bool same = true;
      for (int k = 0; k < 4; ++k) same &= glm::length(quad[k] - wanted[k]) < 1e-6;  // 0.2 is rounded to float32: 3e-9 off
      found += same;
    }
    EXPECT_EQ(found, 1) << "quad from " << wanted[0].x << ' ' << wanted[0].y << ' ' << wanted[0].z;
  }
}

const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);

// T = (AB x AC).(L_xyz - L_w A) is the light's height over z = 0, here 5: counter-clockwise seen from the light, and the quads
// run B, A, A_inf, B_inf with X_inf = (L_w X - L_xyz, 0): A_inf = -(0.2, 0.3, 5), B_inf = (1 - 0.2, -0.3, -5).
TEST(Edges, quads_of_a_triangle_with_the_light_above) {
  const Scene scene = scene_of({mesh_of({a, b, c}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  const Silhouette s = silhouette_of(adjacency, {0.2, 0.3, 5, 1});
  EXPECT_EQ(s.facing[0], 1);
  const glm::dvec4 a_inf(-0.2, -0.3, -5, 0), b_inf(0.8, -0.3, -5, 0), c_inf(-0.2, 0.7, -5, 0);
  expect_quads(adjacency, s,
               {{{{1, 0, 0, 1}, {0, 0, 0, 1}, a_inf, b_inf}},
                {{{0, 1, 0, 1}, {1, 0, 0, 1}, b_inf, c_inf}},
                {{{0, 0, 0, 1}, {0, 1, 0, 1}, c_inf, a_inf}}});
}

// T = -5: the quads run A, B, B_inf, A_inf.
TEST(Edges, quads_of_a_triangle_with_the_light_below) {
  const Scene scene = scene_of({mesh_of({a, b, c}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  const Silhouette s = silhouette_of(adjacency, {0.2, 0.3, -5, 1});
  EXPECT_EQ(s.facing[0], -1);
  const glm::dvec4 a_inf(-0.2, -0.3, 5, 0), b_inf(0.8, -0.3, 5, 0), c_inf(-0.2, 0.7, 5, 0);
  expect_quads(adjacency, s,
               {{{{0, 0, 0, 1}, {1, 0, 0, 1}, b_inf, a_inf}},
                {{{1, 0, 0, 1}, {0, 1, 0, 1}, c_inf, b_inf}},
                {{{0, 1, 0, 1}, {0, 0, 0, 1}, a_inf, c_inf}}});
}

// T = 1 for the direction (0.3, 0.1, 1) to the light; both far corners of a quad are the direction of light, -(0.3, 0.1, 1).
TEST(Edges, quads_of_a_triangle_under_a_directional_light) {
  const Scene scene = scene_of({mesh_of({a, b, c}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  const Silhouette s = silhouette_of(adjacency, {0.3, 0.1, 1, 0});
  EXPECT_EQ(s.facing[0], 1);
  const glm::dvec4 far_end(-0.3, -0.1, -1, 0);
  expect_quads(adjacency, s,
               {{{{1, 0, 0, 1}, {0, 0, 0, 1}, far_end, far_end}},
                {{{0, 1, 0, 1}, {1, 0, 0, 1}, far_end, far_end}},
                {{{0, 0, 0, 1}, {0, 1, 0, 1}, far_end, far_end}}});
}

// T = 0: the light (3, 2, 0) lies in the plane of the triangle.
TEST(Edges, triangle_edge_on_takes_no_part) {
  const Scene scene = scene_of({mesh_of({a, b, c}, {{0, 1, 2}})});
  const EdgeAdjacency adjacency(scene);
  for (const glm::dvec4& light : {glm::dvec4(3, 2, 0, 1), glm::dvec4(3, 2, 0, 0)}) {
    const Silhouette s = silhouette_of(adjacency, light);
    EXPECT_EQ(s.facing[0], 0);
    EXPECT_TRUE(s.edges.empty());
    EXPECT_EQ(adjacency.depth_at({-2, -1.5f, 0}, s).volumes, 0);
  }
}

// Shewchuk's orient3d of this vector is -5 and T is 5: the sign here is that of T.
TEST(Edges, sign_convention_is_that_of_counter_clockwise_seen_from_the_light) {
  EXPECT_EQ(orient3d_sign(a, b, c, glm::vec3(0.2f, 0.3f, 5)), 1);
  EXPECT_EQ(orient3d_sign(a, b, c, glm::vec3(0.2f, 0.3f, -5)), -1);
}

// Lengyel's Table 10.1 on the tetrahedron O, A, B, C: of the edge AB, triangle ABC is the first, running from A to B, and OAB
// (in the plane z = 0, facing down) the second. The light at (2, 3, 5) sees ABC (2 + 3 + 5 > 1) and not OAB: toward. That at
// (-1, -1.5, -0.25) sees OAB and not ABC: away. `outward` is the vector's normal of the quad.
TEST(Edges, side_quads_are_the_rows_of_lengyels_table) {
  const glm::vec3 o(0), va(1, 0, 0), vb(0, 1, 0), vc(0, 0, 1);
  const Scene scene = scene_of({mesh_of({va, vb, vc, o}, {{0, 1, 2}, {1, 0, 3}, {2, 1, 3}, {0, 2, 3}})});
  const EdgeAdjacency adjacency(scene);
  struct Row {
    glm::dvec4 light;
    bool toward;
    std::array<glm::dvec4, 4> quad;
    glm::dvec3 outward;
  };
  const glm::dvec4 ha(1, 0, 0, 1), hb(0, 1, 0, 1);
  const glm::dvec4 toward_sun(-0.2, -0.3, -1, 0), away_sun(0.5, 0.6, 0.1, 0);
  for (const Row& row : {Row{{2, 3, 5, 1}, true, {hb, ha, {-1, -3, -5, 0}, {-2, -2, -5, 0}}, {5, 5, -4}},
                         Row{{0.2, 0.3, 1, 0}, true, {hb, ha, toward_sun, toward_sun}, {1, 1, -0.5}},
                         Row{{-1, -1.5, -0.25, 1}, false, {ha, hb, {1, 2.5, 0.25, 0}, {2, 1.5, 0.25, 0}}, {0.25, 0.25, -3.5}},
                         Row{{-0.5, -0.6, -0.1, 0}, false, {ha, hb, away_sun, away_sun}, {0.1, 0.1, -1.1}}}) {
    const Silhouette s = silhouette_of(adjacency, row.light);
    int found = 0;
    for (const SilhouetteEdge& edge : s.edges) {
      if (edge.low != 0 || edge.high != 1) continue;
      ++found;
      EXPECT_EQ(edge.count, row.toward ? 1 : -1);
      const auto quad = side_quad(edge, adjacency.positions(), s.light);
      for (int k = 0; k < 4; ++k) EXPECT_LT(glm::length(quad[k] - row.quad[k]), 1e-6);
      // Counter-clockwise seen from outside: first corner to second, then on along the light.
      const glm::dvec3 normal = glm::cross(glm::dvec3(quad[1] - quad[0]), glm::dvec3(quad[2]));
      EXPECT_LT(glm::length(glm::normalize(normal) - glm::normalize(row.outward)), 1e-6);
    }
    EXPECT_EQ(found, 1);
  }
}

}  // namespace side_quads_test
