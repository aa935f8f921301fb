// The barest passes: that each does what it is measured for.
#include "device/bare_pass.h"

#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

namespace bare_pass_test {
using namespace gnomon;

class BarePassTest : public testing::Test {
 protected:
  BarePassTest() {
    process_context();
    scene_.meshes.push_back(small_world::ground(3));
    scene_.meshes.push_back(small_world::box({-1, 0.5f, -1}, {1, 2, 1}));
    scene_.meshes.push_back(small_world::ground(9, -1, false));
    scene_.meshes.back().receives = false;
    scene_.views = {{.name = "main", .eye = {4, 5, 6}, .target = {0, 0, 0}}};
    gbuffer_ = small_world::make_gbuffer(scene_, scene_.views[0], 40, 30);
  }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }
  std::vector<float> drawn(Floor floor, int times = 1) const {
    const BarePass pass(floor, scene_, gbuffer_);
    pass.draw(times);
    return pass.read();
  }

  Scene scene_;
  GBuffer gbuffer_;
};

// All triangles, casters or not: bit for bit the depth that every technique finds, however often it is drawn.
TEST_F(BarePassTest, depth_is_that_of_the_whole_scene) {
  const auto expected = read_texels<float>(depth_stencil(scene_, gbuffer_).texture, GL_DEPTH_COMPONENT);
  ASSERT_GT(std::ranges::count_if(expected, [](float depth) { return depth > 0; }), 600);
  EXPECT_EQ(drawn(Floor::depth_draw), expected);
  EXPECT_EQ(drawn(Floor::depth_draw, 3), expected);
}

TEST_F(BarePassTest, fetch_reads_position_and_normal_of_every_pixel) {
  std::vector<float> expected;
  for (const std::uint32_t mesh : gbuffer_.mesh) expected.push_back(mesh != no_mesh && scene_.meshes[mesh].receives ? 1 : 0);
  ASSERT_GT(std::ranges::count(expected, 1.0f), 100);
  ASSERT_GT(std::ranges::count(expected, 0.0f), 100);
  EXPECT_EQ(drawn(Floor::fetch, 2), expected);
}

TEST_F(BarePassTest, copy_copies_every_pixel) { EXPECT_EQ(drawn(Floor::copy, 2), std::vector<float>(gbuffer_.size(), 1)); }

TEST_F(BarePassTest, a_scene_without_triangles_is_drawn) {
  const Scene nothing{.views = scene_.views};
  const GBuffer gbuffer = small_world::make_gbuffer(nothing, scene_.views[0], 40, 30);
  const BarePass pass(Floor::depth_draw, nothing, gbuffer);
  pass.draw();
  EXPECT_EQ(pass.read(), std::vector<float>(gbuffer.size(), 0));
}

TEST_F(BarePassTest, none_is_no_pass) { EXPECT_THROW(BarePass(Floor::none, scene_, gbuffer_), Error); }

// Whoever draws says what it cannot do without.
TEST(floors, every_technique_that_draws_names_one_and_no_other) {
  for (const TechniqueEntry& entry : registry().techniques())
    EXPECT_EQ(draws(entry.about), entry.about.floor != Floor::none) << entry.id;
}

}  // namespace bare_pass_test
