// A chain-link fence: one square for each panel, over which a small mask with the wires of a single mesh repeats. Behind it, as
// the lights see it, stand a crate and a wall that its shadow falls on.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace gnomon;

/// Of a panel, in meters.
constexpr double panel_width = 2, panel_height = 1.6;

/// One mesh of the fence: wires along both diagonals of the unit square, which repeats without a seam. `wire` is their width as
/// a share of the side. Alpha falls from one to zero over the width of a texel; centers of texels lie on both diagonals, so no
/// wire is too thin for a mask.
AlphaMask diagonals(int texels, double wire) {
  const auto off_line = [](double place) { return std::abs(place - std::round(place)) / std::sqrt(2.0); };
  std::vector<std::uint8_t> alpha;
  for (int row = 0; row < texels; ++row)
    for (int column = 0; column < texels; ++column) {
      const double u = (column + 0.5) / texels, v = (row + 0.5) / texels;
      const double outside = texels * (std::min(off_line(u + v), off_line(u - v)) - wire / 2);
      alpha.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(0.5 - outside, 0.0, 1.0))));
    }
  return AlphaMask(texels, texels, alpha);
}

class ChainLink final : public SceneGenerator {
  Number<int> panels{this, "panels", 3, {.min = 1, .max = 16}, Stage::build, "Panels of 2 m by 1.6 m in a row."};
  Number<double> size{
      this, "size", 0.1, {.unit = "m", .min = 0.02, .max = 1, .log = true}, Stage::build, "Width and height of a mesh."};
  Number<double> wire{
      this, "wire", 0.008, {.unit = "m", .min = 0.0005, .max = 0.02, .log = true}, Stage::build, "Width of a wire."};
  Number<int> texels{this,         "texels",
                     32,           {.unit = "texel", .min = 8, .max = 512, .log = true},
                     Stage::build, "Width and height of the mask, which holds one mesh."};
  Flag masks{this, "masks", true, Stage::build, "Whether the panels have holes; else they are solid."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    const auto box = [](const glm::dvec3& min, const glm::dvec3& max, std::string name) {
      return tessellate(Box{.min = min, .max = max}, default_segments, std::move(name));
    };
    const double right = 0.5 * panels * panel_width, top = 0.05 + panel_height;
    std::vector<Mesh> posts;
    for (int i = 0; i <= panels; ++i)
      posts.push_back(cylinder({i * panel_width - right, 0, -0.04}, {0, top + 0.1, 0}, 0.03, 16, "post"));

    scene.meshes.push_back(painted(tessellate(ground_plane(17), default_segments, "ground"), {0.56f, 0.55f, 0.5f}));
    scene.meshes.push_back(painted(box({-0.5, 0, -1.7}, {0.4, 0.8, -0.9}, "crate"), {0.62f, 0.42f, 0.22f}));
    scene.meshes.push_back(painted(box({-right, 0, -2.9}, {right, 1.7, -2.7}, "wall"), {0.72f, 0.68f, 0.62f}));
    scene.meshes.push_back(painted(merge(posts, "posts"), {0.35f, 0.38f, 0.36f}));
    scene.meshes.push_back(links(right));
    scene.lights = shining_at(
        {0, 0.4f, -1},
        {{.name = "point", .kind = PointLight{{-1.8f, 3.2f, 2.6f}}},
         {.name = "sun", .kind = DirectionalLight{{0.45f, -0.75f, -1}}},
         {.name = "lamp", .kind = DiscLight{.center = {-1.8f, 3.2f, 2.6f}, .normal = {1.8f, -2.8f, -3.6f}, .radius = 0.08f}}});
    scene.views = {{.name = "view", .eye = {1.9f, 2, 4.2f}, .target = {0, 0.55f, -0.8f}, .fov_y_degrees = 38},
                   {.name = "near", .eye = {0.35f, 0.75f, -0.3f}, .target = {0, 0.25f, -0.9f}, .fov_y_degrees = 42},
                   {.name = "far", .eye = {7, 5, 20}, .target = {0.2f, 0.5f, -1}, .fov_y_degrees = 14}};
    return scene;
  }

 private:
  /// Panels side by side in the plane z = 0, 5 cm above the ground.
  Mesh links(double right) const {
    Mesh mesh;
    mesh.name = "links";
    mesh.albedo = {0.55f, 0.58f, 0.6f};
    const glm::vec2 most(panel_width / size, panel_height / size);
    for (int i = 0; i < panels; ++i) {
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::dvec2& corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
        mesh.positions.emplace_back((i + corner.x) * panel_width - right, 0.05 + corner.y * panel_height, 0);
        mesh.uv.emplace_back(most.x * corner.x, most.y * (1 - corner.y));
      }
      mesh.triangles.emplace_back(first, first + 1, first + 2);
      mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
    if (masks)
      mesh.alpha_mask = std::make_shared<const AlphaMask>(diagonals(texels, wire / size));
    else
      mesh.uv.clear();
    finish(mesh);
    return mesh;
  }
};

}  // namespace

GNOMON_SCENE(chain_link, ChainLink,
             {.title = "Chain-link fence",
              .summary = "A fence of a few large cards with a repeated mask; brings out holes and wires thinner than a texel."})
