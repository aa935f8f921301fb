// What goes up to OpenGL where the vertices of a scene move.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include <random>

#include "device/context.h"
#include "small_world.h"

namespace gl_poses_test {
using namespace gnomon;
using small_world::box;

class GlPoses : public testing::Test {
 protected:
  GlPoses() { process_context(); }
  void TearDown() override { release_inputs(); }
};

Scene box_on_ground() {
  Scene scene;
  scene.meshes = {small_world::ground(3), box({-1, 0, -1}, {1, 1.5f, 0.5f})};
  return scene;
}

std::vector<glm::vec3> positions_on_device(const SceneBuffers& buffers) {
  std::vector<glm::vec3> positions(buffers.positions.bytes / sizeof(glm::vec3));
  glGetNamedBufferSubData(buffers.positions.name(), 0, static_cast<GLsizeiptr>(buffers.positions.bytes), positions.data());
  return positions;
}

// The box rises by 1 m; the vertices that a look at some of them would see stay.
TEST_F(GlPoses, a_new_pose_writes_the_vertices_into_the_same_buffers) {
  Scene scene = box_on_ground();
  scene.motion = std::make_shared<const Motion>();
  const GLuint positions = scene_buffers(scene).positions.name(), triangles = scene_buffers(scene).triangles.name();
  const std::uint64_t before = uploaded_scene_bytes();
  scene.meshes[1].positions[1].y += 1;
  EXPECT_EQ(uploaded_scene_bytes(), before);
  ++scene.pose_number;
  EXPECT_EQ(uploaded_scene(scene), nullptr) << "it has not got this pose";
  const SceneBuffers& buffers = scene_buffers(scene);
  EXPECT_EQ(buffers.positions.name(), positions);
  EXPECT_EQ(buffers.triangles.name(), triangles);
  EXPECT_EQ(uploaded_scene_bytes(), before + 12u) << "the vertex that moved, no triangles";
  EXPECT_EQ(positions_on_device(buffers)[4 + 1], scene.meshes[1].positions[1]);
  EXPECT_EQ(uploaded_scene(scene), &scene_buffers(scene));
  EXPECT_EQ(uploaded_scene_bytes(), before + 12u) << "once";
  forget_scene(scene);
  EXPECT_EQ(uploaded_scene(scene), nullptr);
}

// Without motion nobody moves vertices but an edit, whose triangles may be others.
TEST_F(GlPoses, another_pose_number_of_a_scene_without_motion_is_another_scene) {
  Scene scene = box_on_ground();
  const GLuint positions = scene_buffers(scene).positions.name();
  scene.meshes[1].positions[1].y += 1;
  ++scene.pose_number;
  EXPECT_NE(scene_buffers(scene).positions.name(), positions);
  EXPECT_EQ(positions_on_device(scene_buffers(scene))[4 + 1], scene.meshes[1].positions[1]);
}

/// So many boxes beside each other, of eight vertices each, that can move.
Scene row_of_boxes(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) scene.meshes.push_back(box(glm::vec3(2 * i, 0, 0), glm::vec3(2 * i + 1, 1, 1)));
  scene.motion = std::make_shared<const Motion>();
  return scene;
}

/// Bytes that go up for the scene as it is now, after which the device has all of its vertices.
std::uint64_t uploaded_for(Scene& scene) {
  ++scene.pose_number;
  const std::uint64_t before = uploaded_scene_bytes();
  const SceneBuffers& buffers = scene_buffers(scene);
  std::vector<glm::vec3> all;
  for (const Mesh& mesh : scene.meshes) all.insert(all.end(), mesh.positions.begin(), mesh.positions.end());
  EXPECT_EQ(positions_on_device(buffers), all);
  return uploaded_scene_bytes() - before;
}

TEST_F(GlPoses, of_each_mesh_the_range_goes_up_that_holds_all_that_differs) {
  Scene scene = row_of_boxes(4);
  scene_buffers(scene);
  EXPECT_EQ(uploaded_for(scene), 0u) << "a pose in which nothing moved";
  scene.meshes[0].positions[2].x += 1;
  scene.meshes[0].positions[6].x += 1;
  scene.meshes[3].positions[7].z += 1;
  EXPECT_EQ(uploaded_for(scene), (5 + 1) * 12u);
  // The last vertex of one mesh and the first of the next.
  scene.meshes[1].positions[7].y += 1;
  scene.meshes[2].positions[0].y += 1;
  EXPECT_EQ(uploaded_for(scene), 2 * 12u);
  for (Mesh& mesh : scene.meshes)
    for (glm::vec3& p : mesh.positions) p.y += 1;
  EXPECT_EQ(uploaded_for(scene), 4 * 8 * 12u);
}

// 0 and -0 are equal, and their bits are not.
TEST_F(GlPoses, bits_decide_what_differs) {
  Scene scene = row_of_boxes(1);
  ASSERT_EQ(scene.meshes[0].positions[0].x, 0);
  scene_buffers(scene);
  scene.meshes[0].positions[0].x = -0.0f;
  EXPECT_EQ(uploaded_for(scene), 12u);
  EXPECT_EQ(uploaded_for(scene), 0u);
}

TEST_F(GlPoses, after_many_poses_the_device_has_the_vertices_of_the_last) {
  Scene scene = row_of_boxes(7);
  scene_buffers(scene);
  std::mt19937 random(1);
  for (int pose = 0; pose < 50; ++pose) {
    for (unsigned moved = random() % 6; moved > 0; --moved) {
      std::vector<glm::vec3>& positions = scene.meshes[random() % 7].positions;
      positions[random() % positions.size()].y = static_cast<float>(random() % 16);
    }
    EXPECT_LE(uploaded_for(scene), 7 * 8 * 12u);
  }
}

// The copy that poses are compared with is the harness's.
TEST_F(GlPoses, a_scene_that_can_move_counts_as_much_memory_as_one_that_cannot) {
  Scene moves = row_of_boxes(3), rests = row_of_boxes(3);
  rests.motion = nullptr;
  const std::size_t bytes = scene_buffers(moves).bytes;
  EXPECT_EQ(bytes, scene_buffers(rests).bytes);
  moves.meshes[0].positions[0].y += 1;
  ++moves.pose_number;
  EXPECT_EQ(scene_buffers(moves).bytes, bytes);
}

// What was forgotten goes up as a whole.
TEST_F(GlPoses, a_scene_that_was_forgotten_goes_up_as_a_whole) {
  Scene scene = row_of_boxes(2);
  scene_buffers(scene);
  scene.meshes[1].positions[3].y += 1;
  forget_scene(scene);
  EXPECT_EQ(uploaded_for(scene), 2 * (8 + 12) * 12u);
  scene.meshes[1].positions[3].y += 1;
  EXPECT_EQ(uploaded_for(scene), 12u);
}

}  // namespace gl_poses_test
