// A puff of smoke of cards that all stand across the middle of the puff: each lets least through in its middle and all at its
// border. With more cards each lets more through, so that the puff as a whole stays as dense.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace gnomon;

/// Smooth noise between 0 and 1: random numbers at the corners of a lattice of `cells` cells, between them by cubic weights.
class Clouds {
 public:
  Clouds(int cells, std::uint64_t seed) : cells_(cells) {
    Random random(seed);
    for (int i = 0; i < (cells + 1) * (cells + 1); ++i) values_.push_back(random.uniform(0, 1));
  }
  double at(const glm::dvec2& place) const {
    const glm::dvec2 in_cells = place * static_cast<double>(cells_), low = glm::floor(in_cells), part = in_cells - low;
    const glm::dvec2 s = part * part * (3.0 - 2.0 * part);
    const auto corner = [&](int dx, int dy) {
      const int x = std::min(static_cast<int>(low.x) + dx, cells_), y = std::min(static_cast<int>(low.y) + dy, cells_);
      return values_[static_cast<std::size_t>(y) * (cells_ + 1) + x];
    };
    return glm::mix(glm::mix(corner(0, 0), corner(1, 0), s.x), glm::mix(corner(0, 1), corner(1, 1), s.x), s.y);
  }

 private:
  int cells_;
  std::vector<double> values_;
};

class SmokeCards final : public SceneGenerator {
  Number<int> count{this, "count", 48, {.min = 1, .max = 20000, .log = true}, Stage::build, "Number of cards."};
  Number<int> texels{this,         "texels",
                     64,           {.unit = "texel", .min = 8, .max = 1024, .log = true},
                     Stage::build, "Width and height of the texture that says what a card lets through."};
  Number<double> density{this,
                         "density",
                         4,
                         {.min = 0.1, .max = 100, .log = true},
                         Stage::build,
                         "Optical depth of all cards one behind the other, in their middles."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses the cards' places and turns."};
  Flag glass{this, "glass", true, Stage::build, "Whether the cards let light through; else they are opaque squares."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(9), default_segments, "ground"), {0.58f, 0.56f, 0.5f}));
    scene.meshes.push_back(
        painted(tessellate(Box{{-0.3f, 0, -0.3f}, {0.3f, 0.5f, 0.3f}}, default_segments, "stove"), {0.3f, 0.28f, 0.27f}));
    scene.meshes.push_back(puff());
    scene.lights = shining_at(
        {0, 0, 0},
        {{.name = "point", .kind = PointLight{{-2.5f, 4.5f, 1.5f}}},
         {.name = "sun", .kind = DirectionalLight{{0.6f, -1, -0.4f}}},
         {.name = "panel", .kind = level_square({-2.5f, 4.5f, 1.5f}, 0.5)},
         {.name = "lamp", .kind = DiscLight{.center = {-2.5f, 4.5f, 1.5f}, .normal = {2.5f, -4.5f, -1.5f}, .radius = 0.3f}}});
    scene.views = {{.name = "view", .eye = {2.1f, 2.6f, 3.6f}, .target = {0.8f, 0.1f, -0.5f}, .fov_y_degrees = 32},
                   {.name = "near", .eye = {1.6f, 1.1f, 1.2f}, .target = {0.95f, 0, -0.55f}, .fov_y_degrees = 38},
                   {.name = "far", .eye = {7, 10, 20}, .target = {0.8f, 0.2f, -0.4f}, .fov_y_degrees = 9}};
    return scene;
  }

 private:
  /// What a card of this mean optical depth lets through: exp(-depth), cloudy, and fading to nothing toward its border.
  std::shared_ptr<const Transmission> smoke(double depth) const {
    const Clouds coarse(5, static_cast<std::uint64_t>(seed)), fine(11, static_cast<std::uint64_t>(seed) + 1);
    std::vector<float> values;
    for (int row = 0; row < texels; ++row)
      for (int column = 0; column < texels; ++column) {
        const glm::dvec2 place = (glm::dvec2(column, row) + 0.5) / static_cast<double>(texels);
        const double from_middle = 2 * glm::distance(place, glm::dvec2(0.5));
        const double inside = std::clamp(2 - 2 * from_middle, 0.0, 1.0), fade = inside * inside * (3 - 2 * inside);
        const double cloud = 0.4 + 0.8 * coarse.at(place) + 0.4 * fine.at(place);  // 1 in the mean
        values.push_back(static_cast<float>(std::exp(-depth * fade * cloud)));
      }
    return std::make_shared<const Transmission>(texels, texels, 1, std::move(values), Transmission::Wrap::clamp,
                                                Transmission::Wrap::clamp);
  }

  /// Cards of 1.2 m around places in an ellipsoid, 2 m high, above the stove.
  Mesh puff() const {
    Mesh mesh;
    mesh.name = "smoke";
    mesh.albedo = {0.5f, 0.5f, 0.5f};
    Random random(static_cast<std::uint64_t>(seed));
    const auto in_ball = [&] {
      for (;;)
        if (const glm::dvec3 p = random.uniform(glm::dvec3(-1), glm::dvec3(1)); glm::length(p) <= 1 && glm::length(p) >= 0.1)
          return p;
    };
    for (int k = 0; k < count; ++k) {
      const glm::dvec3 center = glm::dvec3(0, 1.7, 0) + in_ball() * glm::dvec3(0.6, 1, 0.6);
      const glm::dvec3 normal = glm::normalize(in_ball()), u = glm::normalize(glm::cross(normal, in_ball()));
      const glm::dvec3 v = glm::cross(normal, u);
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      for (const glm::dvec2& corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
        mesh.positions.emplace_back(center + 1.2 * ((corner.x - 0.5) * u + (corner.y - 0.5) * v));
        if (glass) mesh.uv.emplace_back(corner);
      }
      mesh.triangles.emplace_back(first, first + 1, first + 2);
      mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
    if (glass) mesh.transmission = smoke(density / count * 3);  // a third of the cards is on a way through the middle
    mesh.seen = !glass;
    finish(mesh);
    return mesh;
  }
};

}  // namespace

GNOMON_SCENE(smoke_cards, SmokeCards,
             {.title = "Smoke cards",
              .summary = "A puff of many cards that each let most of the light through; brings out what many thin layers cost "
                         "and how wrong they come out."})
