#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/random.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <vector>

// Random casters that are hard on shadow volumes: open, inside out, wound against each other, doubled, of many triangles at
// one edge, and connected in the middle of an edge.
namespace volume_scenes {
using namespace gnomon;

inline glm::vec3 random_point(Random& random, const glm::vec3& low, const glm::vec3& high) {
  return glm::vec3(random.uniform(glm::dvec3(low), glm::dvec3(high)));
}

inline Mesh mesh_of(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  finish(mesh);
  return mesh;
}

/// Loose triangles around random centers.
inline Mesh soup(Random& random, int count, const glm::vec3& low, const glm::vec3& high, float size) {
  std::vector<glm::vec3> p;
  std::vector<glm::uvec3> t;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    const glm::vec3 center = random_point(random, low, high);
    for (int k = 0; k < 3; ++k) p.push_back(center + random_point(random, glm::vec3(-size), glm::vec3(size)));
    t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh_of(p, t);
}

/// Closed, counter-clockwise seen from outside.
inline Mesh tetrahedron(const glm::vec3& a, glm::vec3 b, glm::vec3 c, const glm::vec3& d) {
  if (glm::dot(glm::cross(b - a, c - a), d - a) > 0) std::swap(b, c);
  return mesh_of({a, b, c, d}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}});
}

/// A box with its faces cut along random diagonals, turned about y: closed, counter-clockwise seen from outside.
inline Mesh turned_box(Random& random, const glm::vec3& center, const glm::vec3& half) {
  const double angle = random.uniform(0, 1.5);
  std::vector<glm::vec3> p;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 q(i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z);
    p.push_back(center + glm::vec3(glm::dvec3(q.x * std::cos(angle) - q.z * std::sin(angle), q.y,
                                              q.x * std::sin(angle) + q.z * std::cos(angle))));
  }
  const std::uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::vector<glm::uvec3> t;
  for (const auto& f : faces) {
    const std::uint32_t k = random.below(2);
    t.push_back({f[k], f[k + 1], f[k + 2]}), t.push_back({f[k], f[k + 2], f[(k + 3) % 4]});
  }
  return mesh_of(p, t);
}

/// `count` triangles at one edge.
inline Mesh book(Random& random, int count, const glm::vec3& low, const glm::vec3& high) {
  std::vector<glm::vec3> p{random_point(random, low, high), random_point(random, low, high)};
  std::vector<glm::uvec3> t;
  for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(count); ++i) {
    p.push_back(random_point(random, low, high));
    t.push_back(random.below(2) ? glm::uvec3(0, 1, 2 + i) : glm::uvec3(1, 0, 2 + i));
  }
  return mesh_of(p, t);
}

/// A triangle whose edge meets two others at its middle: a crack of the input. The middle is rounded, so it may gape.
inline Mesh t_junction(Random& random, const glm::vec3& low, const glm::vec3& high) {
  const glm::vec3 a = random_point(random, low, high), b = random_point(random, low, high), c = random_point(random, low, high);
  return mesh_of({a, b, c, (a + b) / 2.0f, random_point(random, low, high)}, {{0, 1, 2}, {3, 0, 4}, {1, 3, 4}});
}

inline void flip(glm::uvec3& t) { std::swap(t.y, t.z); }
inline void turn_inside_out(Mesh& mesh) { std::ranges::for_each(mesh.triangles, flip), finish(mesh); }

/// Takes some triangles away and turns some others round.
inline void damage(Random& random, Mesh& mesh) {
  std::erase_if(mesh.triangles, [&](const glm::uvec3&) { return mesh.triangles.size() > 2 && random.below(5) == 0; });
  for (glm::uvec3& t : mesh.triangles)
    if (random.below(5) == 0) flip(t);
  finish(mesh);
}

/// Adds copies of some triangles, each turned round or not, with the corners in the same order otherwise.
inline void double_some(Random& random, Mesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (random.below(4)) continue;
    mesh.triangles.push_back(mesh.triangles[i]);
    if (random.below(2)) flip(mesh.triangles.back());
  }
  finish(mesh);
}

/// Which kinds of casters a scene may hold.
struct Kinds {
  bool closed = true;     ///< tetrahedra and boxes, wound either way
  bool open = true;       ///< loose triangles, and closed meshes with triangles missing and turned round
  bool manifold = false;  ///< no triangles twice or at one edge by three
  bool t_junctions = true;
};

/// `count` casters between the corners of a box, each a mesh of its own. None of them crosses itself if it is closed.
inline std::vector<Mesh> random_casters(Random& random, int count, const glm::vec3& low, const glm::vec3& high,
                                        const Kinds& kinds = {}) {
  const glm::vec3 size = (high - low) / 5.0f;
  std::vector<Mesh> meshes;
  while (static_cast<int>(meshes.size()) < count) {
    const glm::vec3 center = random_point(random, low + size, high - size), a = center - size, b = center + size;
    const auto point = [&] { return random_point(random, a, b); };
    Mesh mesh;
    switch (random.below(6)) {
      case 0: {
        const glm::vec3 p = point(), q = point(), r = point();
        mesh = tetrahedron(p, q, r, point());
        break;
      }
      case 1:
      case 2:
        mesh = turned_box(random, center, random_point(random, size / 4.0f, size / 1.5f));
        break;
      case 3:
        mesh = soup(random, 3 + static_cast<int>(random.below(6)), a, b, std::min({size.x, size.y, size.z}) * 0.8f);
        break;
      case 4:
        mesh = book(random, 3 + static_cast<int>(random.below(3)), a, b);
        if (kinds.manifold) continue;
        break;
      default:
        mesh = t_junction(random, a, b);
        if (!kinds.t_junctions) continue;
    }
    const bool closed = mesh.facts.closed();
    if (closed && kinds.open && (!kinds.closed || random.below(2))) {
      damage(random, mesh);
    } else if (closed ? !kinds.closed : !kinds.open) {
      continue;
    } else if (closed && random.below(3) == 0) {
      turn_inside_out(mesh);
    }
    if (kinds.open && !kinds.manifold && random.below(3) == 0) double_some(random, mesh);
    meshes.push_back(mesh);
  }
  return meshes;
}

/// Moves every vertex to the nearest multiple of `step`, a power of two: then coplanar and collinear points happen.
inline void snap(Mesh& mesh, float step) {
  for (glm::vec3& p : mesh.positions) p = glm::round(p / step) * step;
  finish(mesh);
}

inline Triangle corners(const Mesh& mesh, std::size_t t) {
  const glm::uvec3& v = mesh.triangles[t];
  return {{mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]}};
}

inline Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

/// The light is rounded to floats, widened: what `homogeneous` gives.
inline Silhouette silhouette_of(const EdgeAdjacency& adjacency, const glm::dvec4& light) {
  Silhouette out;
  adjacency.find_silhouette(glm::dvec4(glm::vec4(light)), out);
  return out;
}

/// A light of each kind around and inside |x| < reach.
inline std::vector<glm::dvec4> random_lights(Random& random, float reach) {
  return {glm::dvec4(random_point(random, glm::vec3(-4 * reach), glm::vec3(4 * reach)), 1),
          glm::dvec4(random_point(random, glm::vec3(-0.9f * reach), glm::vec3(0.9f * reach)), 1),
          glm::dvec4(random_point(random, glm::vec3(-1), glm::vec3(1)), 0)};
}

}  // namespace volume_scenes
