// Two rows of round columns under a roof with gaps: the sun falls in between the slabs and through the columns, and the far end
// recedes, so that one picture holds shadows at every distance. A lamp hangs between the rows.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

class Colonnade final : public SceneGenerator {
  Number<int> columns{this, "columns", 8, {.min = 1, .max = 64, .log = true}, Stage::build, "Columns in each of the two rows."};
  Number<int> segments{this, "segments", 32, {.min = 8, .max = 256, .log = true}, Stage::build, "Sides of a column's shaft."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    // Columns stand every 2.4 m along x from the near end on, in rows 1.8 m to both sides of the axis.
    const double pitch = 2.4, row = 1.8, near_end = -9.6, far_end = near_end + pitch * columns;
    const auto box = [](const glm::dvec3& min, const glm::dvec3& max) {
      return tessellate(Box{.min = min, .max = max}, default_segments, "box");
    };
    std::vector<Mesh> bases, shafts, capitals, beams, slabs;
    for (int i = 0; i < columns; ++i) {
      const double x = near_end + pitch * (i + 0.5);
      for (const double z : {-row, row}) {
        bases.push_back(box({x - 0.45, 0, z - 0.45}, {x + 0.45, 0.25, z + 0.45}));
        shafts.push_back(cylinder({x, 0.25, z}, {0, 3.5, 0}, 0.32, segments, "shaft"));
        capitals.push_back(box({x - 0.42, 3.75, z - 0.42}, {x + 0.42, 4, z + 0.42}));
      }
      slabs.push_back(box({x - 0.6, 4.375, -2.6}, {x + 0.6, 4.5, 2.6}));
    }
    for (const double z : {-row, row}) beams.push_back(box({near_end, 4, z - 0.375}, {far_end, 4.375, z + 0.375}));
    const Box floor{.min = {near_end - 3, -0.25, -7}, .max = {far_end + 3, 0, 5}};

    const glm::vec3 stone(0.72f, 0.66f, 0.55f), pale(0.78f, 0.74f, 0.66f);
    scene.meshes.push_back(painted(tessellate(floor, default_segments, "floor"), {0.6f, 0.5f, 0.42f}));
    scene.meshes.push_back(painted(merge(bases, "bases"), stone));
    scene.meshes.push_back(painted(merge(shafts, "shafts"), pale));
    scene.meshes.push_back(painted(merge(capitals, "capitals"), stone));
    scene.meshes.push_back(painted(merge(beams, "beams"), pale));
    scene.meshes.push_back(painted(merge(slabs, "slabs"), {0.55f, 0.33f, 0.22f}));
    scene.lights = shining_at({-5, 1.2f, -1}, {{.name = "point", .kind = PointLight{{-5.2f, 3.2f, 0.3f}}},
                                               {.name = "sun", .kind = DirectionalLight{{0.4f, -0.8f, -0.75f}}}});
    scene.views = {{.name = "view", .eye = {-12.5f, 5.2f, -9}, .target = {-5, 1.2f, -1}, .fov_y_degrees = 42},
                   {.name = "inside", .eye = {-11, 2.1f, 0.9f}, .target = {-3, 1.5f, -0.3f}, .fov_y_degrees = 50},
                   {.name = "low", .eye = {-10.2f, 0.4f, -4.6f}, .target = {0, 0.7f, -2.8f}, .fov_y_degrees = 50}};
    return scene;
  }
};

}  // namespace

GNOMON_SCENE(colonnade, Colonnade,
             {.title = "Colonnade",
              .summary = "Round columns under a roof with gaps; brings out shadows at every distance from the eye."})
