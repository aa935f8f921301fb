// Which vertices are one in every pose: rules on small rigs.
#include <gnomon/kit/geometry/joined_vertices.h>
#include <gtest/gtest.h>

#include <functional>

#include "moving_volumes.h"

namespace joined_vertices_test {
using namespace moving_volumes;

std::vector<std::uint32_t> joined(const Scene& scene) {
  std::vector<glm::vec3> positions;
  std::vector<std::uint8_t> casts;
  for (const Mesh& mesh : scene.meshes) {
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    casts.resize(positions.size(), mesh.casts);
  }
  return join_vertices(scene, positions, casts);
}

/// Copies of one triangle as meshes, each with a rig at its place and node 0.
Scene copies(std::size_t count) {
  Scene scene{.name = "copies"};
  auto motion = std::make_shared<Motion>();
  motion->nodes.resize(2);
  motion->animations = {{"move", {{.node = 0, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
  for (std::uint32_t m = 0; m < count; ++m) {
    scene.meshes.push_back(small_world::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 1, 2}}));
    motion->rigs.push_back(rig_at_rest(scene, m, 0));
  }
  scene.motion = std::move(motion);
  return scene;
}

/// The scene with its rigs changed.
Scene with(Scene scene, const std::function<void(std::vector<Rig>&)>& change) {
  auto motion = std::make_shared<Motion>(*scene.motion);
  change(motion->rigs);
  scene.motion = std::move(motion);
  return scene;
}

const std::vector<std::uint32_t> together{0, 1, 2, 0, 1, 2}, apart{0, 1, 2, 3, 4, 5};

TEST(joined_vertices, without_motion_are_those_at_equal_positions) {
  Scene scene = copies(2);
  scene.motion = nullptr;
  EXPECT_EQ(joined(scene), together);
  scene.meshes[1].casts = false;
  EXPECT_EQ(joined(scene), apart);
}

TEST(joined_vertices, of_meshes_at_one_node_are_one_across_meshes) {
  EXPECT_EQ(joined(copies(2)), together);
  EXPECT_EQ(joined(with(copies(2), [](auto& rigs) { rigs[1].node = 1; })), apart);
  EXPECT_EQ(joined(with(copies(2), [](auto& rigs) { rigs[1].placement.translate.y = 1; })), apart);
  Scene silent = copies(2);
  silent.meshes[0].casts = false;
  EXPECT_EQ(joined(silent), apart);
}

TEST(joined_vertices, never_join_what_moves_with_what_stands_still) {
  EXPECT_EQ(joined(with(copies(2), [](auto& rigs) { rigs.pop_back(); })), apart);
  // Of three copies the last two stand still.
  const std::vector<std::uint32_t> still_ones{0, 1, 2, 3, 4, 5, 3, 4, 5};
  EXPECT_EQ(joined(with(copies(3), [](auto& rigs) { rigs.resize(1); })), still_ones);
}

// Positions say nothing: they are those of one pose.
TEST(joined_vertices, go_by_base_positions_with_minus_zero_as_zero) {
  Scene posed = copies(2);
  for (glm::vec3& p : posed.meshes[0].positions) p.y += 1;
  EXPECT_EQ(joined(posed), together);
  EXPECT_EQ(joined(with(posed, [](auto& rigs) { rigs[1].base[2].y = -0.0; })), together);
  // Nearer than float32 tells.
  const std::vector<std::uint32_t> one_apart{0, 1, 2, 0, 4, 2};
  EXPECT_EQ(joined(with(posed, [](auto& rigs) { rigs[1].base[1].x += 0x1p-40; })), one_apart);
}

TEST(joined_vertices, go_by_targets_joints_and_weights) {
  const std::vector<std::uint32_t> one_apart{0, 1, 2, 0, 4, 2};
  const auto morphing = [](auto& rigs) {
    for (Rig& rig : rigs) rig.targets.assign(6, {});
  };
  EXPECT_EQ(joined(with(copies(2), morphing)), together);
  EXPECT_EQ(joined(with(copies(2),
                        [&](auto& rigs) {
                          morphing(rigs);
                          rigs[1].targets[3 + 1].z = 1;
                        })),
            one_apart);
  EXPECT_EQ(joined(with(copies(2), [](auto& rigs) { rigs[0].targets.assign(6, {}); })), apart);
  const auto skinned = [](auto& rigs) {
    for (Rig& rig : rigs) {
      rig.skin = 0;
      rig.joints_per_vertex = 2;
      rig.joints = {0, 1, 0, 1, 0, 1};
      rig.weights = {0.5, 0.5, 1, 0, 0.5, 0.5};
    }
  };
  EXPECT_EQ(joined(with(copies(2), skinned)), together);
  const auto changed = [&](const std::function<void(Rig&)>& change) {
    return joined(with(copies(2), [&](auto& rigs) {
      skinned(rigs);
      change(rigs[1]);
    }));
  };
  EXPECT_EQ(changed([](Rig& rig) { rig.joints[3] = 7; }), together) << "a joint of weight 0";
  EXPECT_EQ(changed([](Rig& rig) { rig.joints[2] = 1; }), one_apart);
  EXPECT_EQ(changed([](Rig& rig) { rig.weights[2] = 0.75; }), one_apart);
}

}  // namespace joined_vertices_test
