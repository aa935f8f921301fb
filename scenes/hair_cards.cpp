// A head with hair of cards: long ribbons that hang around it in layers, each with streaks that let nearly all or little of the
// light through.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numbers>

namespace {

using namespace gnomon;

class HairCards final : public SceneGenerator {
  Number<int> count{this, "count", 160, {.min = 1, .max = 16000, .log = true}, Stage::build, "Number of ribbons."};
  Number<int> strands{
      this, "strands", 24, {.min = 2, .max = 512, .log = true}, Stage::build, "Strands across a ribbon, one texel each."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses the ribbons and their strands."};
  Flag glass{this, "glass", true, Stage::build, "Whether strands let light through; else ribbons are opaque."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(9), default_segments, "ground"), {0.6f, 0.57f, 0.52f}));
    scene.meshes.push_back(painted(tessellate(Sphere{{0, 1.55f, 0}, 0.42f}, default_segments, "head"), {0.72f, 0.5f, 0.4f}));
    scene.meshes.push_back(painted(cylinder({0, 0, 0}, {0, 1.2, 0}, 0.14, 32, "neck"), {0.72f, 0.5f, 0.4f}));
    scene.meshes.push_back(hair());
    scene.lights = shining_at(
        {0.6f, 0, 0},
        {{.name = "point", .kind = PointLight{{-2.2f, 4.2f, 2}}},
         {.name = "sun", .kind = DirectionalLight{{0.7f, -1, -0.5f}}},
         {.name = "lamp", .kind = DiscLight{.center = {-2.2f, 4.2f, 2}, .normal = {2.2f, -2.7f, -2}, .radius = 0.25f}}});
    scene.views = {{.name = "view", .eye = {2.6f, 2.7f, 4.2f}, .target = {0.5f, 0.75f, -0.3f}, .fov_y_degrees = 28},
                   {.name = "near", .eye = {2.1f, 1.1f, 0.9f}, .target = {1.05f, 0.05f, -0.7f}, .fov_y_degrees = 36},
                   {.name = "far", .eye = {9, 8, 18}, .target = {0.5f, 0.75f, -0.3f}, .fov_y_degrees = 8}};
    return scene;
  }

 private:
  static constexpr int segments = 6;  ///< of a ribbon, from top to tip

  /// A strand in three lets between a tenth and a half through, the others nearly all.
  std::shared_ptr<const Transmission> streaks(Random& random) const {
    std::vector<float> values;
    for (int k = 0; k < strands; ++k) {
      const bool is_thick = random.below(3) == 0;
      values.push_back(static_cast<float>(is_thick ? random.uniform(0.1, 0.5) : random.uniform(0.85, 0.98)));
    }
    return std::make_shared<const Transmission>(strands, 1, 1, std::move(values), Transmission::Wrap::repeat,
                                                Transmission::Wrap::clamp);
  }

  /// Ribbons of 8 cm start at the upper half of the head, 1 to 8 cm off it, follow it down to its widest place, and hang from
  /// there.
  Mesh hair() const {
    Mesh mesh;
    mesh.name = "hair";
    mesh.albedo = {0.22f, 0.13f, 0.07f};
    Random random(static_cast<std::uint64_t>(seed));
    for (int k = 0; k < count; ++k) {
      const double turn = random.uniform(0, 2 * std::numbers::pi), start = random.uniform(0.15, 1.2);
      const double off = 0.42 + random.uniform(0.01, 0.08), length = random.uniform(0.7, 1.1), shift = random.uniform(0, 1);
      const glm::dvec3 outward(std::cos(turn), 0, std::sin(turn)), across(-outward.z, 0, outward.x);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (int s = 0; s <= segments; ++s) {
        const double way = length * s / segments, angle = start + way / off;  // from the pole
        const double down = std::max(0.0, angle - std::numbers::pi / 2) * off;
        const double bent = std::min(angle, std::numbers::pi / 2);
        const glm::dvec3 middle =
            glm::dvec3(0, 1.55 + off * std::cos(bent) - down, 0) + off * std::sin(bent) * (1 + 0.1 * down) * outward;
        for (const double side : {-0.5, 0.5}) {
          mesh.positions.emplace_back(middle + 0.08 * side * across);
          if (glass) mesh.uv.emplace_back(side + 0.5 + shift, static_cast<double>(s) / segments);
        }
      }
      for (std::uint32_t s = 0; s < segments; ++s) {
        const std::uint32_t a = first + 2 * s;
        mesh.triangles.emplace_back(a, a + 1, a + 3);
        mesh.triangles.emplace_back(a, a + 3, a + 2);
      }
    }
    if (glass) mesh.transmission = streaks(random);
    mesh.seen = !glass;
    finish(mesh);
    return mesh;
  }
};

}  // namespace

GNOMON_SCENE(hair_cards, HairCards,
             {.title = "Hair cards",
              .summary = "A head with hair of ribbons whose strands let parts of the light through; brings out thin streaks in "
                         "many layers close to a receiver."})
