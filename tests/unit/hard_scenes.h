#pragma once
// Scenes that are hard on exact techniques, and points on them, many exactly on edges, planes and borders of shadow volumes.
#include <gnomon/kit/random.h>

#include "hand_made.h"
#include "small_world.h"

namespace gnomon::hard_scenes {

inline glm::vec3 on_grid(Random& random, float half, std::uint32_t steps) {
  glm::vec3 p;
  for (int k = 0; k < 3; ++k)
    p[k] = half * (2.0f * static_cast<float>(random.below(steps + 1)) / static_cast<float>(steps) - 1);
  return p;
}

/// A point light or a sun, on a grid: in supporting planes of triangles, along axes, inside bodies and between casters.
inline Light hard_light(Random& random) {
  for (;;) {
    const glm::vec3 at = on_grid(random, 4, 16);
    if (at == glm::vec3(0)) continue;
    return random.below(2) ? hand_made::point_light(at) : hand_made::sun(at);
  }
}

/// Triangles on a grid of 1/8, wound either way: shared planes, edges and corners happen, and so do copies, slivers and stacks.
inline Mesh grid_soup(Random& random, int count) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int i = 0; i < count; ++i) {
    glm::vec3 a = on_grid(random, 2, 32), b = on_grid(random, 2, 32), c = on_grid(random, 2, 32);
    const std::uint32_t kind = random.below(7);
    const std::size_t n = positions.size();
    if (kind == 0) c = b + glm::vec3(0, 0, 0x1p-12f);
    if (kind == 1) a.y = b.y = c.y = static_cast<float>(random.below(3));
    if (kind == 2) b = 8.0f * b;
    if (kind == 3 && i > 0) a = positions[n - 3], b = positions[n - 2], c = positions[n - 1];
    if (kind == 4 && i > 0) a = positions[n - 2], b = positions[n - 3];  // a neighbor
    positions.insert(positions.end(), {a, b, c});
    const auto first = static_cast<std::uint32_t>(n);
    triangles.push_back(random.below(2) ? glm::uvec3(first, first + 1, first + 2) : glm::uvec3(first, first + 2, first + 1));
  }
  return hand_made::mesh_of(positions, triangles);
}

/// Boxes that reach into each other or, on a grid, stand wall to wall; some open, some inside out, some with faces doubled.
inline Mesh boxes(Random& random, int count, bool is_on_grid) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int i = 0; i < count; ++i) {
    glm::vec3 a = is_on_grid ? on_grid(random, 2, 16) : glm::vec3(random.uniform(glm::dvec3(-2), glm::dvec3(2))), b;
    for (int k = 0; k < 3; ++k)
      b[k] = a[k] + (is_on_grid ? static_cast<float>(1 + random.below(6)) / 4 : static_cast<float>(random.uniform(0.1, 1.5)));
    const Mesh box = small_world::box(a, b);
    const auto base = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), box.positions.begin(), box.positions.end());
    const std::uint32_t kind = random.below(4);
    for (glm::uvec3 t : box.triangles) {
      if (kind == 0 && random.below(6) == 0) continue;
      if (kind == 1) std::swap(t.y, t.z);
      triangles.push_back(t + base);
      if (kind == 2 && random.below(6) == 0) triangles.push_back(t + base);
    }
  }
  return hand_made::mesh_of(positions, triangles);
}

/// Three long triangles, each over the next: seen from above no order puts them front to back.
inline Mesh cycle(float size, float height) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < 3; ++k) {
    const float angle = 2.0943951f * static_cast<float>(k);
    const auto place = [&](float x, float y, float z) {
      positions.push_back({size * (x * std::cos(angle) - z * std::sin(angle)), height + size * y,
                           size * (x * std::sin(angle) + z * std::cos(angle))});
    };
    place(-1, -0.1f, 0.2f), place(1, 0.1f, 0.2f), place(1, 0.1f, 0.5f);
    const auto first = static_cast<std::uint32_t>(3 * k);
    triangles.push_back({first, first + 1, first + 2});
  }
  return hand_made::mesh_of(positions, triangles);
}

/// Fills a picture with points of all triangles, rounded, turned to the light. Shares in sixteenths put half of them exactly on
/// edges, diagonals and planes of others, where these are on a grid.
inline void scatter(const Scene& scene, const Light& light, Random& random, hand_made::Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t m = random.below(static_cast<std::uint32_t>(scene.meshes.size()));
    const Mesh& mesh = scene.meshes[m];
    if (mesh.triangles.empty()) continue;
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 a(mesh.positions[corners.x]), b(mesh.positions[corners.y]), c(mesh.positions[corners.z]);
    const bool coarse = random.below(2);
    const double u = coarse ? random.below(17) / 16.0 : random.uniform(0, 1),
                 v = (coarse ? random.below(17) / 16.0 : random.uniform(0, 1)) * (1 - u);
    const glm::vec3 p(a + u * (b - a) + v * (c - a));
    glm::dvec3 n = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(n, to_light(homogeneous(light), p)) < 0) n = -n;
    picture.set(i, p, n, m, t);
  }
}

/// A scene as an eye sees it, with a lamp above, a sun from there and a lamp between the casters. The picture is larger than a
/// few tiles, and no multiple of one.
struct Viewed {
  Scene scene;
  GBuffer gbuffer;
  Light lights[3];
};
inline Viewed viewed(Random& random, std::mt19937& engine) {
  Viewed made;
  made.scene.meshes = {small_world::ground(3, 0), small_world::random_soup(engine, 40, 2, 0.1f, 2, 0.4f),
                       boxes(random, 5, false), cycle(1, 1)};
  const View view{.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.5, -4), glm::dvec3(4, 4, 4))), .target = {0, 0.5f, 0}};
  made.gbuffer = small_world::make_gbuffer(made.scene, view, 150, 83);
  const glm::vec3 up(random.uniform(glm::dvec3(-3, 2, -3), glm::dvec3(3, 5, 3)));
  const glm::vec3 between(random.uniform(glm::dvec3(-1, 0.5, -1), glm::dvec3(1, 1.5, 1)));
  made.lights[0] = hand_made::point_light(up), made.lights[1] = hand_made::sun(-up),
  made.lights[2] = hand_made::point_light(between);
  return made;
}

}  // namespace gnomon::hard_scenes
