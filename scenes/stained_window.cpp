// A leaded window of colored panes in a wall, and a colored cloth behind it: light that comes through both is colored twice.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

namespace {

using namespace gnomon;

/// What panes let through of red, green and blue light.
constexpr glm::vec3 paints[] = {{0.80f, 0.06f, 0.05f}, {0.08f, 0.15f, 0.75f}, {0.10f, 0.55f, 0.15f},
                                {0.90f, 0.55f, 0.08f}, {0.45f, 0.10f, 0.55f}, {0.90f, 0.90f, 0.85f}};
constexpr glm::vec3 cloth{0.90f, 0.60f, 0.15f};

class StainedWindow final : public SceneGenerator {
  Number<int> columns{this, "columns", 5, {.min = 1, .max = 64}, Stage::build, "Panes beside each other."};
  Number<int> rows{this, "rows", 6, {.min = 1, .max = 64}, Stage::build, "Panes above each other."};
  Number<int> texels{this,
                     "texels",
                     9,
                     {.unit = "texel", .min = 2, .max = 64},
                     Stage::build,
                     "Width and height of a pane in the window's texture; one is the lead, which is opaque."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses the panes' colors."};
  Flag colored{this, "colored", true, Stage::build,
               "Whether the glass colors the light; else it lets the mean of its channels through."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(6), default_segments, "ground"), {0.62f, 0.6f, 0.56f}));
    const auto stone = [&](const char* name, const Box& box) {
      scene.meshes.push_back(painted(tessellate(box, default_segments, name), {0.55f, 0.52f, 0.48f}));
    };
    stone("left", {{-2.5f, 0, -0.1f}, {-1, 4, 0.1f}});
    stone("right", {{1, 0, -0.1f}, {2.5f, 4, 0.1f}});
    stone("sill", {{-1, 0, -0.1f}, {1, 0.8f, 0.1f}});
    stone("lintel", {{-1, 3.2f, -0.1f}, {1, 4, 0.1f}});
    scene.meshes.push_back(sheet("window", {-1, 0.8f, 0}, {2, 0, 0}, {0, 2.4f, 0}, panes()));
    scene.meshes.push_back(
        sheet("cloth", {0.1f, 0.7f, 0.7f}, {1.3f, 0, 0.3f}, {0, 1.5f, 0}, std::make_shared<const Transmission>(of(cloth))));
    scene.lights = shining_at(
        {0.4f, 0, 1.6f},
        {{.name = "point", .kind = PointLight{{-1.5f, 6.2f, -3.6f}}},
         {.name = "sun", .kind = DirectionalLight{{0.25f, -0.9f, 0.75f}}},
         {.name = "lamp", .kind = DiscLight{.center = {-1.5f, 6.2f, -3.6f}, .normal = {1.5f, -4.2f, 3.6f}, .radius = 0.15f}}});
    scene.views = {{.name = "view", .eye = {3.4f, 4.2f, 6.6f}, .target = {0.5f, 0.4f, 1.2f}, .fov_y_degrees = 38},
                   {.name = "near", .eye = {1.3f, 1.9f, 3.9f}, .target = {0.6f, 0, 1.6f}, .fov_y_degrees = 40}};
    return scene;
  }

 private:
  glm::vec3 of(const glm::vec3& light) const { return colored ? light : glm::vec3((light.x + light.y + light.z) / 3); }

  std::shared_ptr<const Transmission> panes() const {
    Random random(static_cast<std::uint64_t>(seed));
    std::vector<glm::vec3> colors;
    for (int k = 0; k < columns * rows; ++k) {
      const auto paint = static_cast<std::size_t>(random.uniform(0, std::size(paints)));
      colors.push_back(of(paints[std::min(paint, std::size(paints) - 1)] * static_cast<float>(random.uniform(0.75, 1))));
    }
    const int width = columns * texels + 1, height = rows * texels + 1;  // lead on all sides
    std::vector<float> values;
    for (int row = 0; row < height; ++row)
      for (int column = 0; column < width; ++column) {
        const bool is_lead = row % texels == 0 || column % texels == 0;
        const glm::vec3 light = is_lead ? glm::vec3(0) : colors[(row / texels) * columns + column / texels];
        values.insert(values.end(), {light.x, light.y, light.z});
      }
    return std::make_shared<const Transmission>(width, height, 3, std::move(values), Transmission::Wrap::clamp,
                                                Transmission::Wrap::clamp);
  }

  /// A parallelogram that the eye looks through.
  static Mesh sheet(const char* name, const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v,
                    std::shared_ptr<const Transmission> transmission) {
    Mesh mesh;
    mesh.name = name;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    mesh.transmission = std::move(transmission);
    if (mesh.needs_uv()) mesh.uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.seen = false;
    finish(mesh);
    return mesh;
  }
};

}  // namespace

GNOMON_SCENE(
    stained_window, StainedWindow,
    {.title = "Stained window",
     .summary = "Leaded panes of colored glass in a wall, and a colored cloth behind them; brings out whether each channel "
                "of the light comes out right."})
