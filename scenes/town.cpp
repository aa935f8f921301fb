// A town at its true size under the sun of an hour of the day: the blocks of a planner's model, 440 m wide. Shadows are as long
// as houses are tall at noon, and six times as long in the morning.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

constexpr int side = 10;      // plots in a row
constexpr double pitch = 44;  // meters from plot to plot: 30 of house and yard, 14 of street
constexpr double latitude_degrees = 48;

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// The way light travels at an equinox, with east along x and south along z: the sun's declination is 0, so that it moves along
/// the equator of the sky, 15 degrees an hour, and is due south at 12.
glm::dvec3 sunlight(double hour) {
  const double angle = radians(15 * (hour - 12)), latitude = radians(latitude_degrees);
  return {std::sin(angle), -std::cos(latitude) * std::cos(angle), -std::sin(latitude) * std::cos(angle)};
}

class Town final : public SceneGenerator {
  Number<double> hour{this,         "hour",
                      10,           {.unit = "h", .min = 7, .max = 17},
                      Stage::build, "Solar time of the sun at an equinox, 48 degrees north: 42 degrees high at 12, 10 at 7."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses houses and colors."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(260), default_segments, "ground"), {0.55f, 0.56f, 0.52f}));
    Random random(static_cast<std::uint64_t>(seed));
    for (int plot = 0; plot < side * side; ++plot) add_house(scene, random, plot);
    scene.lights = shining_at({0, 0, 0}, {{.name = "point", .kind = PointLight{{-60, 170, 80}}},
                                          {.name = "sun", .kind = DirectionalLight{glm::vec3(sunlight(hour))}}});
    scene.views = {{.name = "view", .eye = {0, 470, 330}, .target = {0, 0, 15}, .fov_y_degrees = 38},
                   {.name = "square", .eye = {95, 110, 120}, .target = {0, 0, 0}, .fov_y_degrees = 38}};
    return scene;
  }

 private:
  /// One house in its plot, 12 to 28 m wide each way; one in eight is a tower. One plot in ten is a square without a house.
  static void add_house(Scene& scene, Random& random, int plot) {
    const double x = pitch * (plot % side - 0.5 * side) + 7, z = pitch * (plot / side - 0.5 * side) + 7;
    const double width = random.uniform(12, 28), depth = random.uniform(12, 28);
    const double left = x + random.uniform(0, 30 - width), back = z + random.uniform(0, 30 - depth);
    const bool is_tower = random.uniform(0, 1) < 0.125, is_square = random.uniform(0, 1) < 0.1;
    const double height = is_tower ? random.uniform(35, 60) : random.uniform(6, 22);
    const double gray = random.uniform(0.45, 0.75), warmth = random.uniform(0.8, 1);
    if (is_square) return;
    const Box house{.min = {left, 0, back}, .max = {left + width, height, back + depth}};
    scene.meshes.push_back(painted(tessellate(house, default_segments, fmt::format("house_{}", plot)),
                                   {gray, gray * (0.5 + warmth / 2), gray * warmth}));
  }
};

}  // namespace

GNOMON_SCENE(town, Town,
             {.title = "Town",
              .summary = "Houses and towers of a town 440 m wide, under the sun of an hour; for errors in meters."})
