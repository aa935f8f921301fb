// The Cornell box: the measured room of Goral, Torrance, Greenberg and Battaile 1984, ten times its size (5.5 m), with the
// published corners of its two turned blocks and of its lamp. The front is open; the sun falls in through it, the point light
// hangs below the ceiling.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class CornellBox final : public SceneGenerator {
 public:
  Scene make() const override {
    // As renderers commonly have them, made from the measured spectra.
    const glm::vec3 white(0.725f, 0.71f, 0.68f), red(0.63f, 0.065f, 0.05f), green(0.14f, 0.45f, 0.091f);
    Scene scene;
    scene.name = id();
    // Half the width, height and depth of the room; each wall is a one-sided sheet that faces the inside.
    const float w = 2.75f, h = 2.75f, d = 2.8f;
    const auto add_wall = [&](const Plane& plane, const char* name, const glm::vec3& albedo) {
      scene.meshes.push_back(painted(tessellate(plane, default_segments, name), albedo));
    };
    add_wall({.center = {w, 0, d}, .half_u = {0, 0, d}, .half_v = {w, 0, 0}}, "floor", white);
    add_wall({.center = {w, 2 * h, d}, .half_u = {w, 0, 0}, .half_v = {0, 0, d}}, "ceiling", white);
    add_wall({.center = {w, h, 2 * d}, .half_u = {0, h, 0}, .half_v = {w, 0, 0}}, "back_wall", white);
    add_wall({.center = {2 * w, h, d}, .half_u = {0, 0, d}, .half_v = {0, h, 0}}, "left_wall", red);
    add_wall({.center = {0, h, d}, .half_u = {0, h, 0}, .half_v = {0, 0, d}}, "right_wall", green);

    const glm::dvec3 short_block[] = {{1.3, 0, 0.65}, {0.82, 0, 2.25}, {2.4, 0, 2.72}, {2.9, 0, 1.14}};
    const glm::dvec3 tall_block[] = {{4.23, 0, 2.47}, {2.65, 0, 2.96}, {3.14, 0, 4.56}, {4.72, 0, 4.06}};
    scene.meshes.push_back(painted(prism(short_block, {0, 1.65, 0}, "short_block"), white));
    scene.meshes.push_back(painted(prism(tall_block, {0, 3.3, 0}, "tall_block"), white));

    scene.lights = shining_at({2.75f, 1.5f, 2.8f}, {{.name = "point", .kind = PointLight{{2.78f, 5.2f, 2.5f}}},
                                                    {.name = "sun", .kind = DirectionalLight{{-0.4f, -0.5f, 1}}},
                                                    // The published lamp: 1.3 x 1.05 m, 1.2 cm below the ceiling.
                                                    {.name = "ceiling",
                                                     .kind = RectLight{.center = {2.78f, 5.488f, 2.795f},
                                                                       .half_u = {0.65f, 0, 0},
                                                                       .half_v = {0, 0, 0.525f},
                                                                       .emits = Emits::in_front}}});
    scene.views = {{.name = "view", .eye = {2.75f, 4.4f, -3.2f}, .target = {2.75f, 1.5f, 2.8f}, .fov_y_degrees = 42},
                   {.name = "front", .eye = {2.78f, 2.73f, -8}, .target = {2.78f, 2.73f, 2.8f}, .fov_y_degrees = 39.3f}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(cornell_box, CornellBox,
             {.title = "Cornell box",
              .summary = "The classic room with two turned blocks; brings out light leaks where walls and blocks meet."})
