// Writes a generated scene for POV-Ray, whose picture is then a shadow mask: white where the light reaches the surface, black
// in shadow, on surfaces turned away and on the background. A renderer that shares no code with ours is the witness.
//
// usage: export_pov SCENE LIGHT WIDTH HEIGHT SCALE > scene.pov
// First view of the scene; LIGHT is the name of a point or directional light. Everything is multiplied by SCALE, because
// POV-Ray ignores blockers nearer than a fixed 1e-3 units to the lit point: that is 1e-3 / SCALE meters.
#include <fmt/format.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

extern "C" void gnomon_roll_call(gnomon::Registry& registry);

namespace {

using namespace gnomon;

int number(const char* text, const char* what) {
  int value = 0;
  const char* end = text + std::strlen(text);
  if (std::from_chars(text, end, value).ptr != end || value < 1)
    throw Error("{} = {} is not a whole number above 0", what, text);
  return value;
}

class Writer {
 public:
  explicit Writer(double scale) : scale_(scale) {}

  /// Everything is white and so bright that the least light saturates a pixel; nothing glows by itself.
  void header() const {
    fmt::print(
        "#version 3.7;\n"
        "global_settings {{ assumed_gamma 1 }}\n"
        "background {{ rgb 0 }}\n"
        "#default {{ texture {{ pigment {{ rgb 1 }} finish {{ ambient 0 emission 0 diffuse 1 }} }} }}\n");
  }

  /// POV-Ray sends the ray of image coordinates (s, t), each from -1/2 to 1/2, along direction + s * right + t * up, and keeps
  /// these three vectors as they are when no look_at is given: no mirror, although its own world is left-handed.
  void camera(const View& view, int width, int height) const {
    const glm::dvec3 eye(view.eye), forward = glm::normalize(glm::dvec3(view.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(view.up))), up = glm::cross(right, forward);
    const double half_height = std::tan(0.5 * glm::radians(static_cast<double>(view.fov_y_degrees)));
    fmt::print("camera {{ perspective location {} right {} up {} direction {} }}\n", point(eye),
               plain(right * (2 * half_height * width / height)), plain(up * (2 * half_height)), plain(forward));
  }

  void light(const Light& light, const Bounds& bounds) const {
    const glm::dvec4 source = homogeneous(light);
    if (has_area(light) || kind_name(light) == "spot")
      throw Error("light {} is a {} light; a mask needs a point or directional light", light.name, kind_name(light));
    if (source.w != 0) {
      fmt::print("light_source {{ {} rgb 1e9 }}\n", point(glm::dvec3(source)));
      return;
    }
    // A parallel light shines from its plane on, so that must lie outside the scene.
    const glm::dvec3 middle = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max)), to_light(source);
    const double far = 10 * glm::distance(bounds.min, bounds.max) / glm::length(to_light);
    fmt::print("light_source {{ {} rgb 1e9 parallel point_at {} }}\n", point(middle + far * to_light), point(middle));
  }

  /// Loose triangles, because POV-Ray keeps them in double, but the triangles of a mesh2 in float.
  void mesh(const Mesh& mesh) const {
    const char* casts = mesh.casts ? "" : " no_shadow";
    if (mesh.shape && std::holds_alternative<Sphere>(*mesh.shape)) {
      const auto& sphere = std::get<Sphere>(*mesh.shape);
      fmt::print("sphere {{ {}, {:.17g}{} }}\n", point(sphere.center), scale_ * sphere.radius, casts);
      return;
    }
    if (mesh.has_curved_shape())
      throw Error("mesh {} is a {}; of curved shapes only spheres are exported", mesh.name, kind_name(*mesh.shape));
    for (const glm::uvec3& t : mesh.triangles)
      fmt::print("triangle {{ {}, {}, {}{} }}\n", point(mesh.positions[t.x]), point(mesh.positions[t.y]),
                 point(mesh.positions[t.z]), casts);
  }

 private:
  static std::string plain(const glm::dvec3& v) { return fmt::format("<{:.17g}, {:.17g}, {:.17g}>", v.x, v.y, v.z); }
  std::string point(const glm::dvec3& p) const { return plain(scale_ * p); }

  double scale_;
};

void run(char** arguments) {
  gnomon_roll_call(registry());
  const SceneEntry* entry = registry().find_scene(arguments[1]);
  if (!entry) throw Error("scene = {} is not a generated scene", arguments[1]);
  const Scene scene = entry->make()->make();
  const auto light = std::ranges::find(scene.lights, std::string_view(arguments[2]), &Light::name);
  if (light == scene.lights.end()) throw Error("scene {} has no light {}", scene.name, arguments[2]);

  const Writer writer(number(arguments[5], "scale"));
  writer.header();
  writer.camera(scene.views.front(), number(arguments[3], "width"), number(arguments[4], "height"));
  writer.light(*light, scene.bounds());
  for (const Mesh& mesh : scene.meshes) writer.mesh(mesh);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    fmt::print(stderr, "usage: export_pov SCENE LIGHT WIDTH HEIGHT SCALE > scene.pov\n");
    return 2;
  }
  try {
    run(argv);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "export_pov: {}\n", error.what());
    return 2;
  }
}
