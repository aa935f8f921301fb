// One exact sphere above a ground: the shadow's outline is an ellipse known in closed form, and the tessellation is put to the
// test, because the mesh is inscribed and its shadow everywhere a little too small.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class SphereOverPlane final : public SceneGenerator {
  Number<double> radius{this, "radius", 1, {.unit = "m", .min = 0.1, .max = 2}, Stage::build, "Radius of the sphere."};
  Number<double> height{
      this, "height", 0.5, {.unit = "m", .min = 0, .max = 3}, Stage::build, "From the ground up to the sphere; at 0 it rests."};
  Number<int> segments{
      this, "segments", default_segments, {.min = 4, .max = 256, .log = true}, Stage::build, "Edges around the equator."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const Sphere sphere{.center = {0, radius + height, 0}, .radius = static_cast<float>(radius)};
    scene.meshes.push_back(painted(tessellate(ground_plane(8), default_segments, "ground"), {0.7f, 0.7f, 0.66f}));
    scene.meshes.push_back(painted(tessellate(sphere, segments, "sphere"), {0.7f, 0.22f, 0.12f}));
    scene.lights = shining_at({1, 0.6f, 0}, {{.name = "point", .kind = PointLight{{-5, 7.5f, 4}}},
                                             {.name = "sun", .kind = DirectionalLight{{1, -1, -0.25f}}}});
    scene.views = {{.name = "view", .eye = {1.2f, 3.6f, 7}, .target = {1, 0.6f, 0}, .fov_y_degrees = 34}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(sphere_over_plane, SphereOverPlane,
             {.title = "Sphere over plane",
              .summary = "One exact sphere above a ground; brings out what tessellation costs in accuracy."})
