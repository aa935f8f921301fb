#include <gnomon/kit/weld.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

std::string_view kind_name(const Shape& shape) {
  static constexpr std::string_view names[] = {"sphere", "cone", "disc", "triangle", "plane", "box"};
  return names[shape.index()];
}

bool is_curved(const Shape& shape) { return shape.index() <= 2; }

std::size_t Scene::triangle_count() const {
  std::size_t count = 0;
  for (const Mesh& mesh : meshes) count += mesh.triangles.size();
  return count;
}

Bounds Scene::bounds() const {
  Bounds bounds;
  for (const Mesh& mesh : meshes)
    for (const glm::vec3& p : mesh.positions) bounds.add(p);
  return bounds;
}

bool Scene::has_curved_shapes() const {
  return std::any_of(meshes.begin(), meshes.end(), [](const Mesh& mesh) { return mesh.has_curved_shape(); });
}

double extent(const Scene& scene, const Light& light, const View& view) {
  const auto largest = [](const glm::vec3& p) {
    return static_cast<double>(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
  };
  const Bounds bounds = scene.bounds();
  double extent = std::max({largest(bounds.min), largest(bounds.max), largest(view.eye)});
  if (const glm::dvec4 l = homogeneous(light); l.w != 0) extent = std::max(extent, largest(glm::vec3(l)));
  return extent;
}

namespace {

/// Exact: float differences and their products are exact in quadruple precision unless exponents differ by more than 60 bits,
/// where no float32 scene of finite size lives.
bool is_degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  using Quad = __float128;
  const Quad ux = Quad(b.x) - a.x, uy = Quad(b.y) - a.y, uz = Quad(b.z) - a.z;
  const Quad vx = Quad(c.x) - a.x, vy = Quad(c.y) - a.y, vz = Quad(c.z) - a.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

}  // namespace

MeshFacts measure_facts(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles) {
  const std::vector<std::uint32_t> first = weld(positions);
  // One key per directed edge: the undirected edge in the high bits, the direction in the lowest.
  std::vector<std::uint64_t> edges;
  edges.reserve(3 * triangles.size());
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t a = first[t[k]], b = first[t[(k + 1) % 3]];
      edges.push_back(std::min(a, b) << 33 | std::max(a, b) << 1 | (a > b));
    }
  std::sort(edges.begin(), edges.end());
  MeshFacts facts;
  for (std::size_t i = 0, j; i < edges.size(); i = j) {
    for (j = i; j < edges.size() && edges[j] >> 1 == edges[i] >> 1;) ++j;
    facts.boundary_edge_count += j - i == 1;
    facts.nonmanifold_edge_count += j - i > 2;
    facts.misoriented_edge_count += j - i == 2 && edges[i] == edges[i + 1];
  }
  return facts;
}

void finish(Mesh& mesh) {
  const auto degenerate = [&](const glm::uvec3& t) {
    return is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
  };
  const std::size_t dropped = std::erase_if(mesh.triangles, degenerate);
  mesh.facts = measure_facts(mesh.positions, mesh.triangles);
  mesh.facts.degenerate_count = dropped;
}

}  // namespace gnomon
