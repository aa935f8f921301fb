#pragma once
// Scenes that are hard on object precision, points on them whose light is in question, and what the exact oracle says.
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/shapes.h>

#include "hard_scenes.h"

namespace gnomon::questions {

// Where points are located among made corners, an epsilon of 1e-10 of the extent decides. A point nearer to an edge or to
// another caster than a hundred times that is not tested.
constexpr double unasked = 1e-8;

struct Question {
  std::size_t pixel;
  bool blocked;
  bool degenerate;  ///< the way to the light goes exactly through an edge or a vertex, and through nothing else
  bool clear;       ///< far from every edge and caster that could change the answer
};

/// A scene, a light, and points of all triangles that face it.
struct Case {
  Scene scene;
  Light light;
  hand_made::Picture picture{40, 10};
  std::vector<Question> questions;
  double extent = 0;  ///< largest coordinate of scene and light, meters
};

inline Triangle corners(const Mesh& mesh, std::uint32_t t) {
  const glm::uvec3& v = mesh.triangles[t];
  return {{mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]}};
}

/// Distance of a point from a triangle, in double.
inline double distance(const glm::dvec3& p, const Triangle& triangle) {
  const glm::dvec3 corner[3] = {triangle.points[0], triangle.points[1], triangle.points[2]};
  const glm::dvec3 n = glm::normalize(glm::cross(corner[1] - corner[0], corner[2] - corner[0]));
  double nearest = INFINITY;
  bool inside = true;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 a = corner[k], edge = corner[(k + 1) % 3] - a;
    inside &= glm::dot(glm::cross(n, edge), p - a) >= 0;
    const double along = std::clamp(glm::dot(p - a, edge) / glm::dot(edge, edge), 0.0, 1.0);
    nearest = std::min(nearest, glm::length(p - a - along * edge));
  }
  return inside ? std::abs(glm::dot(n, p - corner[0])) : nearest;
}

/// Whether the point lies on, or almost on, a caster out of the plane of its own triangle.
inline bool touches_another(const Scene& scene, const Receiver& receiver, double limit) {
  const Triangle own = corners(scene.meshes[receiver.mesh], receiver.triangle);
  for (const Mesh& mesh : scene.meshes)
    for (std::uint32_t t = 0; mesh.casts && t < mesh.triangles.size(); ++t) {
      const Triangle other = corners(mesh, t);
      if (distance(receiver.point, other) > limit) continue;
      const auto on_plane = [&](const glm::vec3& p) { return coplanar(own.points[0], own.points[1], own.points[2], p); };
      if (!std::ranges::all_of(other.points, on_plane)) return true;
    }
  return false;
}

/// Calls the oracle for every pixel that faces the light.
inline void ask(Case& c) {
  c.extent = gnomon::extent(c.scene, c.light, c.picture.gbuffer.view);
  const ExactScene exact(c.scene);
  const glm::dvec4 light = homogeneous(c.light);
  const double limit = unasked * c.extent;
  ExactTally tally;
  for (std::size_t i = 0; i < c.picture.gbuffer.size(); ++i) {
    if (!faces_light(c.scene, c.picture.gbuffer, c.light, i)) continue;
    const Receiver receiver = receiver_at(c.scene, c.picture.gbuffer, i);
    const ExactAnswer answer = exact.occluded(receiver, light, tally);
    const bool clear = !answer.degenerate && exact.edge_margin(receiver, light, limit).clearance > limit &&
                       !touches_another(c.scene, receiver, limit);
    c.questions.push_back({i, answer.blocked, answer.degenerate, clear});
  }
}

/// Moves every vertex to the lattice of 2^-7 m.
inline void snap(Mesh& mesh) {
  for (glm::vec3& p : mesh.positions)
    for (int k = 0; k < 3; ++k) p[k] = std::round(p[k] * 0x1p7f) * 0x1p-7f;
  finish(mesh);
}

/// A point exactly on a triangle of the lattice, up to 16 m from the origin, every place alike: its barycentric numbers are
/// multiples of `step` / 1024, so its coordinates are multiples of 2^-17 up to 2^4, which float32 holds.
inline glm::vec3 lattice_point(const Triangle& triangle, Random& random, std::uint32_t step = 1) {
  std::uint32_t a = step * random.below(1024 / step + 1), b = step * random.below(1024 / step + 1);
  if (a + b > 1024) a = 1024 - a, b = 1024 - b;
  const glm::dvec3 p[3] = {triangle.points[0], triangle.points[1], triangle.points[2]};
  return glm::vec3((static_cast<double>(a) * p[0] + static_cast<double>(b) * p[1] + (1024.0 - a - b) * p[2]) / 1024.0);
}

/// Points of all triangles, exactly on them; every fourth on edges and diagonals, and many so on planes of others.
inline void scatter_on_lattice(const Scene& scene, const Light& light, Random& random, hand_made::Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t m = random.below(static_cast<std::uint32_t>(scene.meshes.size()));
    const Mesh& mesh = scene.meshes[m];
    if (mesh.triangles.empty()) continue;
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const Triangle triangle = corners(mesh, t);
    const glm::vec3* p = triangle.points;
    const glm::vec3 point = lattice_point(triangle, random, random.below(4) == 0 ? 128 : 1);
    const int side = orient3d_sign(p[0], p[1], p[2], homogeneous(light));
    glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(p[1]) - glm::dvec3(p[0]), glm::dvec3(p[2]) - glm::dvec3(p[0])));
    picture.set(i, point, side < 0 ? -n : n, m, t);
  }
}

