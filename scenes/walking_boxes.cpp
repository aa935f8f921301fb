// Boxes walk over a ground between columns that stand still. Each goes around a square of 1 m in its plot, and every third one
// turns once on its way. Of many small triangles (`detail`) and with a part of the boxes standing (`walking`) the scene shows
// what a share that moves costs. Places are whole eighths of a meter, so that positions of float32 are exact at whole
// sixteenths of a second where nothing turns.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace {

using namespace gnomon;

class WalkingBoxes final : public SceneGenerator {
  Number<int> count{
      this, "count", 12, {.min = 1, .max = 256, .log = true}, Stage::build, "Number of boxes; each has a plot of 2 m."};
  Number<double> walking{this,
                         "walking",
                         1,
                         {.min = 0.001, .max = 1},
                         Stage::build,
                         "Share of the boxes that walk, at least one; the others stand."};
  Number<int> detail{this,
                     "detail",
                     1,
                     {.min = 1, .max = 64, .log = true},
                     Stage::build,
                     "Squares along each edge of a box: 12 detail^2 triangles, without an exact shape from 2 on."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const int side = static_cast<int>(std::ceil(std::sqrt(count.value())));
    const float half = static_cast<float>(side);  // of all plots, in meters
    scene.meshes.push_back(painted(tessellate(ground_plane(half + 4), default_segments, "ground"), {0.6f, 0.58f, 0.52f}));
    std::vector<Mesh> columns;
    for (int i = 0; i <= side; ++i)
      for (int j = 0; j <= side; ++j)
        columns.push_back(cylinder({2 * i - side, 0, 2 * j - side}, {0, 2, 0}, 0.125, 24, "column"));
    scene.meshes.push_back(painted(merge(columns, "columns"), {0.72f, 0.7f, 0.64f}));

    auto motion = std::make_shared<Motion>();
    motion->animations = {{"walk", {}}};
    for (int i = 0; i < count; ++i) {
      const glm::dvec3 middle(2 * (i % side) + 1 - side, 0, 2 * (i / side) + 1 - side);
      const glm::dvec3 start = middle + corner(i, 0);
      const float height = 0.5f + 0.125f * static_cast<float>(i * 5 % 7);
      const Box box{.min = start - glm::dvec3(0.25, 0, 0.25), .max = start + glm::dvec3(0.25, height, 0.25)};
      const float green = 0.3f + 0.05f * static_cast<float>(i % 5);
      scene.meshes.push_back(painted(triangles(box, fmt::format("box_{}", i + 1)), {0.62f, green, 0.2f}));
      if (walks(i)) add_walk(i, start, scene, *motion);
    }
    scene.motion = std::move(motion);

    scene.lights =
        shining_at({0, 0, 0}, {{.name = "point", .kind = PointLight{{-0.6f * half, 1.5f * half + 1, 0.4f * half}}},
                               {.name = "sun", .kind = DirectionalLight{{0.7f, -1, -0.4f}}},
                               {.name = "panel", .kind = level_square({-0.6f * half, 1.5f * half + 1, 0.4f * half}, 0.5)}});
    scene.views = {
        {.name = "view", .eye = {0.5f * half, 1.6f * half + 1, 2.6f * half + 1}, .target = {0, 0.2f, 0}, .fov_y_degrees = 40},
        {.name = "low", .eye = {0.3f, 1, half + 2.5f}, .target = {0, 0.6f, 0}, .fov_y_degrees = 50}};
    return scene;
  }

 private:
  static constexpr int leg_count = 4;         ///< of a walk
  static constexpr double leg_seconds = 0.5;  ///< a leg is 1 m: 2 m/s

  /// Those that walk are spread evenly among all.
  bool walks(int i) const {
    const double share = std::max(walking.value(), 1.0 / count);
    return std::floor((i + 1) * share + 0.5) > std::floor(i * share + 0.5);
  }

