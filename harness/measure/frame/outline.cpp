#include "measure/frame/outline.h"

#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>

#include "measure/frame/light_rays.h"

namespace gnomon {

namespace {

/// The unit vector, or zero where there is none.
glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

/// Adds the band of the edge from a to b. Its sides are parallel to the plane of edge and light; seen from the light it is a
/// rectangle, also where the edge runs toward the light.
void add_band(Mesh& bands, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec4& light, double radius) {
  if (a == b) return;
  const glm::dvec3 from_a = to_light(light, a), from_b = to_light(light, b);
  glm::dvec3 aside = glm::cross(glm::normalize(b - a), unit_or_zero(from_a));
  if (glm::length(aside) < 1e-12) aside = across(unit_or_zero(from_a == glm::dvec3(0) ? from_b : from_a))[0];
  aside = radius * glm::normalize(aside);
  const glm::dvec3 beyond_a = a - radius * unit_or_zero(glm::cross(from_a, aside)),
                   beyond_b = b + radius * unit_or_zero(glm::cross(from_b, aside));
  const auto first = static_cast<std::uint32_t>(bands.positions.size());
  for (const glm::dvec3& corner : {beyond_a - aside, beyond_a + aside, beyond_b - aside, beyond_b + aside})
    bands.positions.emplace_back(corner);
  bands.triangles.insert(bands.triangles.end(), {{first, first + 1, first + 2}, {first + 1, first + 3, first + 2}});
}

}  // namespace

Outline::Outline(const RayScene& casters, const glm::dvec4& light, double radius, const LitWays& ways) {
  const EdgeAdjacency& adjacency = casters.adjacency();
  Silhouette silhouette;
  adjacency.find_silhouette(light, silhouette);
  constexpr std::size_t block = 1 << 16;
  std::vector<std::vector<SilhouetteEdge>> touched((silhouette.edges.size() + block - 1) / block);
  const auto place = [&](std::uint32_t vertex) { return glm::dvec3(adjacency.positions()[vertex]); };
  for_blocks(silhouette.edges.size(), block, [&](std::size_t begin, std::size_t end) {
    for (const SilhouetteEdge& edge : std::span(silhouette.edges).subspan(begin, end - begin))
      if (ways.may_touch(place(edge.low), place(edge.high))) touched[begin / block].push_back(edge);
  });
  Mesh& bands = bands_.meshes.emplace_back();
  for (const std::vector<SilhouetteEdge>& edges : touched)
    for (const SilhouetteEdge& edge : edges) add_band(bands, place(edge.low), place(edge.high), light, radius);
  if (!bands.triangles.empty()) rays_.emplace(bands_, Truth::mesh, RayScene::Which::seen);
}

std::uint32_t Outline::met(std::uint32_t valid, ShadowPacket& packet) const {
  std::uint32_t mesh[16];
  std::ranges::fill(mesh, no_mesh);
  return rays_ && valid ? rays_->occluded(valid, packet, {mesh, mesh}) : 0;
}

}  // namespace gnomon