/// Long triangles as wide as one step of the lattice.
inline Mesh slivers(Random& random, int count) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 a = hard_scenes::on_grid(random, 2, 64), b = hard_scenes::on_grid(random, 2, 64);
    glm::vec3 c = b;
    c[static_cast<int>(random.below(3))] += 0x1p-7f;
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }
  return hand_made::mesh_of(positions, triangles);
}

/// Triangles over each other in three planes: level ones and a tilted one.
inline Mesh stacks(Random& random, int count) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    const std::uint32_t plane = random.below(3);
    for (int k = 0; k < 3; ++k) {
      glm::vec3 p = hard_scenes::on_grid(random, 2, 16);
      p.y = plane == 0 ? 0.5f : plane == 1 ? 1 : (p.x + 2 * p.z) / 4;
      positions.push_back(p);
    }
    triangles.push_back(random.below(2) ? glm::uvec3(first, first + 1, first + 2) : glm::uvec3(first, first + 2, first + 1));
  }
  return hand_made::mesh_of(positions, triangles);
}

/// Every triangle once more, or twice, wound either way, with vertices of its own.
inline Mesh doubled(const Mesh& mesh, Random& random) {
  std::vector<glm::vec3> positions = mesh.positions;
  std::vector<glm::uvec3> triangles = mesh.triangles;
  for (const glm::uvec3& t : mesh.triangles)
    for (std::uint32_t copies = random.below(3); copies > 0; --copies) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), {mesh.positions[t.y], mesh.positions[t.z], mesh.positions[t.x]});
      triangles.push_back(copies == 1 ? glm::uvec3(first, first + 1, first + 2) : glm::uvec3(first, first + 2, first + 1));
    }
  return hand_made::mesh_of(positions, triangles);
}

inline Mesh ball(int segments) {
  Mesh mesh = tessellate(Sphere{{0.25f, 0.5f, 0}, 1}, segments, "ball");
  mesh.shape.reset();
  return mesh;
}

constexpr int kinds = 8;

inline Mesh hard_mesh(int kind, int round, Random& random) {
  switch (kind) {
    case 0:
      return hard_scenes::grid_soup(random, 2 + round % 40);
    case 1:
      return hard_scenes::boxes(random, 1 + round % 6, false);
    case 2:
      return hard_scenes::boxes(random, 1 + round % 6, true);
    case 3:
      return slivers(random, 2 + round % 40);
    case 4:
      return stacks(random, 2 + round % 20);
    case 5:
      return doubled(hard_scenes::grid_soup(random, 1 + round % 12), random);
    case 6:
      return hard_scenes::cycle(2, 0.5f);
    default:
      return ball(4 + round % 12);
  }
}

/// A point light, a spot or a sun; every fourth in the plane of one of the triangles.
inline Light hard_light(const Mesh& mesh, Random& random) {
  for (;;) {
    glm::vec3 at = hard_scenes::on_grid(random, 4, 16);
    const std::uint32_t kind = random.below(3);
    if (!mesh.triangles.empty() && random.below(4) == 0) {
      const Triangle t = corners(mesh, random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
      const float u = static_cast<float>(random.below(7)) - 3, v = static_cast<float>(random.below(7)) - 3;
      at = (kind == 1 ? glm::vec3(0) : t.points[0]) + u * (t.points[1] - t.points[0]) + v * (t.points[2] - t.points[0]);
    }
    if (at == glm::vec3(0) || std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) > 16) continue;
    if (kind == 0) return {.name = "spot", .kind = SpotLight{at, -at, 20, 10.0f + static_cast<float>(random.below(70))}};
    return kind == 1 ? hand_made::sun(at) : hand_made::point_light(at);
  }
}

/// `on_lattice`: points exactly on their triangles; else rounded ones, on triangles of any coordinates.
inline std::unique_ptr<Case> make(int round, bool on_lattice, Random& random) {
  auto c = std::make_unique<Case>();
  c->scene.meshes = {hard_mesh(round % kinds, round / kinds, random), hand_made::square(6, -2)};
  if (random.below(2)) c->scene.meshes.push_back(hard_scenes::grid_soup(random, 3));
  if (!on_lattice) {
    const glm::dvec3 aside = random.uniform(glm::dvec3(-1), glm::dvec3(1));
    for (Mesh& mesh : c->scene.meshes)
      for (glm::vec3& p : mesh.positions) p = glm::vec3(1.1 * glm::dvec3(p) + aside);
  }
  for (Mesh& mesh : c->scene.meshes) {
    on_lattice ? snap(mesh) : finish(mesh);
    mesh.casts = random.below(8) != 0;
    mesh.receives = random.below(8) != 0;
  }
  c->light = hard_light(c->scene.meshes[0], random);
  (on_lattice ? scatter_on_lattice : hard_scenes::scatter)(c->scene, c->light, random, c->picture);
  ask(*c);
  return c;
}

}  // namespace gnomon::questions
