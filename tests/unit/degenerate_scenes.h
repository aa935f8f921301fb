#pragma once
// Scenes at the edge of what float32 can say: lights on vertices, edges and faces, receivers in one plane with casters, scenes
// far from the origin and of any size. Every pixel is a point of a triangle that may face the light.
#include "techniques/questions.h"

namespace gnomon::degenerate_scenes {

/// Triangles around one edge of 2 m, like the pages of an open book: the edge stands on the origin along y.
inline Mesh fan(int count) {
  std::vector<glm::vec3> positions{{0, -1, 0}, {0, 1, 0}};
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < count; ++k) {
    const float angle = 6.2831853f * static_cast<float>(k) / static_cast<float>(count);
    positions.push_back({std::cos(angle), 0, std::sin(angle)});
    triangles.push_back({0, 1, static_cast<std::uint32_t>(2 + k)});
  }
  return hand_made::mesh_of(positions, triangles);
}

/// A point of a triangle that is on one of its corners, edges or, of three that are not, in it.
inline glm::vec3 special_point(const Triangle& triangle, Random& random) {
  const glm::vec3* p = triangle.points;
  const std::uint32_t corner = random.below(3);
  switch (random.below(3)) {
    case 0:
      return p[corner];
    case 1:
      return p[corner] / 2.0f + p[(corner + 1) % 3] / 2.0f;
    default:
      return p[corner] / 2.0f + p[(corner + 1) % 3] / 4.0f + p[(corner + 2) % 3] / 4.0f;
  }
}

/// What a scene is taken through: each coordinate times a scale, plus a shift, rounded to float32.
struct Place {
  double scale = 1;
  glm::dvec3 shift{0};
  glm::vec3 operator()(const glm::vec3& p) const { return glm::vec3(scale * glm::dvec3(p) + shift); }
};

/// As it is, at another size between 1e-18 and 1e15 m, or as far away as 1e7 times its size.
inline Place random_place(Random& random) {
  const std::uint32_t kind = random.below(8);
  if (kind < 3) return {};
  if (kind == 3) return {std::exp2(static_cast<int>(random.below(110)) - 60)};
  if (kind == 4) return {std::pow(10.0, static_cast<int>(random.below(34)) - 18)};
  const double scale = kind == 5 ? 1e-12 : kind == 6 ? 1e-18 : 1;
  const glm::dvec3 direction = random.uniform(glm::dvec3(-1), glm::dvec3(1));
  return {scale, scale * std::pow(10.0, static_cast<int>(random.below(8))) * direction};
}

inline void sort_by_mesh(hand_made::Picture& picture) {
  std::vector<std::size_t> order(picture.gbuffer.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return picture.mesh[i]; });
  const auto sort = [&](auto& values) {
    auto sorted = values;
    for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
    std::ranges::copy(sorted, values.begin());
  };
  for (auto& value : picture.value) sort(value);
  sort(picture.mesh);
  sort(picture.triangle);
}

/// Scenes of questions.h and fans, snapped or not, with half of the lamps on geometry, anywhere. Points of one mesh are
/// neighbors in the picture, so that few pixels are silhouettes.
inline std::unique_ptr<questions::Case> make(int round, Random& random) {
  std::unique_ptr<questions::Case> c(new questions::Case{.scene = {}, .light = {}, .picture{400, 1}, .questions = {}});
  const int kind = round % (questions::kinds + 2);
  Mesh first = kind < questions::kinds ? questions::hard_mesh(kind, round / 10, random)
                                       : fan(kind == questions::kinds ? 60 : 2 + static_cast<int>(random.below(60)));
  c->scene.meshes = {std::move(first), hand_made::square(6, -2)};
  if (random.below(2)) c->scene.meshes.push_back(hard_scenes::grid_soup(random, 3));
  if (random.below(2))
    for (Mesh& mesh : c->scene.meshes) questions::snap(mesh);
  c->light = questions::hard_light(c->scene.meshes[0], random);
  const Place place = random_place(random);
  for (Mesh& mesh : c->scene.meshes) {
    for (glm::vec3& p : mesh.positions) p = place(p);
    finish(mesh);
    mesh.casts = random.below(8) != 0;
    mesh.receives = random.below(8) != 0;
  }
  const Mesh& lamp = c->scene.meshes[0];
  const bool is_on_geometry = random.below(2) && !lamp.triangles.empty();
  const Triangle under =
      is_on_geometry ? questions::corners(lamp, random.below(static_cast<std::uint32_t>(lamp.triangles.size()))) : Triangle{};
  const glm::vec3 at = is_on_geometry ? special_point(under, random) : place(glm::vec3(homogeneous(c->light)));
  if (auto* spot = std::get_if<SpotLight>(&c->light.kind)) spot->position = at;
  if (auto* point = std::get_if<PointLight>(&c->light.kind)) point->position = at;
  c->picture.gbuffer.view.eye = place({1, 3, 7});
  hard_scenes::scatter(c->scene, c->light, random, c->picture);
  sort_by_mesh(c->picture);
  questions::ask(*c);
  return c;
}

}  // namespace gnomon::degenerate_scenes
