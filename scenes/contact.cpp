// A table top of things that touch: thin slabs lying and hovering, wires thinner than a texel, stacked boxes, a ball against a
// box, a card against a wall. Every bias shows here: too little speckles, too much loosens a shadow from what casts it. Sizes
// that meet are sums of powers of two, so that what should touch does so exactly in float32.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

class Contact final : public SceneGenerator {
  Number<double> thickness{this,         "thickness",      0.005, {.unit = "m", .min = 0.0005, .max = 0.05, .log = true},
                           Stage::build, "Slab thickness."};
  Number<double> gap{
      this, "gap", 0.002, {.unit = "m", .min = 0, .max = 0.05}, Stage::build, "From the floor up to the hovering slab."};
  Number<double> wire{this,         "wire",           0.008, {.unit = "m", .min = 0.0005, .max = 0.03, .log = true},
                      Stage::build, "Wire thickness."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const auto add = [&](Mesh mesh, const glm::vec3& albedo) { scene.meshes.push_back(painted(std::move(mesh), albedo)); };
    const auto add_shape = [&](const Shape& shape, const char* name, const glm::vec3& albedo) {
      add(tessellate(shape, default_segments, name), albedo);
    };
    const glm::vec3 plaster(0.72f, 0.7f, 0.66f), metal(0.25f, 0.27f, 0.3f), blue(0.15f, 0.3f, 0.55f), wood(0.6f, 0.4f, 0.22f);
    add_shape(ground_plane(2), "floor", {0.66f, 0.64f, 0.6f});
    add_shape(Box{.min = {-2, 0, -0.625f}, .max = {2, 0.75f, -0.5f}}, "wall", plaster);

    const double slab = thickness, hover = gap;
    add_shape(Box{.min = {-0.75, 0, 0.2}, .max = {-0.4, slab, 0.5}}, "slab_lying", blue);
    add_shape(Box{.min = {-0.3, hover, 0.25}, .max = {0.05, hover + slab, 0.55}}, "slab_hovering", blue);

    // A gate of two standing wires with a third across their tops, and a fourth in front on the floor.
    const double d = wire, r = d / 2, top = 0.3125;
    for (const auto& [name, x] : {std::pair{"wire_left", 0.2}, std::pair{"wire_right", 0.6}})
      add(cylinder({x, 0, 0.3}, {0, top, 0}, r, 16, name), metal);
    add_shape(Box{.min = {0.15, top, 0.3 - r}, .max = {0.65, top + d, 0.3 + r}}, "wire_across", metal);
    add_shape(Box{.min = {0.15, 0, 0.6}, .max = {0.9, d, 0.6 + d}}, "wire_lying", metal);

    // The ball touches the floor and the side of the lower box; the upper box is turned by 30 degrees.
    add_shape(Box{.min = {0.375f, 0, -0.3125f}, .max = {0.8125f, 0.25f, 0.0625f}}, "box_lower", wood);
    std::vector<glm::dvec3> corners;
    for (int k = 0; k < 4; ++k) {
      const double angle = (std::numbers::pi / 6) + (std::numbers::pi / 2) * k;
      corners.emplace_back(0.6 + 0.15 * std::sin(angle), 0.25, -0.125 + 0.15 * std::cos(angle));
    }
    add(prism(corners, {0, 0.1875, 0}, "box_upper"), {0.68f, 0.52f, 0.3f});
    add_shape(Sphere{.center = {0.21875f, 0.15625f, -0.125f}, .radius = 0.15625f}, "ball", {0.68f, 0.2f, 0.12f});

    add_shape(Plane{.center = {-0.5f, 0.21875f, -0.40625f}, .half_u = {0.25f, 0, 0}, .half_v = {0, 0.21875f, -0.09375f}},
              "card", {0.75f, 0.62f, 0.2f});

    scene.lights = shining_at(
        {0.18f, 0.08f, 0.05f},
        {{.name = "point", .kind = PointLight{{-1.3f, 0.8f, 0.35f}}},
         {.name = "sun", .kind = DirectionalLight{{1, -0.55f, -0.3f}}},
         {.name = "lamp", .kind = DiscLight{.center = {-1.3f, 0.8f, 0.35f}, .normal = {1.5f, -0.75f, -0.3f}, .radius = 0.08f}},
         {.name = "tube",
          .kind = RectLight{.center = {0.2f, 1.2f, 0.9f}, .half_u = {0.3f, 0, 0}, .half_v = {0, 0.015f, 0.0125f}}}});
    scene.views = {{.name = "view", .eye = {0.2f, 0.95f, 1.8f}, .target = {0.18f, 0.08f, 0.05f}, .fov_y_degrees = 38},
                   {.name = "close", .eye = {-0.1f, 0.12f, 1}, .target = {-0.1f, 0.02f, 0.4f}, .fov_y_degrees = 36}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(contact, Contact,
             {.title = "Contact",
              .summary = "Thin slabs, wires, touching boxes and a leaning card; brings out what bias costs."})
