#include <gnomon/kit/maps/moving_meshes.h>
#include <gtest/gtest.h>

#include "walking_world.h"

namespace moving_meshes_test {

using namespace walking_world;

Changes changes_of(const Scene& scene, std::initializer_list<std::size_t> moved) {
  Changes changes;
  changes.meshes.resize(scene.meshes.size());
  for (const std::size_t m : moved) changes.meshes[m].kind = MeshChange::Kind::deformed;
  return changes;
}

/// The second box may move, in 0 .. 1 along each axis.
Scene with_reach() {
  Scene scene = walking_scene();
  scene.meshes[2].reach.add({0, 0, 0});
  scene.meshes[2].reach.add({1, 1, 1});
  return scene;
}

TEST(moving_meshes, those_with_a_reach_move) {
  MovingMeshes moving;
  moving.build(with_reach());
  EXPECT_FALSE(moving.moves(0));
  EXPECT_FALSE(moving.moves(1));
  EXPECT_TRUE(moving.moves(2));
  EXPECT_EQ(moving.bytes(), 3 * (2 * sizeof(Bounds) + sizeof(std::uint64_t)));
}

TEST(moving_meshes, they_divide_casters_where_some_of_these_move_and_others_do_not) {
  Scene scene = with_reach();
  const auto divide = [&] {
    MovingMeshes moving;
    moving.build(scene);
    return moving.divide(mesh_boxes(scene));
  };
  EXPECT_TRUE(divide());
  scene.meshes[2].casts = false;
  EXPECT_FALSE(divide()) << "no caster moves";
  for (Mesh& mesh : scene.meshes) mesh.casts = &mesh == &scene.meshes[2];
  EXPECT_FALSE(divide()) << "all casters move";
  scene = walking_scene();
  EXPECT_FALSE(divide());
  EXPECT_FALSE(MovingMeshes().divide({})) << "before the first build";
}

TEST(moving_meshes, a_scene_at_rest_has_none_and_takes_no_memory) {
  MovingMeshes moving;
  moving.build(with_reach());
  moving.build(walking_scene());
  for (std::size_t m = 0; m < 3; ++m) EXPECT_FALSE(moving.moves(m));
  EXPECT_EQ(moving.bytes(), 0u);
}

TEST(moving_meshes, an_update_holds_where_reaches_are_as_they_were_and_what_has_none_stood_still) {
  Scene scene = with_reach();
  MovingMeshes moving;
  moving.build(scene);
  EXPECT_TRUE(moving.update(scene, changes_of(scene, {})));
  EXPECT_TRUE(moving.update(scene, changes_of(scene, {2})));
  EXPECT_FALSE(moving.update(scene, changes_of(scene, {1, 2})));
  scene.meshes[1].reach.add({5, 5, 5});
  EXPECT_FALSE(moving.update(scene, changes_of(scene, {}))) << "the first box begins to move";
  scene.meshes[1].reach = {};
  scene.meshes[2].reach.add({2, 2, 2});
  EXPECT_FALSE(moving.update(scene, changes_of(scene, {2}))) << "the second box goes farther";
  scene.meshes[2].reach = {};
  EXPECT_FALSE(moving.update(scene, changes_of(scene, {}))) << "it stands still";
  moving.build(scene);
  EXPECT_TRUE(moving.update(scene, changes_of(scene, {})));
}

TEST(moving_meshes, places_are_those_of_the_last_update_that_moved_a_mesh) {
  const Scene scene = with_reach();
  MovingMeshes moving;
  moving.build(scene);
  const MovingMeshes::Number built = moving.number();
  EXPECT_EQ(moving.place(2).max, glm::vec3(0, 1.5f, 0.25f));
  EXPECT_FALSE(moving.moved_after(2, built));
  Changes changes = changes_of(scene, {2});
  changes.meshes[2].after.add({5, 6, 7});
  ASSERT_TRUE(moving.update(scene, changes));
  const MovingMeshes::Number moved = moving.number();
  EXPECT_EQ(moving.place(2).max, glm::vec3(5, 6, 7));
  EXPECT_TRUE(moving.moved_after(2, built));
  ASSERT_TRUE(moving.update(scene, changes_of(scene, {})));
  EXPECT_EQ(moving.place(2).max, glm::vec3(5, 6, 7)) << "it stood still";
  EXPECT_TRUE(moving.moved_after(2, built));
  EXPECT_FALSE(moving.moved_after(2, moved));
  moving.build(scene);
  EXPECT_EQ(moving.place(2).max, glm::vec3(0, 1.5f, 0.25f));
  EXPECT_FALSE(moving.moved_after(2, moving.number()));
}

TEST(moving_meshes, numbers_tell_updates_from_builds_and_from_nothing) {
  const Scene scene = with_reach();
  MovingMeshes moving;
  EXPECT_FALSE(moving.number().is_update_of({})) << "before the first build";
  moving.build(scene);
  EXPECT_FALSE(moving.number().is_update_of({}));
  const MovingMeshes::Number built = moving.number();
  EXPECT_FALSE(moving.number().is_update_of(built));
  for (int n = 0; n < 2; ++n) {
    ASSERT_TRUE(moving.update(scene, changes_of(scene, {2})));
    EXPECT_TRUE(moving.number().is_update_of(built));
  }
  const MovingMeshes::Number updated = moving.number();
  EXPECT_FALSE(moving.number().is_update_of(updated));
  EXPECT_FALSE(moving.update(scene, changes_of(scene, {1})));
  EXPECT_FALSE(moving.number().is_update_of(updated)) << "an update that does not hold is none";
  moving.build(scene);
  EXPECT_FALSE(moving.number().is_update_of(built));
  EXPECT_FALSE(moving.number().is_update_of(updated));
}

}  // namespace moving_meshes_test
