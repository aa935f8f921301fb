// A picket fence in a low sun: long parallel stripes of shadow, thinner than a texel in the distance. The fence is always about
// 8 m long; narrower pickets and gaps mean more of them.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <cmath>

namespace {

using namespace gnomon;

class Fence final : public SceneGenerator {
  Number<double> width{
      this, "width", 0.1, {.unit = "m", .min = 0.01, .max = 0.5, .log = true}, Stage::build, "Width of a picket."};
  Number<double> spacing{
      this, "spacing", 0.1, {.unit = "m", .min = 0.01, .max = 0.5, .log = true}, Stage::build, "Gap between pickets."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const double pitch = width + spacing;
    const int picket_count = static_cast<int>(std::floor((8 + spacing) / pitch));
    const double left = -0.5 * (picket_count * pitch - spacing);

    // Pickets: boards 2 cm thick with a pointed top, in front of two rails that they touch.
    std::vector<Mesh> pickets;
    for (int i = 0; i < picket_count; ++i) {
      const double x = left + i * pitch;
      const glm::dvec3 outline[] = {
          {x, 0.06, 0}, {x + width, 0.06, 0}, {x + width, 1.1, 0}, {x + width / 2, 1.2, 0}, {x, 1.1, 0}};
      pickets.push_back(prism(outline, {0, 0, 0.02}, "picket"));
    }
    const auto box = [](glm::dvec3 min, glm::dvec3 max, std::string name) {
      return tessellate(Box{.min = min, .max = max}, default_segments, std::move(name));
    };
    const auto right = -left;
    const Mesh rails[] = {box({left, 0.3, -0.04}, {right, 0.38, 0}, "rail"),
                          box({left, 0.86, -0.04}, {right, 0.94, 0}, "rail")};
    const Mesh posts[] = {box({left + 0.2, 0, -0.12}, {left + 0.3, 1.05, -0.04}, "post"),
                          box({-0.05, 0, -0.12}, {0.05, 1.05, -0.04}, "post"),
                          box({right - 0.3, 0, -0.12}, {right - 0.2, 1.05, -0.04}, "post")};

    scene.meshes.push_back(painted(tessellate(ground_plane(9), default_segments, "ground"), {0.42f, 0.55f, 0.28f}));
    scene.meshes.push_back(painted(merge(pickets, "pickets"), {0.8f, 0.78f, 0.72f}));
    scene.meshes.push_back(painted(merge(rails, "rails"), {0.6f, 0.45f, 0.3f}));
    scene.meshes.push_back(painted(merge(posts, "posts"), {0.45f, 0.3f, 0.2f}));
    scene.lights = shining_at({0.2f, 0.2f, 0.6f},
                              {{.name = "point", .kind = PointLight{{-1.5f, 2.6f, -3.5f}}},
                               {.name = "sun", .kind = DirectionalLight{{0.45f, -0.5f, 1}}},
                               {.name = "globe", .kind = SphereLight{.center = {-1.5f, 2.6f, -3.5f}, .radius = 0.15f}},
                               {.name = "soft_sun", .kind = SphereLight{.center = {-22.5f, 25, -50}, .radius = 0.2804f}}});
    scene.views = {{.name = "view", .eye = {2.6f, 2.1f, 5}, .target = {0.2f, 0.2f, 0.6f}, .fov_y_degrees = 40},
                   {.name = "low", .eye = {-4.6f, 0.16f, 1.5f}, .target = {4, 0.1f, 0.7f}, .fov_y_degrees = 40}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(fence, Fence,
             {.title = "Picket fence", .summary = "A picket fence in a low sun; brings out aliasing of thin parallel shadows."})
