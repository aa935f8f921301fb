// Many exact spheres above a ground, on a jittered grid that always fills the same square: more spheres are smaller ones.
// Every third rests on the ground, the others float; none touch one another.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace gnomon;

class SphereField final : public SceneGenerator {
  Number<int> count{this, "count", 100, {.min = 1, .max = 10000, .log = true}, Stage::build, "Number of spheres."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses places, sizes and colors."};
  Number<int> segments{this, "segments", 32, {.min = 4, .max = 256, .log = true}, Stage::build, "Edges around each equator."};
  Number<int> lights{this,
                     "lights",
                     0,
                     {.min = 0, .max = 64},
                     Stage::build,
                     "Number of further lights, ring_1 and on, in a circle above the field."};
  Choice ring{
      this,         "ring",
      "point",      {"point", "disc", "sphere"},
      Stage::build, "What these are: points, or of 0.3 m around them, discs that face the middle of the field and spheres."};
  Number<double> panel{
      this, "panel", 1, {.unit = "m", .min = 0.001, .max = 100, .log = true}, Stage::build, "Side of the square light panel."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(9), default_segments, "ground"), {0.68f, 0.68f, 0.64f}));

    // The grid has `side` cells in a row, at most 4 m wide; a sphere stays inside its own cell seen from above.
    const int side = static_cast<int>(std::ceil(std::sqrt(count.value())));
    const double cell = std::min(4.0, 16.0 / side);
    Random random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < count; ++i) {
      const double radius = cell * random.uniform(0.2, 0.38), slack = cell / 2 - radius;
      const double x = cell * (i % side + 0.5 - 0.5 * side) + random.uniform(-slack, slack);
      const double z = cell * (i / side + 0.5 - 0.5 * side) + random.uniform(-slack, slack);
      const double clearance = i % 3 == 0 ? 0 : cell * random.uniform(0.05, 0.6);
      const glm::vec3 albedo = random.uniform({0.15, 0.15, 0.15}, {0.75, 0.6, 0.7});
      // Rounding the radius first keeps a resting sphere exactly at rest.
      const auto rounded = static_cast<float>(radius);
      const Sphere sphere{.center = {x, rounded + clearance, z}, .radius = rounded};
      scene.meshes.push_back(painted(tessellate(sphere, segments, fmt::format("sphere_{}", i)), albedo));
    }
    scene.lights = shining_at({0.3f, 0, 0.5f}, {{.name = "point", .kind = PointLight{{-6, 9, 3}}},
                                                {.name = "sun", .kind = DirectionalLight{{1, -0.9f, -0.35f}}},
                                                {.name = "panel", .kind = level_square({-6, 9, 3}, panel)}});
    std::vector<Light> all_around;
    for (int k = 0; k < lights; ++k) {
      const double angle = 2 * M_PI * k / lights;
      all_around.push_back(
          {.name = fmt::format("ring_{}", k + 1), .kind = ring_light({10 * std::cos(angle), 9, 10 * std::sin(angle)})});
    }
    const std::vector<Light> shining = shining_at({0.3f, 0, 0.5f}, all_around, 1.0 / lights);
    scene.lights.insert(scene.lights.end(), shining.begin(), shining.end());
    scene.views = {{.name = "view", .eye = {1, 5.5f, 11.5f}, .target = {0.3f, 0, 0.5f}, .fov_y_degrees = 36},
                   {.name = "low", .eye = {-5, 0.8f, 9.5f}, .target = {0, 0.6f, 0}, .fov_y_degrees = 45}};
    return scene;
  }

 private:
  LightKind ring_light(const glm::vec3& at) const {
    constexpr float radius = 0.3f;
    if (ring.is("disc")) return DiscLight{.center = at, .normal = -at, .radius = radius};
    if (ring.is("sphere")) return SphereLight{.center = at, .radius = radius};
    return PointLight{at};
  }
};

}  // namespace

GNOMON_SCENE(sphere_field, SphereField,
             {.title = "Sphere field",
              .summary = "Many exact spheres above a ground; brings out how cost grows with curved casters."})
