// A bush of crossed cards above a trunk: each card is a square that a mask cuts down to a twig with leaves. From 72 cards on
// their area together is always the same: more cards are smaller ones.
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>

namespace {

using namespace gnomon;

/// How far a point is outside of an ellipse at the origin, to first order in that distance: f / |gradient of f| of
/// f = |(x / a, y / b)| - 1. Negative inside.
double outside_ellipse(const glm::dvec2& point, const glm::dvec2& half_axes) {
  const double f = glm::length(point / half_axes), slope = glm::length(point / (half_axes * half_axes));
  return slope > 0 ? (f - 1) * f / slope : -std::min(half_axes.x, half_axes.y);
}

double outside_line(const glm::dvec2& point, const glm::dvec2& from, const glm::dvec2& to, double half_width) {
  const glm::dvec2 way = to - from;
  const double along = std::clamp(glm::dot(point - from, way) / glm::dot(way, way), 0.0, 1.0);
  return glm::distance(point, from + along * way) - half_width;
}

/// A twig that grows from the middle of the lower edge of the unit square, whose first row is the upper one: a leaf at its tip
/// and three pairs below. Negative inside.
double outside_twig(const glm::dvec2& place) {
  const glm::dvec2 half_axes(0.17, 0.07);
  double least = outside_line(place, {0.5, 1}, {0.5, 0.3}, 0.012);
  least = std::min(least, outside_ellipse({place.y - 0.19, place.x - 0.5}, half_axes));
  for (const double foot : {0.46, 0.66, 0.86})
    for (const double side : {-1.0, 1.0}) {
      // Leaves rise by 3 in 4: cosine 0.8, sine 0.6, from the stem outward.
      const glm::dvec2 outward(0.8 * side, -0.6), across(0.6, 0.8 * side);
      const glm::dvec2 middle = glm::dvec2(0.5, foot) + 0.2 * outward;
      const glm::dvec2 from_middle = place - middle;
      least = std::min(least, outside_ellipse({glm::dot(from_middle, outward), glm::dot(from_middle, across)}, half_axes));
    }
  return least;
}

/// Alpha falls from one to zero over the width of a texel, so that levels of averages mean something.
AlphaMask twig(int texels) {
  std::vector<std::uint8_t> alpha;
  for (int row = 0; row < texels; ++row)
    for (int column = 0; column < texels; ++column) {
      const double outside = texels * outside_twig({(column + 0.5) / texels, (row + 0.5) / texels});
      alpha.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(0.5 - outside, 0.0, 1.0))));
    }
  using enum AlphaMask::Wrap;
  return AlphaMask(texels, texels, alpha, 1, 0.5f, clamp, clamp);
}

/// Appends a square of that side: its lower edge is centered at `foot`, `along` leads to the upper one.
void add_card(Mesh& mesh, const glm::dvec3& foot, const glm::dvec3& along, const glm::dvec3& across, double side) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  const glm::dvec3 half = 0.5 * side * across, up = side * along;
  for (const glm::dvec3& corner : {foot - half, foot + half, foot + half + up, foot - half + up})
    mesh.positions.emplace_back(corner);
  for (const glm::vec2& place : {glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0), glm::vec2(0, 0)}) mesh.uv.push_back(place);
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

class LeafCards final : public SceneGenerator {
  Number<int> count{
      this, "count", 160, {.min = 1, .max = 20000, .log = true}, Stage::build, "Number of cards, crossed in pairs."};
  Number<int> texels{this,         "texels",
                     64,           {.unit = "texel", .min = 8, .max = 1024, .log = true},
                     Stage::build, "Width and height of the mask that cuts the leaves."};
  Number<int> seed{this, "seed", 1, {.min = 0, .max = 1000000}, Stage::build, "Chooses places and turns of the cards."};
  Number<double> wind{this,
                      "wind",
                      0,
                      {.min = 0, .max = 1},
                      Stage::build,
                      "How far the tip of a card sways at most, in lengths of a card; 0: all stand still."};
  Flag masks{this, "masks", true, Stage::build, "Whether the cards have holes; else they are solid squares."};

