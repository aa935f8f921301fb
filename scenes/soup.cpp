// Random triangles in the air: no mesh to speak of, every edge open, any two may cut each other. What survives this needs no
// closed casters. They fill a box of 16 x 3 x 16 m from y = 0.2 up.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class Soup final : public SceneGenerator {
  Number<int> count{this, "count", 1000, {.min = 1, .max = 10000000, .log = true}, Stage::build, "Number of triangles."};
  Number<double> size{
      this, "size", 0.45, {.unit = "m", .min = 0.001, .max = 2.5, .log = true}, Stage::build, "Mean length of the edges."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses the triangles."};
  Flag ground{this, "ground", true, Stage::build, "Whether a ground lies below the triangles."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    if (ground) scene.meshes.push_back(painted(tessellate(ground_plane(10), default_segments, "ground"), {0.7f, 0.7f, 0.66f}));

    Mesh soup;
    soup.name = "soup";
    soup.albedo = {0.6f, 0.35f, 0.18f};
    Random random(static_cast<std::uint64_t>(seed));
    for (int i = 0; i < count; ++i) {
      const Triangle triangle = random_triangle(random);
      const auto first = static_cast<std::uint32_t>(soup.positions.size());
      soup.positions.insert(soup.positions.end(), std::begin(triangle.points), std::end(triangle.points));
      soup.triangles.emplace_back(first, first + 1, first + 2);
    }
    finish(soup);
    scene.meshes.push_back(std::move(soup));

    scene.lights = shining_at({0, 0.8f, 0}, {{.name = "point", .kind = PointLight{{2, 10, 1}}},
                                             {.name = "sun", .kind = DirectionalLight{{1, -1.2f, -0.5f}}}});
    scene.views = {{.name = "view", .eye = {2, 4.5f, 11}, .target = {0, 0.8f, 0}, .fov_y_degrees = 37}};
    return scene;
  }

 private:
  /// Three points of a small cube inside the big box. Two random points of a cube are 0.66 of its side apart on average, so
  /// the cube is `size` / 0.66 wide, but never higher than the box. Slivers are drawn again: they test rounding, not shadows.
  Triangle random_triangle(Random& random) const {
    const double half = std::min(size / 0.66, 3.0) / 2;
    for (;;) {
      const glm::dvec3 center = random.uniform({half - 8, 0.2 + half, half - 8}, {8 - half, 3.2 - half, 8 - half});
      glm::dvec3 p[3];
      for (glm::dvec3& corner : p) corner = center + random.uniform(glm::dvec3(-half), glm::dvec3(half));
      const double area = 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
      if (area > 0.05 * size * size) return {{glm::vec3(p[0]), glm::vec3(p[1]), glm::vec3(p[2])}};
    }
  }
};

}  // namespace

GNOMON_SCENE(soup, Soup,
             {.title = "Triangle soup",
              .summary = "Random loose triangles; brings out which techniques need closed casters and how they grow."})
