// A swarm of loose triangles that each go their own way around an ellipse, above a ground: neighbors part, so that boxes of a
// tree that is only refitted grow into each other. It fills a cube of 2 m.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace gnomon;

class Swarm final : public SceneGenerator {
  Number<int> count{this, "count", 4096, {.min = 1, .max = 1000000, .log = true}, Stage::build, "Number of triangles."};
  Number<double> reach{this,         "reach",
                       0.2,          {.unit = "m", .min = 0.001, .max = 1.6, .log = true},
                       Stage::build, "How far from its first place a triangle comes at most."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses the triangles and their ways."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(7), default_segments, "ground"), {0.62f, 0.63f, 0.58f}));
    scene.meshes.push_back(triangles());
    scene.lights = shining_at({0, 0, 0}, {{.name = "point", .kind = PointLight{{-1.5f, 8, 1}}},
                                          {.name = "sun", .kind = DirectionalLight{{0.4f, -1, -0.3f}}},
                                          {.name = "panel", .kind = level_square({-1.5f, 8, 1}, 0.5)}});
    scene.views = {{.name = "view", .eye = {1.5f, 4.5f, 9.5f}, .target = {0.2f, 1.4f, -0.2f}, .fov_y_degrees = 34}};
    scene.motion = flight(scene);
    return scene;
  }

 private:
  static constexpr double period = 2;  // seconds

  /// Three points of a small cube inside the big one, from 1.8 m above the ground on. The more there are, the smaller they are.
  /// Slivers are drawn again.
  Mesh triangles() const {
    Mesh mesh;
    mesh.name = "swarm";
    mesh.albedo = {0.25f, 0.3f, 0.42f};
    const double half = std::min(0.4, 0.6 / std::cbrt(count.value()));
    Random random(static_cast<std::uint64_t>(seed));
    while (mesh.triangles.size() < static_cast<std::size_t>(count)) {
      const glm::dvec3 center =
          random.uniform(glm::dvec3(half - 1, 1.8 + half, half - 1), glm::dvec3(1 - half, 3.8 - half, 1 - half));
      glm::dvec3 p[3];
      for (glm::dvec3& corner : p) corner = center + random.uniform(glm::dvec3(-half), glm::dvec3(half));
      if (glm::length(glm::cross(p[1] - p[0], p[2] - p[0])) < 0.2 * half * half) continue;
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::dvec3& corner : p) mesh.positions.emplace_back(corner);
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    finish(mesh);
    return mesh;
  }

  /// Each triangle goes around an ellipse, from anywhere on it. A chord of an ellipse with conjugate half axes u and v is at
  /// most 2 sqrt(u^2 + v^2) long, which is `reach` where both are reach / sqrt(8). The corners of a triangle move alike, so
  /// that it keeps its area.
  std::shared_ptr<const Motion> flight(const Scene& scene) const {
    auto motion = std::make_shared<Motion>();
    MotionNode node;
    node.weights = {0, 0};
    motion->nodes = {node};
    motion->animations = {{"fly", {circling_weights(0, period)}}};
    Rig rig = rig_at_rest(scene, 1, 0);
    const std::size_t vertex_count = rig.base.size();
    rig.targets.resize(2 * vertex_count);
    Random random(static_cast<std::uint64_t>(seed), 77);  // another stream than the triangles: `reach` moves none of them
    const double longest = reach / std::sqrt(8.0);
    for (std::size_t first = 0; first < vertex_count; first += 3) {
      const glm::dvec3 u = longest * in_ball(random), v = longest * in_ball(random);
      const double phase = random.uniform(0, 2 * std::numbers::pi), c = std::cos(phase), s = std::sin(phase);
      for (std::size_t k = first; k < first + 3; ++k) {
        rig.targets[k] = c * u + s * v;
        rig.targets[vertex_count + k] = c * v - s * u;
      }
    }
    motion->rigs.push_back(std::move(rig));
    return motion;
  }

  static glm::dvec3 in_ball(Random& random) {
    for (;;)
      if (const glm::dvec3 p = random.uniform(glm::dvec3(-1), glm::dvec3(1)); glm::length(p) <= 1) return p;
  }
};

}  // namespace

GNOMON_SCENE(swarm, Swarm,
             {.title = "Swarm",
              .summary = "Thousands of triangles that each move their own way; brings out what a tree over moving triangles "
                         "costs and how fast it decays."})
