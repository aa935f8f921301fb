// A slab that walks under a lamp: where the edge of its shadow is, frame by frame, and back.
#include <gnomon/kit/geometry/circling.h>
#include <gtest/gtest.h>

#include "exact_techniques.h"
#include "measure/scene/posed_scene.h"
#include "small_world.h"

namespace moving_slab_test {

using namespace gnomon;

constexpr int width = 96, height = 8, frame_count = 9;

/// Under a lamp at (0, 4, 0) a slab at y = 1 whose edge is at x has the edge of its shadow at 4/3 x on the ground. The slab
/// reaches from x = -1 to 0 and walks by 0.25 m a frame, which is exact in float32: its edges' shadows walk by 1/3 m.
Scene slab_over_ground() {
  Scene scene{.name = "slab"};
  scene.meshes = {small_world::ground(8),
                  small_world::make_mesh({{-1, 1, -4}, {-1, 1, 4}, {0, 1, 4}, {0, 1, -4}}, {{0, 1, 2}, {0, 2, 3}})};
  scene.lights = {{.name = "lamp", .kind = PointLight{{0, 4, 0}}}};
  Motion motion;
  motion.nodes.resize(1);
  motion.animations = {{"walk", {{.node = 0, .times = {0, 2}, .values = {0, 0, 0, 2, 0, 0}}}}};
  motion.rigs = {rig_at_rest(scene, 1, 0)};
  scene.motion = std::make_shared<const Motion>(std::move(motion));
  return scene;
}

RowPose at_frame(int frame) {
  return {.animation = "walk", .seconds = frame / 4.0, .start = 0, .frame_rate = 4, .frames = frame_count};
}

std::vector<float> mask_of(Technique& technique, const Light& light, const GBuffer& gbuffer) {
  technique.relight(light);
  return small_world::mask_of(technique, gbuffer);
}

TEST(moving_slab, its_shadow_walks_a_third_of_a_meter_a_frame_and_comes_back) {
  Scene scene = slab_over_ground();
  // From straight above, past the slab: the ground alone is seen, whatever is over it.
  Scene bare = scene;
  bare.meshes.resize(1);
  const View view{.name = "view", .eye = {0, 20, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 3};
  const GBuffer gbuffer = small_world::make_gbuffer(bare, view, width, height);
  for (const exact_oracle::ExactTechnique& exact : exact_oracle::exact_techniques()) {
    const auto technique = exact.make();
    technique->setup();
    PosedScene posed(scene);
    technique->build(scene);
    std::vector<std::vector<float>> seen(frame_count);
    for (int step = 0; step < 2 * frame_count - 1; ++step) {
      const int frame = step < frame_count ? step : 2 * frame_count - 2 - step;
      posed.go_to(at_frame(frame));
      technique->update(scene, posed.take_changes());
      const std::vector<float> mask = mask_of(*technique, scene.lights[0], gbuffer);
      const double far = 4 / 3.0 * 0.25 * frame, near = far - 4 / 3.0;
      for (std::size_t i = 0; i < gbuffer.size(); ++i) {
        const double x = gbuffer.position(i).x;
        if (std::min(std::abs(x - near), std::abs(x - far)) < 1e-5) continue;
        EXPECT_EQ(mask[i], x > near && x < far ? 0 : 1) << exact.id() << ", frame " << frame << ", x = " << x;
      }
      const auto fresh = exact.make();
      fresh->setup();
      fresh->build(scene);
      EXPECT_EQ(mask, mask_of(*fresh, scene.lights[0], gbuffer)) << exact.id() << ", frame " << frame;
      if (step < frame_count) seen[frame] = mask;
      EXPECT_EQ(mask, seen[frame]) << exact.id() << ", back at frame " << frame;
    }
    EXPECT_NE(seen.front(), seen.back()) << exact.id();
    posed.go_to(std::nullopt);
  }
}

}  // namespace moving_slab_test
