// One straight edge above a level ground, seen straight from above: a penumbra that is as wide as asked for, in pixels, over
// all of the picture. Noise, blur and ghosts are then measured against a width that is known.
//
// A slab has its upper edge along z, at x = 0 and half as high as the lights. The line from (x, 0, z) on the ground through the
// edge arrives at -x at the height of the lights, so a light that is level and spans x = c - r .. c + r is hidden left of -x:
// the penumbra is x = -c - r .. -c + r, as wide as the light, at every z and whatever the light's extent in z. With S the share
// that is seen, of the area, and s = (x + c) / r:
//   rect  S = 1/2 + s/2                                 disc  S = 1/2 + (asin s + s sqrt(1 - s^2)) / pi
// The picture's plane is parallel to the ground, so a pixel covers the same square of the ground everywhere: of 360 rows that
// show 3.6 m each has 1 cm, and r is half a centimeter for a pixel of width.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>

namespace {

using namespace gnomon;

class StraightPenumbra final : public SceneGenerator {
  Number<double> width_px{this,         "width_px",
                          24,           {.unit = "px", .min = 4, .max = 96, .log = true},
                          Stage::build, "Width of the penumbra in a picture of 360 rows; in others it is in proportion."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(6), default_segments, "ground"), {0.6f, 0.58f, 0.52f}));
    const Box slab{.min = {-6, edge_height - 0.25f, -6}, .max = {0, edge_height, 6}};
    scene.meshes.push_back(painted(tessellate(slab, default_segments, "slab"), {0.62f, 0.4f, 0.2f}));

    // Far off along the edge, which changes no share: a light that goes sideways, seen from the middle, then crosses the edge.
    // By `light_jump` it goes 0.334 m in x, and the penumbra goes as far the other way: 33 pixels of 360 rows.
    const glm::vec3 lamp(-shadow_x, 2 * edge_height, 6);
    const double radius = 0.5 * meters_per_pixel * width_px;
    scene.lights = shining_at(
        {shadow_x, 0, 0},
        {{.name = "point", .kind = PointLight{lamp}},
         {.name = "sun", .kind = DirectionalLight{{shadow_x, -edge_height, -1.5f}}},
         {.name = "panel", .kind = level_square(lamp, 2 * radius)},
         {.name = "lamp", .kind = DiscLight{.center = lamp, .normal = {0, -1, 0}, .radius = static_cast<float>(radius)}}});
    const double half_angle = std::atan(0.5 * default_rows * meters_per_pixel / eye_height);
    scene.views = {{.name = "view",
                    .eye = {shadow_x, eye_height, 0},
                    .target = {shadow_x, 0, 0},
                    .up = {0, 0, -1},
                    .fov_y_degrees = static_cast<float>(glm::degrees(2 * half_angle))}};
    return scene;
  }

 private:
  static constexpr float edge_height = 2, eye_height = 6;
  static constexpr float shadow_x = 1;  ///< where the middle of the penumbra is, 1 1/2 m right of where the eye sees the edge
  static constexpr double meters_per_pixel = 0.01, default_rows = 360;
};

}  // namespace

GNOMON_SCENE(
    straight_penumbra, StraightPenumbra,
    {.title = "Straight penumbra",
     .summary = "One straight edge, seen from above, with a penumbra of known width in pixels; brings out noise, blur and "
                "ghosts."})
