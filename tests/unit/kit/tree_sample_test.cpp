// What stands for a tree into which nobody can look.
#include "kit/rays/tree_sample.h"

#include <gnomon/kit/geometry/refit.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "generated_scene.h"
#include "measure/scene/posed_scene.h"
#include "small_world.h"

namespace tree_sample_test {

using namespace gnomon;

BoxTree tree_of(const Mesh& mesh) {
  std::vector<Bounds> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) boxes[t].add(mesh.corners(t).points);
  return BoxTree(boxes);
}

RowPose flying(int frame) { return {.animation = "fly", .seconds = frame / 60.0, .start = 0, .frame_rate = 60, .frames = 120}; }

// A tree over the whole mesh, refitted frame by frame, is what it stands for. Of 20,000 triangles a quarter is looked at.
TEST(TreeSample, decays_as_a_tree_over_the_whole_mesh_does) {
  for (const char* settings : {"count=1024,reach=0.8", "count=20000,reach=0.2"}) {
    Scene scene = generated::make("swarm", settings);
    const Mesh& swarm = scene.meshes[1];
    PosedScene posed(scene);
    posed.go_to(flying(0));
    TreeSample sample(swarm);
    BoxTree tree = tree_of(swarm);
    const double built = tree.cost(), built_sample = sample.cost();
    EXPECT_GT(built_sample, 0);
    double decay = 1;
    for (const int frame : {4, 8, 16, 24, 32, 48}) {
      posed.go_to(flying(frame));
      tree.refit([&](std::uint32_t place) {
        Bounds box;
        box.add(swarm.corners(tree.order()[place]).points);
        return box;
      });
      decay = tree.cost() / built;
      EXPECT_NEAR(sample.refit(swarm) / built_sample, decay, 0.12 * decay) << settings << ", frame " << frame;
    }
    EXPECT_GT(decay, 2) << settings;
    posed.go_to(flying(0));
    EXPECT_EQ(sample.refit(swarm), built_sample) << settings;
  }
}

TEST(TreeSample, of_a_mesh_that_moves_as_a_whole_does_not_decay) {
  Mesh box = small_world::box({0, 0, 0}, {1, 2, 3});
  TreeSample sample(box);
  const double built = sample.cost();
  for (glm::vec3& p : box.positions) p = 4.0f * p + glm::vec3(16, 0, -8);
  EXPECT_EQ(sample.refit(box), built);
}

TEST(TreeSample, of_a_point_costs_nothing_and_counts_as_decayed_once_it_grows) {
  Mesh box = small_world::box({0, 0, 0}, {1, 1, 1});
  const std::vector<glm::vec3> grown = box.positions;
  box.positions.assign(8, glm::vec3(0.5f));
  TreeSample sample(box);
  EXPECT_EQ(sample.cost(), 0);
  box.positions = grown;
  EXPECT_TRUE(is_decayed(sample.refit(box), 0));
  box.positions.assign(8, glm::vec3(0.5f));
  EXPECT_FALSE(is_decayed(sample.refit(box), 1));
  EXPECT_EQ(TreeSample(Mesh()).cost(), 0);
}

TEST(TreeSample, is_small_and_the_same_on_any_number_of_threads) {
  const Scene scene = generated::make("swarm", "count=20000");
  const Mesh& swarm = scene.meshes[1];
  const TreeSample on_all(swarm);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TreeSample on_one(swarm);
  EXPECT_EQ(on_all.cost(), on_one.cost());
  EXPECT_EQ(on_all.bytes(), on_one.bytes());
  EXPECT_LT(on_all.bytes(), 2 * TreeSample::most_triangles * 60);
}

}  // namespace tree_sample_test
