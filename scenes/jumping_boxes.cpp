// Boxes that stand on a ground, of which one, or each, is moved once and at once: what a technique keeps of frames before is
// wrong from then on, and nothing that it is given says where. Places are whole eighths of a meter, so that positions of
// float32 are exact before and after.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>
#include <utility>

namespace {

using namespace gnomon;

class JumpingBoxes final : public SceneGenerator {
  Number<int> count{
      this, "count", 9, {.min = 1, .max = 256, .log = true}, Stage::build, "Number of boxes; each has a plot of 2 m."};
  Number<double> distance{this,         "distance",
                          0.5,          {.unit = "m", .min = 0.125, .max = 0.75},
                          Stage::build, "Length of the jump; a box is 0.5 m wide."};
  Flag all{this, "all", false, Stage::build, "Each box jumps, in the place of the middle one alone."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const int side = static_cast<int>(std::ceil(std::sqrt(count.value())));
    const float half = static_cast<float>(side);  // of all plots, in meters
    scene.meshes.push_back(painted(tessellate(ground_plane(half + 4), default_segments, "ground"), {0.6f, 0.58f, 0.52f}));
    auto motion = std::make_shared<Motion>();
    motion->animations = {{"jump", {}}};
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 middle(2 * (i % side) + 1 - side, 0, 2 * (i / side) + 1 - side);
      const float height = 0.5f + 0.125f * static_cast<float>(i * 5 % 7);
      const Box box{.min = middle - glm::dvec3(0.25, 0, 0.25), .max = middle + glm::dvec3(0.25, height, 0.25)};
      const float green = 0.3f + 0.05f * static_cast<float>(i % 5);
      const std::string name = fmt::format("box_{}", i + 1);
      scene.meshes.push_back(painted(tessellate(box, default_segments, name), {0.62f, green, 0.2f}));
      if (all || i == count / 2) add_jump(scene, *motion);
    }
    scene.motion = std::move(motion);

    const glm::vec3 lamp(-0.6f * half, 1.5f * half + 1, 0.4f * half);
    scene.lights = shining_at({0, 0, 0}, {{.name = "point", .kind = PointLight{lamp}},
                                          {.name = "sun", .kind = DirectionalLight{{0.7f, -1, -0.4f}}},
                                          {.name = "panel", .kind = level_square(lamp, 0.5)}});
    scene.views = {
        {.name = "view", .eye = {0.5f * half, 1.6f * half + 1, 2.6f * half + 1}, .target = {0, 0.2f, 0}, .fov_y_degrees = 40}};
    return scene;
  }

 private:
  /// Half a frame of 60 Hz: frame 0 is at rest, every later one is behind the jump.
  static constexpr double jump_seconds = 1.0 / 120;
  /// 80 frames of 60 Hz.
  static constexpr double end_seconds = 80.0 / 60;

  /// The last mesh of the scene jumps.
  void add_jump(const Scene& scene, Motion& motion) const {
    const auto node = static_cast<std::uint32_t>(motion.nodes.size());
    motion.nodes.emplace_back();
    motion.animations[0].tracks.push_back({.node = node,
                                           .property = Track::Property::translation,
                                           .interpolation = Track::Interpolation::step,
                                           .times = {0, jump_seconds, end_seconds},
                                           .values = {0, 0, 0, distance, 0, 0, distance, 0, 0}});
    motion.rigs.push_back(rig_at_rest(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1), node));
  }
};

}  // namespace

GNOMON_SCENE(jumping_boxes, JumpingBoxes,
             {.title = "Jumping boxes",
              .summary = "Boxes of which one is moved once, between two frames; brings out how long techniques that remember "
                         "frames keep a shadow whose caster has gone."})
