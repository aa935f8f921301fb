// An edge adjacency that follows a motion is what building in each pose gives, and so are its silhouettes.
#include <gnomon/kit/geometry/edges.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <tuple>

#include "moving_volumes.h"

namespace edges_in_motion_test {
using namespace moving_volumes;

template <class T>
std::vector<std::byte> bytes_of_all(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {bytes.begin(), bytes.end()};
}

void expect_same(const EdgeAdjacency& a, const EdgeAdjacency& b) {
  EXPECT_EQ(bytes_of_all(a.positions()), bytes_of_all(b.positions()));
  EXPECT_EQ(bytes_of_all(a.edges()), bytes_of_all(b.edges()));
  EXPECT_EQ(bytes_of_all(a.irregular_edges()), bytes_of_all(b.irregular_edges()));
  EXPECT_TRUE(std::ranges::equal(a.sides(), b.sides()));
  EXPECT_TRUE(std::ranges::equal(a.first_at_position(), b.first_at_position()));
  EXPECT_TRUE(std::ranges::equal(a.part_of(), b.part_of()));
  ASSERT_EQ(a.parts().size(), b.parts().size());
  for (std::size_t k = 0; k < a.parts().size(); ++k) {
    const EdgeAdjacency::Part &one = a.parts()[k], &other = b.parts()[k];
    EXPECT_EQ(one.bounds.min, other.bounds.min);
    EXPECT_EQ(one.bounds.max, other.bounds.max);
    EXPECT_EQ(one.closed, other.closed);
    EXPECT_EQ(one.volume, other.volume);
  }
}

void expect_same(const Silhouette& a, const Silhouette& b) {
  EXPECT_EQ(a.light, b.light);
  EXPECT_EQ(a.facing, b.facing);
  EXPECT_EQ(a.halves, b.halves);
  EXPECT_EQ(a.regular_count, b.regular_count);
  ASSERT_EQ(a.edges.size(), b.edges.size());
  for (std::size_t i = 0; i < a.edges.size(); ++i) {
    const SilhouetteEdge &one = a.edges[i], &other = b.edges[i];
    EXPECT_EQ(std::tie(one.low, one.high, one.count, one.part), std::tie(other.low, other.high, other.count, other.part));
  }
}

/// A light above, one among the casters, one in a body that moves, and a sun.
std::vector<glm::dvec4> lights_of(const Scene& scene) {
  const glm::vec3 inside = scene.meshes.back().positions[0] * 0.5f + scene.meshes.back().positions[1] * 0.5f;
  return {{0.5, 6, 1, 1}, {0.25, 0.75, 0.125, 1}, glm::dvec4(inside, 1), {0.5, 1, 0.25, 0}};
}

TEST(edges_in_motion, follow_to_what_building_in_the_pose_gives) {
  Random random(1);
  for (Scene& scene : all_scenes()) {
    SCOPED_TRACE(scene.name);
    const std::vector<glm::dvec4> lights = lights_of(scene);
    Posed posed(std::move(scene));
    EdgeAdjacency followed(posed.scene(), Joins::in_every_pose);
    std::vector<Silhouette> kept(lights.size());
    for (std::size_t l = 0; l < lights.size(); ++l) followed.find_silhouette(lights[l], kept[l]);
    int kept_some = 0;
    for (int step = 0; step < 25; ++step) {
      const Changes changes = posed.go_anywhere(random);
      ASSERT_TRUE(followed.can_follow(changes));
      const EdgeAdjacency::Moved moved = followed.move(posed.scene(), changes);
      EXPECT_EQ(moved.empty(), changes.empty());
      const EdgeAdjacency fresh(posed.scene(), Joins::in_every_pose);
      expect_same(followed, fresh);
      for (std::size_t l = 0; l < lights.size(); ++l) {
        Silhouette wanted;
        fresh.find_silhouette(lights[l], wanted);
        const std::vector<std::int8_t> before = kept[l].facing;
        const Refaced refaced = followed.find_silhouette(lights[l], moved, kept[l]);
        expect_same(kept[l], wanted);
        for (std::uint32_t t = 0; t < before.size(); ++t) {
          EXPECT_TRUE(before[t] == wanted.facing[t] || (t >= refaced.first && t < refaced.end)) << t;
        }
        kept_some += refaced.end - refaced.first < before.size();
        EXPECT_LE(kept[l].bytes(), wanted.bytes());
      }
    }
    EXPECT_GT(kept_some, 20);
  }
}

// Another light than that of the silhouette: all is found anew.
TEST(edges_in_motion, find_all_under_another_light) {
  Posed posed(touching_boxes());
  EdgeAdjacency followed(posed.scene(), Joins::in_every_pose);
  Silhouette silhouette, wanted;
  followed.find_silhouette({0.5, 6, 1, 1}, silhouette);
  const EdgeAdjacency::Moved moved = followed.move(posed.scene(), posed.go_to(0.5));
  const Refaced refaced = followed.find_silhouette({-1, 5, 2, 1}, moved, silhouette);
  EXPECT_EQ(refaced.first, 0u);
  EXPECT_EQ(refaced.end, posed.scene().triangle_count());
  followed.find_silhouette({-1, 5, 2, 1}, wanted);
  expect_same(silhouette, wanted);
}

// Two boxes that stand still and share a face have edges of four triangles, and are one open part; the one that walks away
// from them is a part of its own from the start. Meshes that moved: the last three.
TEST(edges_in_motion, join_still_bodies_that_touch_and_no_moving_one) {
  Posed posed(touching_boxes());
  EdgeAdjacency followed(posed.scene(), Joins::in_every_pose);
  const auto part = [&](std::uint32_t mesh) {
    std::uint32_t triangle = 0;
    for (std::uint32_t m = 0; m < mesh; ++m) triangle += static_cast<std::uint32_t>(posed.scene().meshes[m].triangles.size());
    return followed.part_of()[triangle];
  };
  EXPECT_EQ(part(left), part(right));
  EXPECT_NE(part(right), part(walker));
  EXPECT_FALSE(followed.parts()[part(left)].closed);
  for (const std::uint32_t mesh : {walker, folder, vanisher}) EXPECT_TRUE(followed.parts()[part(mesh)].closed) << mesh;
  EXPECT_EQ(followed.move(posed.scene(), posed.go_to(0.5)), (EdgeAdjacency::Moved{walker, folder, vanisher}));
  EXPECT_EQ(followed.parts()[part(walker)].bounds.min.x, 1.5f);
  // By positions the walker is joined with the box that it stands at.
  posed.go_to(0);
  const EdgeAdjacency by_positions(posed.scene());
  EXPECT_EQ(by_positions.part_of()[12 + 12 + 2], by_positions.part_of()[2]);
}

TEST(edges_in_motion, do_not_follow_meshes_without_a_rig) {
  Scene scene = touching_boxes();
  const EdgeAdjacency adjacency(scene, Joins::in_every_pose);
  Changes changes;
  changes.meshes.resize(scene.meshes.size());
  EXPECT_TRUE(adjacency.can_follow(changes));
  EXPECT_FALSE(EdgeAdjacency(scene).can_follow(changes)) << "joined by positions";
  changes.meshes[left].kind = MeshChange::Kind::rigid;
  EXPECT_FALSE(adjacency.can_follow(changes));
  scene.meshes[left].casts = false;
  EXPECT_TRUE(EdgeAdjacency(scene, Joins::in_every_pose).can_follow(changes));
  scene.motion = nullptr;
  EXPECT_FALSE(EdgeAdjacency(scene, Joins::in_every_pose).can_follow(changes));
}

/// The facts of a mesh that moves are those of its base positions: a body that they call closed is closed parts.
TEST(edges_in_motion, agree_with_the_facts_of_meshes) {
  for (const Scene& scene : all_scenes()) {
    const EdgeAdjacency adjacency(scene, Joins::in_every_pose);
    std::uint32_t triangle = 0;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const bool has_rig = std::ranges::find(scene.motion->rigs, m, &Rig::mesh) != scene.motion->rigs.end();
      const EdgeAdjacency::Part& part = adjacency.parts()[adjacency.part_of()[triangle]];
      EXPECT_TRUE(!has_rig || part.closed == scene.meshes[m].facts.closed()) << scene.name << ", mesh " << m;
      triangle += static_cast<std::uint32_t>(scene.meshes[m].triangles.size());
    }
  }
}

