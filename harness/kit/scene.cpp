#include <gnomon/error.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace gnomon {

std::string_view kind_name(const Light& light) {
  static constexpr std::string_view names[] = {"point", "spot", "directional", "rect", "disc", "sphere"};
  return names[light.kind.index()];
}

bool has_area(const Light& light) { return light.kind.index() >= 3; }

glm::dvec4 homogeneous(const Light& light) {
  if (has_area(light)) throw Error("light {} is a {} light: it has an area and is not one point", light.name, kind_name(light));
  return homogeneous_of_center(light);
}

glm::dvec4 homogeneous_of_center(const Light& light) {
  struct Visitor {
    glm::dvec4 operator()(const PointLight& l) const { return {l.position, 1}; }
    glm::dvec4 operator()(const SpotLight& l) const { return {l.position, 1}; }
    glm::dvec4 operator()(const DirectionalLight& l) const { return {-l.direction, 0}; }
    glm::dvec4 operator()(const RectLight& l) const { return {l.center, 1}; }
    glm::dvec4 operator()(const DiscLight& l) const { return {l.center, 1}; }
    glm::dvec4 operator()(const SphereLight& l) const { return {l.center, 1}; }
  };
  return std::visit(Visitor{}, light.kind);
}

bool in_spot_cone(const Light& light, const glm::dvec3& point) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  if (!spot) return true;
  const glm::dvec3 away = point - glm::dvec3(spot->position);
  const double cosine = std::cos(glm::radians(static_cast<double>(spot->outer_degrees)));
  return glm::dot(away, glm::normalize(glm::dvec3(spot->direction))) > cosine * glm::length(away);
}

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

Bounds Mesh::reached() const {
  Bounds bounds = reach;
  if (bounds.empty()) bounds.add(positions);
  return bounds;
}

Bounds Scene::bounds() const {
  Bounds bounds;
  for (const Mesh& mesh : meshes) bounds.add(mesh.positions);
  return bounds;
}

bool Scene::has_curved_shapes() const { return std::ranges::any_of(meshes, &Mesh::has_curved_shape); }

bool Scene::has_transmission() const {
  return std::ranges::any_of(meshes, [](const Mesh& mesh) { return mesh.casts && mesh.transmission; });
}

bool Scene::has_colored_transmission() const {
  return std::ranges::any_of(
      meshes, [](const Mesh& mesh) { return mesh.casts && mesh.transmission && mesh.transmission->is_colored(); });
}

bool Scene::has_alpha_masks() const {
  return std::ranges::any_of(meshes, [](const Mesh& mesh) { return mesh.alpha_mask != nullptr; });
}

double extent(const Scene& scene, const Light& light, const View& view) {
  const glm::dvec4 l = homogeneous_of_center(light);
  glm::dvec3 reach(0);  // of the light from its center, along x, y and z
  if (const auto* rect = std::get_if<RectLight>(&light.kind))
    reach = glm::abs(glm::dvec3(rect->half_u)) + glm::abs(glm::dvec3(rect->half_v));
  if (const auto* disc = std::get_if<DiscLight>(&light.kind)) reach = glm::dvec3(disc->radius);
  if (const auto* sphere = std::get_if<SphereLight>(&light.kind)) reach = glm::dvec3(sphere->radius);
  return std::max({scene.bounds().extent(), extent(view.eye), l.w != 0 ? extent(glm::abs(glm::dvec3(l)) + reach) : 0});
}

// Open addressing.
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions, std::span<const std::uint8_t> wanted) {
  constexpr std::uint32_t empty = 0xffffffffu;
  std::vector<std::uint32_t> first(positions.size()), table(std::bit_ceil(2 * positions.size() + 1), empty);
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    first[v] = v;
    if (!wanted.empty() && !wanted[v]) continue;
    const auto b = std::bit_cast<std::array<std::uint32_t, 3>>(positions[v] + 0.0f);  // minus zero becomes zero
    std::uint64_t hash = b[0] * 0x9e3779b97f4a7c15ull ^ b[1] * 0xc2b2ae3d27d4eb4full ^ b[2] * 0x165667b19e3779f9ull;
    hash ^= hash >> 29;
    hash *= 0xbf58476d1ce4e5b9ull;
    hash ^= hash >> 32;
    for (std::size_t place = hash & (table.size() - 1);; place = (place + 1) & (table.size() - 1)) {
      if (table[place] == empty) table[place] = v;
      if (table[place] != v && positions[table[place]] != positions[v]) continue;
      first[v] = table[place];
      break;
    }
  }
  return first;
}

// Float differences and their products are exact in quadruple precision unless exponents differ by more than 60 bits, where no
// float32 scene of finite size lives. Most triangles are so far from it that double, whose differences and products err by
// 2^-53 of themselves, is sure.
bool is_degenerate(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  const glm::dvec3 u = glm::dvec3(b) - glm::dvec3(a), v = glm::dvec3(c) - glm::dvec3(a);
  const auto surely_differ = [](double p, double q) { return std::abs(p - q) > 0x1p-49 * (std::abs(p) + std::abs(q)); };
  if (surely_differ(u.y * v.z, u.z * v.y) || surely_differ(u.z * v.x, u.x * v.z) || surely_differ(u.x * v.y, u.y * v.x))
    return false;
  using Quad = __float128;
  const Quad ux = Quad(b.x) - a.x, uy = Quad(b.y) - a.y, uz = Quad(b.z) - a.z;
  const Quad vx = Quad(c.x) - a.x, vy = Quad(c.y) - a.y, vz = Quad(c.z) - a.z;
  return uy * vz == uz * vy && uz * vx == ux * vz && ux * vy == uy * vx;
}

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
  const std::size_t dropped = std::erase_if(mesh.triangles, [&](const glm::uvec3& t) {
    return is_degenerate(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
  });
  mesh.facts = measure_facts(mesh.positions, mesh.triangles);
  mesh.facts.degenerate_count = dropped;
}

}  // namespace gnomon
