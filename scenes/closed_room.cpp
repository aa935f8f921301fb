// An empty room, closed on all six sides, of one color: what light does once it can leave nowhere is known on paper. Of the
// power P that the lamp sends out, surfaces of reflectance r absorb 1 - r at each meeting, so that all of them together send on
// P r / (1 - r): at 0.5 as much as the lamp, at 0.9 nine times as much. The sun stays outside.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class ClosedRoom final : public SceneGenerator {
  Number<double> reflectance{
      this, "reflectance", 0.5, {.min = 0, .max = 0.95}, Stage::build, "Share of the light that every surface sends on."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    // Half the width and depth, and the height; each sheet faces the inside.
    const float w = 2, d = 2, h = 3;
    const glm::vec3 gray(static_cast<float>(double{reflectance}));
    const auto add_sheet = [&](const Plane& plane, const char* name) {
      scene.meshes.push_back(painted(tessellate(plane, default_segments, name), gray));
    };
    add_sheet({.center = {0, 0, 0}, .half_u = {0, 0, d}, .half_v = {w, 0, 0}}, "floor");
    add_sheet({.center = {0, h, 0}, .half_u = {w, 0, 0}, .half_v = {0, 0, d}}, "ceiling");
    add_sheet({.center = {0, h / 2, -d}, .half_u = {w, 0, 0}, .half_v = {0, h / 2, 0}}, "back");
    add_sheet({.center = {0, h / 2, d}, .half_u = {0, h / 2, 0}, .half_v = {w, 0, 0}}, "front");
    add_sheet({.center = {-w, h / 2, 0}, .half_u = {0, h / 2, 0}, .half_v = {0, 0, d}}, "left");
    add_sheet({.center = {w, h / 2, 0}, .half_u = {0, 0, d}, .half_v = {0, h / 2, 0}}, "right");

    scene.lights = shining_at(
        {-0.75f, 1.25f, -1},
        {{.name = "point", .kind = PointLight{{0.5f, 2.5f, 0.25f}}},
         {.name = "sun", .kind = DirectionalLight{{-0.4f, -0.8f, -0.5f}}},
         {.name = "ceiling",
          .kind =
              RectLight{.center = {0, 2.9375f, 0}, .half_u = {0.5f, 0, 0}, .half_v = {0, 0, 0.5f}, .emits = Emits::in_front}}});
    scene.views = {{.name = "view", .eye = {1.75f, 2, 1.8125f}, .target = {-0.75f, 1.25f, -1}, .fov_y_degrees = 62},
                   {.name = "up", .eye = {1.5f, 0.375f, 1.5f}, .target = {-0.5f, 2.25f, -0.75f}, .fov_y_degrees = 62}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(closed_room, ClosedRoom,
             {.title = "Closed room",
              .summary = "An empty room that no light leaves, of one reflectance; how much it sends on is known on paper."})
