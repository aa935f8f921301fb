// Two squares that face each other, and a lamp just below the upper one: light goes back and forth between them, and leaves at
// the sides. The share that goes from one to the other, their form factor, is known in closed form (Hottel 1931): 0.19982 for
// squares as far apart as they are wide, more the closer they are.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class FacingPlates final : public SceneGenerator {
  Number<double> size{this, "size", 2, {.unit = "m", .min = 0.5, .max = 4, .log = true}, Stage::build, "Side of a plate."};
  Number<double> distance{
      this, "distance", 2, {.unit = "m", .min = 0.25, .max = 4, .log = true}, Stage::build, "From plate to plate."};
  Number<double> reflectance{
      this, "reflectance", 0.8, {.min = 0, .max = 0.95}, Stage::build, "Share of the light that the plates send on."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const float half = static_cast<float>(size / 2), height = static_cast<float>(double{distance});
    const glm::vec3 gray(static_cast<float>(double{reflectance}));
    const Plane lower{.center = {0, 0, 0}, .half_u = {0, 0, half}, .half_v = {half, 0, 0}};
    const Plane upper{.center = {0, height, 0}, .half_u = {half, 0, 0}, .half_v = {0, 0, half}};
    scene.meshes = {painted(tessellate(lower, default_segments, "lower"), gray),
                    painted(tessellate(upper, default_segments, "upper"), gray)};

    // The lamp is half as wide as a plate, and a 64th of the distance below the upper one.
    scene.lights =
        shining_at({0, 0.125f * height, 0}, {{.name = "point", .kind = PointLight{{half / 4, 0.75f * height, half / 8}}},
                                             {.name = "sun", .kind = DirectionalLight{{-0.3f, -1, -0.6f}}},
                                             {.name = "panel",
                                              .kind = RectLight{.center = {0, height * 63 / 64, 0},
                                                                .half_u = {half / 2, 0, 0},
                                                                .half_v = {0, 0, half / 2},
                                                                .emits = Emits::in_front}}});
    scene.views = {{.name = "view",
                    .eye = {0.5f * half, 0.875f * height, 2.5f * half},
                    .target = {0, 0.125f * height, 0},
                    .fov_y_degrees = 44},
                   {.name = "up",
                    .eye = {0.5f * half, 0.125f * height, 2.5f * half},
                    .target = {0, 0.875f * height, 0},
                    .fov_y_degrees = 44}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(facing_plates, FacingPlates,
             {.title = "Facing plates",
              .summary = "Two squares with a lamp between them; light goes back and forth, and form factors are known."})
