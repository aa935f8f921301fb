// Signs with slats at growing distances from the eye, each as large in the picture as the others: the nearest is 2 m away, the
// farthest `far`. What a technique loses with distance, or with coordinates far from the world's origin, shows by itself: the
// picture is the same but for the signs' shadows on each other.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>

namespace {

using namespace gnomon;

constexpr int columns = 6, rows = 4, sign_count = columns * rows, slat_count = 4;
constexpr double nearest_depth = 2;  // meters
constexpr double eye_height = 1.7;

class Signs final : public SceneGenerator {
  Number<double> far = Number<double>(this, "far", 1000, {.unit = "m", .min = 10, .max = 100000, .log = true}, Stage::build,
                                      "Depth of the farthest sign; the nearest one is 2 m away.");
  Number<double> offset = Number<double>(this, "offset", 0, {.unit = "m", .min = 0, .max = 100000}, Stage::build,
                                         "How far all is moved along x and along z, in double, before float32 rounds it.");

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const glm::dvec3 way(offset.value(), 0, offset.value()), eye = glm::dvec3(0, eye_height, 0) + way;
    scene.meshes = signs(way);
    if (offset > 0) {
      const std::size_t before = distinct_vertices(signs(glm::dvec3(0))), now = distinct_vertices(scene.meshes);
      scene.notes.push_back(fmt::format("{} of {} vertices coincide with another one since they are {} m from the origin",
                                        before - now, before, offset.value()));
    }
    scene.lights = shining_at(glm::dvec3(0, eye_height, nearest_depth) + way,
                              {{.name = "point", .kind = PointLight{eye + glm::dvec3(0.3, 0.5, -0.5)}},
                               {.name = "sun", .kind = DirectionalLight{{0.5f, -0.35f, 1}}}});
    scene.views = {{.name = "view", .eye = eye, .target = eye + glm::dvec3(0, 0, 10), .fov_y_degrees = 50}};
    return scene;
  }

 private:
  /// One mesh a sign, moved and rounded once. Its place in the picture's grid does not follow its depth.
  std::vector<Mesh> signs(const glm::dvec3& way) const {
    std::vector<Mesh> all;
    for (int k = 0; k < sign_count; ++k) {
      const double depth = nearest_depth * std::pow(far / nearest_depth, double(k) / (sign_count - 1));
      const int cell = k * 5 % sign_count;
      const glm::dvec3 middle(0.27 * (cell % columns - 0.5 * (columns - 1)), 0.225 * (cell / columns - 0.5 * (rows - 1)), 1);
      // In units of the depth, from the middle of the plate's front.
      const auto box = [&](const glm::dvec3& min, const glm::dvec3& max) {
        const glm::dvec3 from = glm::dvec3(0, eye_height, 0) + way;
        return tessellate(Box{.min = from + depth * (middle + min), .max = from + depth * (middle + max)}, default_segments,
                          "box");
      };
      std::vector<Mesh> parts{box({-0.115, -0.095, 0}, {0.115, 0.095, 0.02})};
      for (int i = 0; i < slat_count; ++i) {
        const double x = 0.055 * (i - 0.5 * (slat_count - 1));
        parts.push_back(box({x - 0.006, -0.085, -0.06}, {x + 0.006, 0.085, 0}));
      }
      all.push_back(painted(merge(parts, fmt::format("sign_{}", k)), {0.75f, 0.72f, 0.65f}));
    }
    return all;
  }

  static std::size_t distinct_vertices(const std::vector<Mesh>& meshes) {
    std::size_t count = 0;
    for (const Mesh& mesh : meshes) {
      const std::vector<std::uint32_t> first = weld(mesh.positions);
      for (std::uint32_t i = 0; i < first.size(); ++i) count += first[i] == i;
    }
    return count;
  }
};

}  // namespace

GNOMON_SCENE(
    signs, Signs,
    {.title = "Signs",
     .summary = "Signs of one size in the picture at growing distances; brings out far planes and places far from the origin."})