  Mesh triangles(const Box& box, std::string name) const {
    if (detail == 1) return tessellate(box, default_segments, std::move(name));
    Mesh mesh;
    mesh.name = std::move(name);
    for (const int axis : {0, 1, 2})
      for (const bool is_far : {false, true}) add_side(box, axis, is_far, mesh);
    finish(mesh);
    return mesh;
  }

  /// The side of a box that is at its least or greatest coordinate on an axis. Neighbors have the same points on their edge.
  void add_side(const Box& box, int axis, bool is_far, Mesh& mesh) const {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const auto n = static_cast<std::uint32_t>(detail.value()), first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto along = [&](int i, std::uint32_t k) { return std::lerp(double(box.min[i]), double(box.max[i]), double(k) / n); };
    for (std::uint32_t j = 0; j <= n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i) {
        glm::dvec3 point;
        point[axis] = (is_far ? box.max : box.min)[axis];
        point[b] = along(b, i);
        point[c] = along(c, j);
        mesh.positions.emplace_back(point);
      }
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t corner = first + j * (n + 1) + i;
        // Counter-clockwise seen from outside: b, c and the axis are right-handed.
        const std::uint32_t right = corner + (is_far ? 1 : n + 1), left = corner + (is_far ? n + 1 : 1);
        mesh.triangles.emplace_back(corner, right, corner + n + 2);
        mesh.triangles.emplace_back(corner, corner + n + 2, left);
      }
  }

  /// Where box i is after so many legs, from the middle of its plot. Boxes start at all four corners and go around both ways.
  static glm::dvec3 corner(int i, int legs) {
    const int at = (i + (i / 4 % 2 == 0 ? legs : leg_count - legs)) % leg_count;
    return {at == 0 || at == 3 ? -0.5 : 0.5, 0, at < 2 ? -0.5 : 0.5};
  }

  /// A box that turns has two nodes: the outer one is at its start, turns and moves, the inner one goes back by the start.
  static void add_walk(int i, const glm::dvec3& start, const Scene& scene, Motion& motion) {
    using Property = Track::Property;
    const bool turns = i % 3 == 2;
    const auto outer = static_cast<std::uint32_t>(motion.nodes.size());
    Track way{outer, Property::translation, Track::Interpolation::linear, {}, {}};
    Track turn{outer, Property::rotation, Track::Interpolation::linear, {}, {}};
    // Sines of 0, 45, 90, 135 and 180 degrees: halves of quarter turns about y.
    const double h = std::sqrt(0.5), sines[] = {0, h, 1, h, 0}, cosines[] = {1, h, 0, -h, -1};
    for (int k = 0; k <= leg_count; ++k) {
      const glm::dvec3 offset = corner(i, k) - corner(i, 0) + (turns ? start : glm::dvec3(0));
      for (Track* const track : {&way, &turn}) track->times.push_back(leg_seconds * k);
      for (const double value : {offset.x, offset.y, offset.z}) way.values.push_back(value);
      for (const double value : {0.0, sines[k], 0.0, cosines[k]}) turn.values.push_back(value);
    }
    motion.nodes.emplace_back();
    motion.animations[0].tracks.push_back(way);
    if (turns) {
      motion.nodes.back().translation = start;
      motion.animations[0].tracks.push_back(turn);
      motion.nodes.emplace_back();
      motion.nodes.back().parent = outer;
      motion.nodes.back().translation = -start;
    }
    const auto mesh = static_cast<std::uint32_t>(scene.meshes.size() - 1);
    motion.rigs.push_back(rig_at_rest(scene, mesh, static_cast<std::uint32_t>(motion.nodes.size() - 1)));
  }
};

}  // namespace

GNOMON_SCENE(walking_boxes, WalkingBoxes,
             {.title = "Walking boxes",
              .summary = "Boxes that walk and turn between standing columns; brings out what rigid motion costs where most of "
                         "the scene stands still."})