// Where triangles have no area, the outline is closed by positions, no edge of it is without length, and as many volumes are
// around a point as by an adjacency of that pose alone.
TEST(edges_in_motion, have_sound_outlines_where_triangles_have_no_area) {
  Random random(2);
  Posed posed(touching_boxes());
  int in_shadow = 0;
  for (const double seconds : {folded, vanished}) {
    posed.go_to(seconds);
    const Scene& scene = posed.scene();
    int without_area = 0;
    for (const Mesh& mesh : scene.meshes)
      for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.corners(t).points;
        without_area += is_degenerate(a, b, c);
      }
    EXPECT_EQ(without_area, seconds == folded ? 2 : 12);
    const EdgeAdjacency adjacency(scene, Joins::in_every_pose), by_positions(scene);
    for (const glm::dvec4& light : lights_of(scene)) {
      Silhouette one, other;
      adjacency.find_silhouette(light, one);
      by_positions.find_silhouette(light, other);
      std::map<std::array<float, 3>, int> balance;
      for (const SilhouetteEdge& edge : one.edges) {
        const glm::vec3 low = adjacency.positions()[edge.low] + 0.0f, high = adjacency.positions()[edge.high] + 0.0f;
        EXPECT_NE(low, high);
        balance[{low.x, low.y, low.z}] += edge.count;
        balance[{high.x, high.y, high.z}] -= edge.count;
      }
      for (const auto& [position, sum] : balance) EXPECT_EQ(sum, 0);
      for (int k = 0; k < 200; ++k) {
        const glm::vec3 point(random.uniform(glm::dvec3(-3, 0, -3), glm::dvec3(3, 2.5, 3)));
        const EdgeAdjacency::Depth a = adjacency.depth_at(point, one), b = by_positions.depth_at(point, other);
        if (a.degenerate || b.degenerate) continue;
        EXPECT_EQ(a.volumes > 0, b.volumes > 0);
        in_shadow += a.volumes > 0;
      }
    }
  }
  EXPECT_GT(in_shadow, 100);
}

}  // namespace edges_in_motion_test
