// A standing tube that a chain of joints bends to both sides: a skin, whose vertices each follow the two joints nearest to
// them. A bench beside it stands still.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

class BendingTube final : public SceneGenerator {
  Number<int> rings{this, "rings", 64, {.min = 2, .max = 2048, .log = true}, Stage::build, "Rings of vertices along the tube."};
  Number<int> segments{this, "segments", 32, {.min = 3, .max = 256, .log = true}, Stage::build, "Vertices of a ring."};
  Number<int> joints{this, "joints", 9, {.min = 2, .max = 64, .log = true}, Stage::build, "Joints of the chain."};
  Number<double> bend{
      this, "bend", 120, {.unit = "degrees", .min = 1, .max = 150}, Stage::build, "How far the upper end turns to each side."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(8), default_segments, "ground"), {0.6f, 0.58f, 0.54f}));
    const Box bench{.min = {-1.5f, 0, -1.6f}, .max = {1.5f, 0.45f, -1.1f}};
    scene.meshes.push_back(painted(tessellate(bench, default_segments, "bench"), {0.5f, 0.36f, 0.22f}));
    scene.meshes.push_back(tube());
    scene.lights = shining_at({0, 0.5f, 0}, {{.name = "point", .kind = PointLight{{-1.5f, 6, 3}}},
                                             {.name = "sun", .kind = DirectionalLight{{0.5f, -1, -0.6f}}},
                                             {.name = "panel", .kind = level_square({-1.5f, 6, 3}, 0.5)}});
    scene.views = {{.name = "view", .eye = {1.5f, 3.5f, 8.5f}, .target = {0.1f, 1.1f, -0.4f}, .fov_y_degrees = 38}};
    scene.motion = bending(scene);
    return scene;
  }

 private:
  static constexpr double length = 3, radius = 0.2;  // meters

  /// Closed: rings from the ground up, each counter-clockwise seen from above, and a fan at either end.
  Mesh tube() const {
    Mesh mesh;
    mesh.name = "tube";
    mesh.albedo = {0.3f, 0.45f, 0.55f};
    const auto n = static_cast<std::uint32_t>(segments.value()), ring_count = static_cast<std::uint32_t>(rings.value());
    for (std::uint32_t ring = 0; ring < ring_count; ++ring)
      for (std::uint32_t k = 0; k < n; ++k) {
        const double around = 2 * std::numbers::pi * k / n;
        mesh.positions.emplace_back(
            glm::dvec3(radius * std::sin(around), length * ring / (ring_count - 1), radius * std::cos(around)));
      }
    const std::uint32_t foot = n * ring_count, top = foot + 1, last = n * (ring_count - 1);
    mesh.positions.emplace_back(0, 0, 0);
    mesh.positions.emplace_back(glm::dvec3(0, length, 0));
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t next = (k + 1) % n;
      mesh.triangles.emplace_back(foot, next, k);
      mesh.triangles.emplace_back(top, last + k, last + next);
      for (std::uint32_t ring = 0; ring + 1 < ring_count; ++ring) {
        const std::uint32_t left = ring * n + k, right = ring * n + next;
        mesh.triangles.emplace_back(left, right, right + n);
        mesh.triangles.emplace_back(left, right + n, left + n);
      }
    }
    finish(mesh);
    return mesh;
  }

  /// Joints lie on the axis at equal distances from the foot on, the last one below the upper end. The first stands still; the
  /// others all turn by the same angle about z, to +x, back, to -x and back, half a second each.
  std::shared_ptr<const Motion> bending(const Scene& scene) const {
    auto motion = std::make_shared<Motion>();
    const double step = length / joints;
    const double half = glm::radians(bend.value()) / (joints - 1) / 2;  // of the angle of a joint
    motion->animations = {{"bend", {}}};
    motion->skins.emplace_back();
    double height = 0;
    for (int j = 0; j < joints; ++j) {
      MotionNode joint;
      const auto number = static_cast<std::uint32_t>(j);
      if (j > 0) {
        joint.parent = number - 1;
        joint.translation = {0, step, 0};
        height += step;
        Track turn{number, Track::Property::rotation, Track::Interpolation::linear, {0, 0.5, 1, 1.5, 2}, {}};
        for (const double side : {0.0, -1.0, 0.0, 1.0, 0.0})
          for (const double value : {0.0, 0.0, std::sin(side * half), std::cos(side * half)}) turn.values.push_back(value);
        motion->animations[0].tracks.push_back(turn);
      }
      motion->nodes.push_back(joint);
      motion->skins[0].joints.push_back(number);
      glm::dmat4 joint_from_mesh(1);
      joint_from_mesh[3].y = -height;
      motion->skins[0].inverse_bind.push_back(joint_from_mesh);
    }
    motion->rigs.push_back(skinned(scene, 2, step));
    return motion;
  }

  /// The weights of a vertex are linear in its height between the middles of two joints' pieces; beyond the outer middles one
  /// joint has all. They are multiples of 2^-16, so that their sum is 1 exactly.
  Rig skinned(const Scene& scene, std::uint32_t mesh, double step) const {
    Rig rig = rig_at_rest(scene, mesh, 0);
    rig.skin = 0;
    rig.joints_per_vertex = 2;
    for (const glm::dvec3& p : rig.base) {
      const double along = std::clamp(p.y / step - 0.5, 0.0, joints - 1.0);
      const auto lower = static_cast<std::uint32_t>(std::min(std::floor(along), joints - 2.0));
      const double upper_weight = std::round((along - lower) * 0x1p16) * 0x1p-16;
      for (const std::uint32_t joint : {lower, lower + 1}) rig.joints.push_back(joint);
      for (const double weight : {1 - upper_weight, upper_weight}) rig.weights.push_back(weight);
    }
    return rig;
  }
};

}  // namespace

GNOMON_SCENE(bending_tube, BendingTube,
             {.title = "Bending tube",
              .summary = "A tube that a chain of joints bends; brings out what a deforming mesh costs whose silhouette slides "
                         "over its surface."})
