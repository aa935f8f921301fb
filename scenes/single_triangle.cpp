// One triangle above a ground: every number can be checked on paper.
// All three corners have y = 2. The point light stands at y = 4, twice as high, so a corner p throws its shadow to 2 p - light;
// the sun travels along (1, -2, -0.5), so p throws it to p + (1, -2, -0.5).
//   corner        point shadow     sun shadow
//   (-2, 2,  1)   (-2, 0,  1)      (-1, 0,  0.5)
//   ( 1, 2,  2)   ( 4, 0,  3)      ( 2, 0,  1.5)
//   ( 0, 2, -2)   ( 2, 0, -5)      ( 1, 0, -2.5)
// Around the point light lie a rectangle, a disc and a sphere, half a meter wide: where the point shadow's edge runs, away from
// its corners, a point sees half of each.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class SingleTriangle final : public SceneGenerator {
 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const Triangle triangle{{{-2, 2, 1}, {1, 2, 2}, {0, 2, -2}}};
    scene.meshes.push_back(painted(tessellate(ground_plane(6), default_segments, "ground"), {0.72f, 0.7f, 0.65f}));
    scene.meshes.push_back(painted(tessellate(triangle, default_segments, "triangle"), {0.75f, 0.25f, 0.12f}));
    scene.lights = shining_at(
        {0.8f, 0.5f, -0.5f},
        {{.name = "point", .kind = PointLight{{-2, 4, 1}}},
         {.name = "sun", .kind = DirectionalLight{{1, -2, -0.5f}}},
         {.name = "panel", .kind = RectLight{.center = {-2, 4, 1}, .half_u = {0.25f, 0, 0}, .half_v = {0, 0, 0.25f}}},
         {.name = "lamp", .kind = DiscLight{.center = {-2, 4, 1}, .normal = {0, -1, 0}, .radius = 0.25f}},
         {.name = "globe", .kind = SphereLight{.center = {-2, 4, 1}, .radius = 0.25f}}});
    scene.views = {{.name = "view", .eye = {1.5f, 6.5f, 9}, .target = {0.8f, 0.5f, -0.5f}, .fov_y_degrees = 35}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(single_triangle, SingleTriangle,
             {.title = "Single triangle", .summary = "One triangle above a ground, with shadows that can be checked on paper."})
