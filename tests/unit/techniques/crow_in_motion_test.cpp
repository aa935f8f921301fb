// Crow's count in scenes that move: after updates it is the count of an object that builds in the pose.
#include <gtest/gtest.h>

#include "moving_volumes.h"

extern "C" void gnomon_technique_crow_counting(gnomon::Registry& registry);

namespace crow_in_motion_test {
using namespace moving_volumes;

std::unique_ptr<Technique> set_up() {
  Registry registry;
  gnomon_technique_crow_counting(registry);
  auto technique = registry.techniques()[0].make();
  technique->setup();
  return technique;
}

/// Under two lights, the second by an object that shares with the first.
class Followers {
 public:
  explicit Followers(const Scene& scene) : scene_(scene), first_(set_up()), second_(first_->for_another_light()) {
    first_->build(scene_);
    relight();
  }

  void update(const Changes& changes) { first_->update(scene_, changes); }
  void relight() {
    first_->relight(scene_.lights[0]);
    second_->relight(scene_.lights[1]);
  }

  void compare(const GBuffer& gbuffer, const std::string& when) const {
    for (const auto& [used, light] : {std::pair(first_.get(), 0), std::pair(second_.get(), 1)}) {
      const std::string where = fmt::format("{}, light {}, {}", scene_.name, light, when);
      const auto fresh = set_up();
      fresh->build(scene_);
      fresh->relight(scene_.lights[light]);
      EXPECT_EQ(mask_of(*used, gbuffer), mask_of(*fresh, gbuffer)) << where;
      EXPECT_EQ(work_of(*used), work_of(*fresh)) << where;
      EXPECT_LE(bytes_of(*used), bytes_of(*fresh)) << where;
    }
  }

 private:
  const Scene& scene_;
  std::unique_ptr<Technique> first_, second_;
};

TEST(crow_in_motion, masks_and_counts_are_those_of_a_fresh_object) {
  Random random(3);
  for (Scene& scene : all_scenes()) {
    Posed posed(std::move(scene));
    Followers followers(posed.scene());
    for (int step = 0; step < 10; ++step) {
      followers.update(posed.go_anywhere(random));
      if (step % 4 == 1) followers.update(posed.go_anywhere(random));  // without a light between
      followers.relight();
      const GBuffer gbuffer = small_world::make_gbuffer(posed.scene(), posed.scene().views[0], 40, 24);
      followers.compare(gbuffer, fmt::format("step {}", step));
      if (step % 3 != 0) continue;
      followers.relight();
      followers.compare(gbuffer, fmt::format("step {}, relit once more", step));
    }
  }
}

// A caster with holes has no edges in the adjacency; it is met triangle by triangle, where it is now.
TEST(crow_in_motion, casters_with_holes_follow) {
  Scene scene = touching_boxes();
  Mesh& card = scene.meshes[walker];
  card.uv.assign(8, {0.25f, 0.25f});
  card.alpha_mask = std::make_shared<AlphaMask>(2, 2, std::vector<std::uint8_t>{255, 255, 255, 0});
  Posed posed(std::move(scene));
  Followers followers(posed.scene());
  for (const double seconds : {0.5, folded, 2.0, 0.0}) {
    followers.update(posed.go_to(seconds));
    followers.relight();
    followers.compare(small_world::make_gbuffer(posed.scene(), posed.scene().views[0], 40, 24), fmt::format("{} s", seconds));
  }
}

}  // namespace crow_in_motion_test
