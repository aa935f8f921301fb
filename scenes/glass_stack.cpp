// Square sheets of glass one above the other, each turned and moved a little, so that light comes through any number of them;
// with a ball between them that lets nothing through.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

class GlassStack final : public SceneGenerator {
  Number<int> sheets{this, "sheets", 3, {.min = 1, .max = 64, .log = true}, Stage::build, "Number of sheets."};
  Number<double> transmission{this,
                              "transmission",
                              0,
                              {.min = 0, .max = 1},
                              Stage::build,
                              "What part of the light each sheet lets through. With 0 they differ: 0.5, 0.75 and 0.2 in turn."};
  Flag glass{this, "glass", true, Stage::build, "Whether the sheets let light through; else they are opaque."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(8), default_segments, "ground"), {0.62f, 0.6f, 0.56f}));
    scene.meshes.push_back(
        painted(tessellate(Sphere{{0.35f, 0.55f, 0.3f}, 0.3f}, default_segments, "ball"), {0.6f, 0.3f, 0.2f}));
    for (int k = 0; k < sheets; ++k) scene.meshes.push_back(sheet(k));
    scene.lights = shining_at(
        {0, 0, 0},
        {{.name = "point", .kind = PointLight{{-1.6f, 4.5f, 1.2f}}},
         {.name = "sun", .kind = DirectionalLight{{0.4f, -1, -0.3f}}},
         {.name = "panel", .kind = level_square({-1.6f, 4.5f, 1.2f}, 0.6)},
         {.name = "lamp", .kind = DiscLight{.center = {-1.6f, 4.5f, 1.2f}, .normal = {1.6f, -4.5f, -1.2f}, .radius = 0.3f}}});
    scene.views = {{.name = "view", .eye = {2.6f, 3.6f, 4.6f}, .target = {0.25f, 0.1f, 0}, .fov_y_degrees = 34},
                   {.name = "near", .eye = {1.6f, 1.3f, 2.1f}, .target = {0.5f, 0, -0.1f}, .fov_y_degrees = 32},
                   {.name = "far", .eye = {7, 11, 17}, .target = {0.25f, 0.1f, 0}, .fov_y_degrees = 9}};
    return scene;
  }

 private:
  /// Of 2 m, from 0.9 m to 2.1 m above the ground, each turned by the golden angle and moved by 0.3 m along it.
  Mesh sheet(int k) const {
    static constexpr float in_turn[] = {0.5f, 0.75f, 0.2f};
    const double angle = k * std::numbers::pi * (3 - std::sqrt(5.0)), height = 0.9 + 1.2 * (k + 0.5) / sheets;
    const glm::dvec3 u(std::cos(angle), 0, std::sin(angle)), v(-u.z, 0, u.x), center = 0.3 * u + glm::dvec3(0, height, 0);
    Mesh mesh;
    mesh.name = fmt::format("sheet_{}", k + 1);
    mesh.albedo = {0.5f, 0.6f, 0.62f};
    for (const glm::dvec2& corner : {glm::dvec2(-1, -1), glm::dvec2(-1, 1), glm::dvec2(1, 1), glm::dvec2(1, -1)})
      mesh.positions.emplace_back(center + corner.x * u + corner.y * v);
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (glass)
      mesh.transmission =
          std::make_shared<const Transmission>(glm::vec3(transmission > 0 ? static_cast<float>(transmission) : in_turn[k % 3]));
    mesh.seen = !glass;
    finish(mesh);
    return mesh;
  }
};

}  // namespace

GNOMON_SCENE(glass_stack, GlassStack,
             {.title = "Stack of glass",
              .summary = "Sheets of glass one above the other; brings out how a technique multiplies what several surfaces let "
                         "through."})
