#pragma once
// Casters with holes for tests: cards and boxes with random masks, places in them and layers, beside opaque casters.
#include <gnomon/kit/geometry/exact.h>

#include "questions.h"

namespace gnomon::masked_scenes {

using Wrap = AlphaMask::Wrap;

/// `is_solid(column, row)` is called row after row.
template <class IsSolid>
std::shared_ptr<const AlphaMask> mask_of(int width, int height, const IsSolid& is_solid, Wrap wrap_u = Wrap::repeat,
                                         Wrap wrap_v = Wrap::repeat) {
  std::vector<std::uint8_t> alpha;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) alpha.push_back(is_solid(column, row) ? 255 : 0);
  return std::make_shared<const AlphaMask>(width, height, alpha, 1.0f, 0.5f, wrap_u, wrap_v);
}

/// 8 .. 64 texels a side: a checkerboard, few holes, few solid texels, or as likely the one as the other.
inline std::shared_ptr<const AlphaMask> random_mask(Random& random) {
  const int width = 8 + static_cast<int>(random.below(57)), height = 8 + static_cast<int>(random.below(57));
  const auto wrap_u = static_cast<Wrap>(random.below(3)), wrap_v = static_cast<Wrap>(random.below(3));
  const std::uint32_t kind = random.below(4);
  if (kind == 0)
    return mask_of(
        width, height, [](int x, int y) { return (x + y) % 2 == 0; }, wrap_u, wrap_v);
  const std::uint32_t percent = kind == 1 ? 90 : kind == 2 ? 15 : 50;
  return mask_of(
      width, height, [&](int, int) { return random.below(100) < percent; }, wrap_u, wrap_v);
}

/// The corners of a quad and their places in the mask.
struct Card {
  std::array<glm::vec3, 4> corners;
  std::array<glm::vec2, 4> uv;
};

inline void add(Mesh& mesh, const Card& card, bool is_turned) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), card.corners.begin(), card.corners.end());
  mesh.uv.insert(mesh.uv.end(), card.uv.begin(), card.uv.end());
  if (is_turned) {
    mesh.triangles.push_back({first, first + 2, first + 1});
    mesh.triangles.push_back({first, first + 3, first + 2});
  } else {
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
  }
}

/// Of eighths from -2 to 3, where the mask is repeated, mirrored or cut off.
inline glm::vec2 place_in_eighths(Random& random) {
  const auto x = static_cast<float>(random.below(41)), y = static_cast<float>(random.below(41));
  return {x / 8 - 2, y / 8 - 2};
}

/// All of the mask, a rectangle of its plane, any four places, or one place for the whole card.
inline std::array<glm::vec2, 4> random_places(Random& random) {
  const glm::vec2 low = place_in_eighths(random), high = place_in_eighths(random);
  switch (random.below(5)) {
    case 0:
      return {low, {high.x, low.y}, high, {low.x, high.y}};
    case 1: {
      std::array<glm::vec2, 4> uv;
      for (glm::vec2& place : uv) place = glm::vec2(random.uniform(glm::dvec3(-2), glm::dvec3(3)));
      return uv;
    }
    case 2:
      return {low, low, low, low};
    default:
      return {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)};
  }
}

/// Flat or bent along the diagonal, on a grid of 1/16.
inline std::array<glm::vec3, 4> random_corners(Random& random) {
  const glm::vec3 corner = hard_scenes::on_grid(random, 2, 32), u = hard_scenes::on_grid(random, 1.5f, 24),
                  v = hard_scenes::on_grid(random, 1.5f, 24);
  std::array<glm::vec3, 4> corners{corner, corner + u, corner + u + v, corner + v};
  if (random.below(4) == 0) corners[2] += hard_scenes::on_grid(random, 0.5f, 8);
  return corners;
}

/// Some are in the place of the one before, with other holes, and some are a layer beside it.
inline Mesh cards(Random& random, int count) {
  Mesh mesh;
  mesh.alpha_mask = random_mask(random);
  Card card;
  for (int i = 0; i < count; ++i) {
    const std::uint32_t kind = i == 0 ? 3 : random.below(4);
    if (kind > 1) card.corners = random_corners(random);
    if (kind == 1)
      for (glm::vec3& p : card.corners) p += glm::vec3(0, 0.125f, 0.0625f);
    card.uv = random_places(random);
    add(mesh, card, random.below(2) != 0);
  }
  finish(mesh);
  return mesh;
}

inline Mesh grid_box(Random& random) {
  const glm::vec3 low = hard_scenes::on_grid(random, 1.5f, 12);
  glm::vec3 size;
  for (int k = 0; k < 3; ++k) size[k] = static_cast<float>(1 + random.below(6)) / 4;
  return small_world::box(low, low + size);
}

inline void put_holes(Mesh& mesh, Random& random) {
  mesh.alpha_mask = random_mask(random);
  mesh.uv.clear();
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.uv.push_back(place_in_eighths(random));
}

/// A closed box with holes, and an opaque box one side of which is a mesh of its own with holes.
inline void add_boxes(Random& random, std::vector<Mesh>& meshes) {
  if (random.below(3) == 0) {
    meshes.push_back(grid_box(random));
    put_holes(meshes.back(), random);
  }
  if (random.below(3) == 0) {
    Mesh box = grid_box(random), side = box;
    side.triangles.assign(box.triangles.end() - 2, box.triangles.end());
    box.triangles.resize(box.triangles.size() - 2);
    put_holes(side, random);
    for (Mesh* mesh : {&box, &side}) finish(*mesh);
    meshes.insert(meshes.end(), {box, side});
  }
}

/// `on_lattice`: all corners are multiples of 2^-7 m, so that many ways go exactly through edges, of triangles and of texels.
inline Scene random_scene(Random& random, bool on_lattice) {
  Scene scene;
  scene.meshes = {cards(random, 1 + static_cast<int>(random.below(8))), hand_made::square(6, -2)};
  if (random.below(2)) scene.meshes.push_back(cards(random, 3));
  if (random.below(2)) scene.meshes.push_back(hard_scenes::grid_soup(random, 4));
  if (random.below(2)) scene.meshes.push_back(hard_scenes::boxes(random, 2, random.below(2) != 0));
  add_boxes(random, scene.meshes);
  const glm::dvec3 aside = random.uniform(glm::dvec3(-1), glm::dvec3(1));
  for (Mesh& mesh : scene.meshes) {
    for (glm::vec3& p : mesh.positions)
      if (!on_lattice) p = glm::vec3(1.1 * glm::dvec3(p) + aside);
    on_lattice ? questions::snap(mesh) : finish(mesh);
    mesh.casts = random.below(8) != 0;
    mesh.receives = random.below(8) != 0;
  }
  scene.meshes[0].casts = true;
  return scene;
}

/// The same casters without holes.
inline Scene filled(const Scene& scene) {
  Scene solid = scene;
  for (Mesh& mesh : solid.meshes) {
    mesh.alpha_mask = nullptr;
    mesh.uv.clear();
  }
  return solid;
}

}  // namespace gnomon::masked_scenes
