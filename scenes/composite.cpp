// The experiment of Pljaskovic et al., Sphere and cone composite realtime shadows: the plane y = 0, an object over its origin,
// and a point light that moves along X and Y. Letters of the paper: the light stands at (x_i, y_i, z_i), the object d over the
// plane, r is the radius of circle, sphere and cone and half the triangle's base, h_p the height of triangle and cone. As
// there, d reaches up to the circle's center, the middle of the triangle's and the cone's base, and the center of the sphere.
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

class Composite final : public SceneGenerator {
  Choice object{this,         "object",
                "all",        {"all", "circle", "triangle", "sphere", "cone"},
                Stage::build, "What is over the origin; all: the four side by side along z, the circle at the least z."};
  Number<double> light_x{this, "light_x", 4, {.unit = "m", .min = -20, .max = 20}, Stage::build, "The point light's x (x_i)."};
  Number<double> light_y{this,
                         "light_y",
                         9,
                         {.unit = "m", .min = 0.5, .max = 100, .log = true},
                         Stage::build,
                         "The point light's height over the ground (y_i)."};
  Number<double> light_z{this, "light_z", 0, {.unit = "m", .min = -20, .max = 20}, Stage::build, "The point light's z (z_i)."};
  Number<double> distance{this,
                          "distance",
                          2,
                          {.unit = "m", .min = 0, .max = 10},
                          Stage::build,
                          "From the ground up to the base, or to the center of circle and sphere (d)."};
  Number<double> radius{this,
                        "radius",
                        1,
                        {.unit = "m", .min = 0.05, .max = 5, .log = true},
                        Stage::build,
                        "Radius of circle, sphere and cone, half the triangle's base (r)."};
  Number<double> height{this,
                        "height",
                        2,
                        {.unit = "m", .min = 0.05, .max = 10, .log = true},
                        Stage::build,
                        "From the base of triangle and cone up to the peak (h_p)."};
  Choice base{this, "base", "z", {"x", "z"}, Stage::build, "The axis that the triangle's base is parallel to."};
  Number<double> tilt{
      this, "tilt", 0, {.unit = "degree", .min = -90, .max = 90}, Stage::build, "Turns the circle's normal from +y toward +x."};
  Number<int> segments{
      this, "segments", default_segments, {.min = 4, .max = 256, .log = true}, Stage::build, "Edges around whatever is round."};

 public:
  Scene make() const override {
    static constexpr const char* kinds[] = {"circle", "triangle", "sphere", "cone"};
    static constexpr glm::vec3 albedos[] = {
        {0.2f, 0.36f, 0.6f}, {0.75f, 0.55f, 0.15f}, {0.7f, 0.22f, 0.12f}, {0.25f, 0.5f, 0.25f}};
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(24), default_segments, "ground"), {0.7f, 0.7f, 0.66f}));
    const glm::vec3 light(light_x.value(), light_y.value(), light_z.value());
    const bool is_alone = !object.is("all");
    for (int k = 0; k < 4; ++k) {
      if (is_alone && !object.is(kinds[k])) continue;
      const Shape shape = make_shape(kinds[k], is_alone ? 0 : (k - 1.5) * (2 * radius + 1.5));
      if (const std::string why = PlanarShadow::objection(shape, {light, 1}, {0, 1, 0, 0}, ShadowForm::exact); !why.empty())
        throw Error("{}.light_x, light_y, light_z = {}, {}, {} m: {}, and must stay outside every object", id(),
                    light_x.value(), light_y.value(), light_z.value(), why);
      scene.meshes.push_back(painted(tessellate(shape, segments, kinds[k]), albedos[k]));
    }
    scene.lights = shining_at(
        {-1, 1.65f, 0}, {{.name = "point", .kind = PointLight{light}}, {.name = "sun", .kind = DirectionalLight{-light}}});
    // Of one object, `shadow` shows all of the shadow and hides none of it: seen from far along z and low, the object covers
    // ground beyond its shadow. From so far pixels hold nearly the same area everywhere. Of four objects it is a plan, with x
    // upward.
    if (is_alone)
      scene.views = {{.name = "view", .eye = {-6.5f, 5.5f, 9}, .target = {-1, 1.65f, 0}, .fov_y_degrees = 34},
                     {.name = "shadow", .eye = {0, 38, 80}, .target = {0, 0, 0}, .fov_y_degrees = 9.5f}};
    else
      scene.views = {
          {.name = "view", .eye = {-16, 8, 4}, .target = {-1.5f, 1.1f, 1.3f}, .fov_y_degrees = 36},
          {.name = "shadow", .eye = {0, 60, 1.25f}, .target = {0, 0, 1.25f}, .up = {1, 0, 0}, .fov_y_degrees = 13.5f}};
    return scene;
  }

 private:
  Shape make_shape(std::string_view kind, double z) const {
    const auto r = static_cast<float>(radius);
    const glm::dvec3 at(0, distance.value(), z);
    if (kind == "circle") {
      const double angle = tilt * std::numbers::pi / 180;
      return Disc{.center = at, .normal = {std::sin(angle), std::cos(angle), 0}, .radius = r};
    }
    if (kind == "sphere") return Sphere{.center = at, .radius = r};
    if (kind == "cone") return Cone{.base = at, .radius = r, .height = static_cast<float>(height)};
    const glm::dvec3 half = radius.value() * (base.is("x") ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, -1));
    return Triangle{{at - half, at + half, at + glm::dvec3(0, height.value(), 0)}};
  }
};

}  // namespace

GNOMON_SCENE(
    composite, Composite,
    {.title = "Composite",
     .summary = "Circle, triangle, sphere and cone over a plane; brings out what shadow formulas are worth as the light moves.",
     .is_default = true,
     // The letters of the paper's program.
     .keys = {{'K', "object", "circle", "Shadowed object: circle."},
              {'L', "object", "triangle", "Shadowed object: triangle."},
              {'T', "object", "sphere", "Shadowed object: sphere."},
              {'U', "object", "cone", "Shadowed object: cone."}}})
