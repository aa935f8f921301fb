// Boxes of different heights on a ground, like the blocks of a town. Each is its own closed mesh with an exact box; they stand
// on the ground (contact is the normal case) and do not touch one another.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace {

using namespace gnomon;

class BoxCity final : public SceneGenerator {
  Number<int> count{this, "count", 200, {.min = 1, .max = 10000, .log = true}, Stage::build, "Number of boxes."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses plots, sizes and colors."};
  Number<double> panel{
      this, "panel", 2, {.unit = "m", .min = 0.001, .max = 100, .log = true}, Stage::build, "Side of the square light panel."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(11), default_segments, "ground"), {0.55f, 0.55f, 0.52f}));

    // A tenth of the plots stays empty: squares for the light to fall on. Which ones is a shuffle (Fisher and Yates).
    Random random(static_cast<std::uint64_t>(seed));
    const int side = static_cast<int>(std::ceil(std::sqrt(1.1 * count)));
    std::vector<int> plots(static_cast<std::size_t>(side) * side);
    std::iota(plots.begin(), plots.end(), 0);
    for (std::size_t i = plots.size() - 1; i > 0; --i)
      std::swap(plots[i], plots[random.below(static_cast<std::uint32_t>(i + 1))]);

    const double plot_width = std::min(4.0, 20.0 / side);
    for (int i = 0; i < count; ++i) {
      const double x = plot_width * (plots[i] % side - 0.5 * side), z = plot_width * (plots[i] / side - 0.5 * side);
      // A box takes 45 to 75 percent of its plot each way and keeps 5 percent from the plot's border.
      const auto extent = [&](double start) {
        const double width = random.uniform(0.45, 0.75), offset = random.uniform(0.05, 0.95 - width);
        return std::pair{start + plot_width * offset, start + plot_width * (offset + width)};
      };
      const auto [min_x, max_x] = extent(x);
      const auto [min_z, max_z] = extent(z);
      // Squared, so that most are low and a few are towers.
      const double tall = random.uniform(0, 1), height = plot_width * (0.3 + 1.7 * tall * tall);
      const double gray = random.uniform(0.35, 0.75), green = random.uniform(0.85, 0.98), blue = random.uniform(0.65, 0.95);
      const glm::vec3 albedo(gray, gray * green, gray * blue);
      const Box box{.min = {min_x, 0, min_z}, .max = {max_x, height, max_z}};
      scene.meshes.push_back(painted(tessellate(box, default_segments, fmt::format("box_{}", i)), albedo));
    }
    scene.lights = shining_at({0, 0, 0.5f}, {{.name = "point", .kind = PointLight{{-7, 10, 5}}},
                                             {.name = "sun", .kind = DirectionalLight{{1, -1.1f, -0.6f}}},
                                             {.name = "panel", .kind = level_square({-7, 10, 5}, panel)}});
    scene.views = {{.name = "view", .eye = {2, 9, 14}, .target = {0, 0, 0.5f}, .fov_y_degrees = 38},
                   {.name = "above", .eye = {0.5f, 24, 7}, .target = {0, 0, 0}, .fov_y_degrees = 32}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(box_city, BoxCity,
             {.title = "Box city",
              .summary = "Boxes standing on a ground; brings out contact and many separate closed casters."})