 public:
  Scene make() const override {
    Scene scene;
    scene.name = id();
    scene.meshes.push_back(painted(tessellate(ground_plane(9), default_segments, "ground"), {0.66f, 0.6f, 0.48f}));
    scene.meshes.push_back(painted(cylinder({0, 0, 0}, {0, 1.1, 0}, 0.06, 16, "trunk"), {0.36f, 0.25f, 0.16f}));
    scene.meshes.push_back(crown());
    scene.lights = shining_at(
        {0.6f, 0.3f, 0.2f},
        {{.name = "point", .kind = PointLight{{-2.4f, 4.2f, 1.8f}}},
         {.name = "sun", .kind = DirectionalLight{{0.7f, -1, -0.45f}}},
         {.name = "panel", .kind = level_square({-2.4f, 4.2f, 1.8f}, 0.5)},
         {.name = "lamp", .kind = DiscLight{.center = {-2.4f, 4.2f, 1.8f}, .normal = {2.4f, -3, -1.8f}, .radius = 0.2f}}});
    scene.views = {{.name = "view", .eye = {2.2f, 2.7f, 5.2f}, .target = {0.55f, 0.95f, 0}, .fov_y_degrees = 35},
                   {.name = "near", .eye = {1.5f, 1.15f, 1.1f}, .target = {0.75f, 0.1f, -0.15f}, .fov_y_degrees = 34},
                   {.name = "far", .eye = {8.5f, 7.5f, 21}, .target = {0.8f, 0.75f, -0.2f}, .fov_y_degrees = 11}};
    if (wind > 0) scene.motion = swaying(scene, 2);
    return scene;
  }

 private:
  double side() const { return std::min(0.6, 0.4 * std::sqrt(160.0 / count)); }

  /// The upper edge of each card swings to and fro with the wind, from anywhere on its way, while its foot stands still. The
  /// way is 2 |A| long at most, for cos(a) - cos(b) is.
  std::shared_ptr<const Motion> swaying(const Scene& scene, std::uint32_t leaves) const {
    auto motion = std::make_shared<Motion>();
    MotionNode node;
    node.weights = {0, 0};
    motion->nodes = {node};
    motion->animations = {{"wind", {circling_weights(0, 2)}}};
    Rig rig = rig_at_rest(scene, leaves, 0);
    const std::size_t vertex_count = rig.base.size();
    rig.targets.assign(2 * vertex_count, glm::dvec3(0));
    Random random(static_cast<std::uint64_t>(seed), 77);  // another stream than the cards: the wind moves none of them
    for (std::size_t first = 0; first < vertex_count; first += 4) {
      const glm::dvec3 gust = glm::normalize(glm::dvec3(1, 0, -0.4) + 0.3 * in_ball(random));
      const glm::dvec3 way = 0.5 * wind * side() * random.uniform(0.5, 1) * gust;
      const double phase = random.uniform(0, 2 * std::numbers::pi);
      for (const std::size_t upper : {first + 2, first + 3}) {
        rig.targets[upper] = std::cos(phase) * way;
        rig.targets[vertex_count + upper] = -std::sin(phase) * way;
      }
    }
    motion->rigs.push_back(std::move(rig));
    return motion;
  }

  /// Pairs of cards with a common foot grow outward from places in a ball of 0.75 m around (0, 1.45, 0).
  Mesh crown() const {
    Mesh mesh;
    mesh.name = "leaves";
    mesh.albedo = {0.2f, 0.42f, 0.12f};
    Random random(static_cast<std::uint64_t>(seed));
    for (int made = 0; made < count; made += 2) {
      const glm::dvec3 place = in_ball(random), aside = in_ball(random);
      const glm::dvec3 along = glm::normalize(place + glm::dvec3(0, 0.25, 0) + 0.4 * aside);
      const glm::dvec3 across = glm::normalize(glm::cross(along, in_ball(random)));
      const glm::dvec3 foot = glm::dvec3(0, 1.45, 0) + 0.75 * place;
      add_card(mesh, foot, along, across, side());
      if (made + 1 < count) add_card(mesh, foot, along, glm::cross(along, across), side());
    }
    if (masks)
      mesh.alpha_mask = std::make_shared<const AlphaMask>(twig(texels));
    else
      mesh.uv.clear();
    finish(mesh);
    return mesh;
  }

  /// Anywhere in the unit ball but next to its center, where a place has no direction.
  static glm::dvec3 in_ball(Random& random) {
    for (;;) {
      const glm::dvec3 place = random.uniform(glm::dvec3(-1), glm::dvec3(1));
      const double length = glm::length(place);
      if (length <= 1 && length >= 0.1) return place;
    }
  }
};

}  // namespace

GNOMON_SCENE(
    leaf_cards, LeafCards,
    {.title = "Leaf cards",
     .summary = "A bush of crossed cards that a mask cuts to leaves; brings out what holes cost and how wrong they come out."})
