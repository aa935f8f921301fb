#include "measure/conformance/combined_scene.h"

#include <fmt/format.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>

#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "measure/conformance/motion_world.h"

namespace gnomon::conformance {
namespace {

using Property = Track::Property;
using Wrap = AlphaMask::Wrap;

Wrap any_wrap(Random& random) { return static_cast<Wrap>(random.below(3)); }
int any_side(Random& random) { return 3 + static_cast<int>(random.below(4)); }

/// Two thirds of its texels are solid.
std::shared_ptr<const AlphaMask> any_mask(Random& random) {
  const int width = any_side(random), height = any_side(random);
  const Wrap wrap_u = any_wrap(random), wrap_v = any_wrap(random);
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < width * height; ++i) alpha.push_back(random.below(3) ? 255 : 0);
  alpha.front() = 255;
  alpha.back() = 0;
  return std::make_shared<const AlphaMask>(width, height, alpha, 1.0f, 0.5f, wrap_u, wrap_v);
}

/// Of shares that float32 holds; texels may be opaque, or as if they were not there.
std::shared_ptr<const Transmission> any_transmission(Random& random, bool has_texels) {
  constexpr std::array<float, 5> shares = {0.25f, 0.5f, 0.75f, 0, 1};
  if (!has_texels) return std::make_shared<const Transmission>(glm::vec3(shares[random.below(3)]));
  const int width = any_side(random), height = any_side(random);
  const Wrap wrap_u = any_wrap(random), wrap_v = any_wrap(random);
  std::vector<float> values;
  for (int i = 0; i < width * height; ++i) values.push_back(shares[random.below(5)]);
  values.front() = 0.25f;
  values.back() = 0.5f;
  return std::make_shared<const Transmission>(width, height, 1, std::move(values), wrap_u, wrap_v);
}

constexpr int card_rows = 3;  ///< of two vertices

/// A strip around the origin, about level, of two pieces that meet at an angle.
Mesh any_card(Random& random, std::string name) {
  Mesh card;
  card.name = std::move(name);
  const glm::dvec3 along = random.uniform({0.8, -0.3, -0.3}, {1.2, 0.3, 0.3}),
                   aside = random.uniform({-0.3, -0.3, 0.6}, {0.3, 0.3, 1.0});
  const double fold = random.uniform(-0.3, 0.3), times = random.uniform(1, 1.5);
  for (int k = 0; k < card_rows; ++k)
    for (const double side : {-1.0, 1.0}) {
      card.positions.emplace_back((k - 1.0) * along + side * aside + glm::dvec3(0, k == 1 ? fold : 0, 0));
      card.uv.emplace_back(times * k / 2, times * (side + 1) / 2);
    }
  for (std::uint32_t k = 0; k + 1 < card_rows; ++k) {
    card.triangles.emplace_back(2 * k, 2 * k + 1, 2 * k + 2);
    card.triangles.emplace_back(2 * k + 2, 2 * k + 1, 2 * k + 3);
  }
  return card;
}

glm::dvec3 any_place(Random& random) { return random.uniform({-2, 1.5, -2}, {2, 2.75, 2}); }
std::vector<double> numbers(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

/// It goes to another place and on to a third, and turns there and back.
void add_way(Random& random, Motion& motion, std::uint32_t node, const glm::vec3& at) {
  const glm::dvec3 first = glm::dvec3(at) + random.uniform({-0.8, -0.2, -0.8}, {0.8, 0.2, 0.8}), second = any_place(random);
  add_track(motion, node, Property::translation, {{0, numbers(at)}, {2, numbers(first)}, {4, numbers(second)}});
  const glm::dvec3 axis = glm::normalize(random.uniform({-0.5, 0.5, -0.5}, {0.5, 1, 0.5}));
  const double half = random.uniform(-0.2, 0.2);  // of the angle
  const glm::dvec3 sines = std::sin(half) * axis;
  add_track(motion, node, Property::rotation,
            {{0, {0, 0, 0, 1}}, {2, {sines.x, sines.y, sines.z, std::cos(half)}}, {4, {0, 0, 0, 1}}});
}

/// The far end of a card rises and sinks.
void add_bend(Random& random, Motion& motion, std::uint32_t node) {
  Rig& rig = motion.rigs.back();
  const double height = random.uniform(0.2, 0.4);
  rig.targets.assign(rig.base.size(), glm::dvec3(0));
  for (std::size_t k = rig.targets.size() - 2; k < rig.targets.size(); ++k) rig.targets[k].y = height;
  motion.nodes[node].weights = {0.0};
  add_track(motion, node, Property::weights, {{0, {0}}, {2, {1}}, {4, {-1}}});
}

void add_cards(Random& random, Scene& scene, Motion& motion, std::uint64_t seed) {
  const bool has_holes = seed & 1, has_glass = seed & 2, has_texels = seed & 4;
  for (int k = 0; k < 4; ++k) {
    Mesh card = any_card(random, fmt::format("card_{}", k));
    if (has_holes && (k == 0 || k == 2)) card.alpha_mask = any_mask(random);
    if (has_glass && (k == 1 || k == 2)) card.transmission = any_transmission(random, has_texels);
    if (card.transmission) card.seen = random.below(2) != 0;
    if (!card.needs_uv()) card.uv.clear();
    finish(card);
    const glm::vec3 at(any_place(random));
    const bool bends = k == static_cast<int>(seed % 3) || random.below(3) == 0;
    if (k < 3 || random.below(2)) {
      const std::uint32_t node = add_placed(scene, motion, std::move(card), at);
      add_way(random, motion, node, at);
      if (bends) add_bend(random, motion, node);
    } else {
      for (glm::vec3& p : card.positions) p += at;
      scene.meshes.push_back(std::move(card));
    }
  }
}

/// Of one of the six kinds, above all casters, and shining on them.
Light any_light(Random& random, std::uint64_t kind) {
  const glm::vec3 place(random.uniform({-1.5, 7, -1.5}, {1.5, 9, 1.5})),
      down = glm::vec3(random.uniform({-0.5, 0, -0.5}, {0.5, 0, 0.5})) - place;
  const auto size = [&] { return static_cast<float>(random.uniform(0.25, 0.5)); };
  switch (kind) {
    case 0:
      return {.name = "point", .kind = PointLight{place}};
    case 1:
      return {.name = "sun", .kind = DirectionalLight{down}};
    case 2: {
      const double inner = random.uniform(12, 20), outer = random.uniform(24, 30);
      return {.name = "spot", .kind = SpotLight{place, down, static_cast<float>(inner), static_cast<float>(outer)}};
    }
    case 3: {
      const float length = size(), width = size();
      const glm::vec3 along(length, 0.25f * length, 0), aside(0, 0.25f * width, width);
      return {.name = "rect", .kind = RectLight{place, along, aside, random.below(2) ? Emits::in_front : Emits::on_both_sides}};
    }
    case 4:
      return {.name = "disc", .kind = DiscLight{place, down, size(), Emits::on_both_sides}};
    default:
      return {.name = "sphere", .kind = SphereLight{place, size()}};
  }
}

}  // namespace

Scene combined_scene(std::uint64_t seed) {
  Random random(seed);
  Scene scene;
  scene.name = fmt::format("combined_scene_{}", seed);
  scene.meshes.push_back(tessellate(ground_plane(6), 3, "ground"));
  const glm::vec3 low(random.uniform({-2.5, 0.125, -2}, {1, 0.125, 1})), size(random.uniform({0.5, 0.5, 0.5}, {1.2, 1.2, 1.2}));
  scene.meshes.push_back(tessellate(Box{.min = low, .max = low + size}, default_segments, "block"));
  scene.meshes.push_back(tessellate(Sphere{glm::vec3(any_place(random)), 0.6f}, 12, "ball"));
  const auto motion = std::make_shared<Motion>();
  motion->animations = {{"move", {}}};
  const glm::vec3 half(random.uniform({0.3, 0.3, 0.3}, {0.6, 0.6, 0.6})), at(any_place(random));
  Mesh walker = tessellate(Box{.min = -half, .max = half}, default_segments, "walker");
  add_way(random, *motion, add_placed(scene, *motion, std::move(walker), at), at);
  add_cards(random, scene, *motion, seed);
  scene.motion = motion;
  // Two of one kind and one of the other, without area and with; of three kinds the seed leaves one or two out.
  const std::uint64_t hard_count = (seed ^ seed >> 1) & 1 ? 2 : 1;
  for (std::uint64_t k = 0; k < 3; ++k) scene.lights.push_back(any_light(random, (k < hard_count ? 0 : 3) + (seed + k) % 3));
  const glm::vec3 eye(random.uniform({-2, 6, 6}, {2, 7, 8}));
  scene.views = {{.name = "view", .eye = eye, .target = {0, 0.5f, 0}, .fov_y_degrees = 38}};
  return scene;
}

}  // namespace gnomon::conformance
