// What of its own surface never shades a visible point.
#include <gnomon/kit/geometry/receiver.h>
#include <gtest/gtest.h>

#include "hand_made.h"

namespace gnomon::receiver_test {

/// A square at y = 0, mesh 0, a mesh without triangles, a triangle in the same plane, and a sphere of two triangles.
Scene paper_scene() {
  Scene scene;
  Mesh sphere = hand_made::mesh_of({{0, 1, 0}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
  sphere.shape = Sphere{};
  scene.meshes = {hand_made::square(1, 0), Mesh{}, hand_made::mesh_of({{5, 0, 0}, {6, 0, 0}, {5, 0, 1}}, {{0, 1, 2}}), sphere};
  return scene;
}

const glm::vec3* corners_of(const Scene& scene, std::size_t mesh) { return scene.meshes[mesh].positions.data(); }

TEST(Receiver, numbers_count_mesh_after_mesh) {
  const TriangleNumbers numbers(paper_scene());
  EXPECT_EQ(numbers.first_of(0), 0u);
  EXPECT_EQ(numbers.end_of(0), 2u);
  EXPECT_EQ(numbers.first_of(1), 2u);
  EXPECT_EQ(numbers.end_of(1), 2u);
  EXPECT_EQ(numbers.end_of(3), 5u);
  const std::uint32_t meshes[] = {0, 0, 2, 3, 3};
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(numbers.mesh_of(i), meshes[i]) << i;
}

// Its own triangle by its number, the other half of the square and the far triangle by their plane; nothing else.
TEST(Receiver, a_triangle_leaves_out_its_plane) {
  const Scene scene = paper_scene();
  const NumberedReceiver receiver = TriangleNumbers(scene).numbered({{0, 1e-9f, 0}, 0, 1});
  EXPECT_TRUE(receiver.has_triangle());
  EXPECT_TRUE(receiver.is_own(1));
  for (const std::uint32_t other : {0u, 2u, 3u, 4u}) EXPECT_FALSE(receiver.is_own(other)) << other;
  EXPECT_TRUE(receiver.Receiver::is_own(0, 1));
  EXPECT_FALSE(receiver.Receiver::is_own(2, 1));
  EXPECT_TRUE(receiver.leaves_out(scene, 0, corners_of(scene, 0)));
  EXPECT_TRUE(receiver.leaves_out(scene, 2, corners_of(scene, 2)));
  EXPECT_FALSE(receiver.leaves_out(scene, 3, corners_of(scene, 3)));
  const glm::vec3 nearly[] = {{5, 0, 0}, {6, 0, 0}, {5, 0x1p-60f, 1}};
  EXPECT_FALSE(receiver.leaves_out(scene, 2, nearly));
}

TEST(Receiver, an_exact_shape_leaves_out_its_mesh) {
  const Scene scene = paper_scene();
  const NumberedReceiver receiver = TriangleNumbers(scene).numbered({{0, 1, 0}, 3, Receiver::whole_mesh});
  EXPECT_FALSE(receiver.has_triangle());
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(receiver.is_own(i), i >= 3) << i;
  EXPECT_FALSE(receiver.is_coplanar(scene, corners_of(scene, 0)));
}

TEST(Receiver, a_point_in_space_leaves_out_nothing) {
  const Scene scene = paper_scene();
  const NumberedReceiver receiver = TriangleNumbers(scene).numbered({{0, 0, 0}});
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_FALSE(receiver.leaves_out(scene, i, corners_of(scene, 0))) << i;
}

}  // namespace gnomon::receiver_test
