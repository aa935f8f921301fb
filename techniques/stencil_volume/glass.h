#pragma once
#include <gnomon/kit/volumes/volume_technique.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "found_faces.h"

namespace stencil_volume {

// Casters with transmission. What n surfaces that each let the share t through leave is t^n, and a stencil can count to n: the
// casters of one t are a group with a count of its own. Opaque casters are a group, too, whose count is only compared with 0.
// The triangles of glass have no inside: all of them count, and an edge of the outline starts as many sides as layers end
// there.

/// How many groups of glass are drawn at most, one pass over all its volumes each.
inline constexpr std::size_t most_transmissions = 8;

/// What casters let through: 0 where they block. With texels, that of the first.
inline float transmission_of(const Mesh& mesh) { return mesh.transmission ? mesh.transmission->at(0, 0).x : 0; }

/// Of the casters of a scene, each once, rising; what lets all light through is none, and what lets none through opaque.
inline std::vector<float> transmissions_in(const Scene& scene) {
  std::vector<float> all;
  for (const Mesh& mesh : scene.meshes)
    if (const float t = transmission_of(mesh); mesh.casts && t > 0 && t < 1) all.push_back(t);
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// Full where every caster can be in a group.
inline Support supports_glass(const Scene& scene) {
  const auto has_texels = [](const Mesh& mesh) { return mesh.casts && mesh.transmission && !mesh.transmission->is_constant(); };
  if (const auto found = std::ranges::find_if(scene.meshes, has_texels); found != scene.meshes.end())
    return Support::unsupported(
        fmt::format("the transmission of mesh {} has texels: a stencil count is a power of one number", found->name));
  if (const std::size_t count = transmissions_in(scene).size(); count > most_transmissions)
    return Support::unsupported(
        fmt::format("casters have {} transmissions, each with a count of its own; at most {}", count, most_transmissions));
  return Support::full();
}

/// Calls visit(transmission, scene) for opaque casters, whose transmission is 0, and then for each group of glass, with a scene
/// in which nothing else casts. Meshes and triangles keep their numbers. A scene without glass is visited itself.
template <std::invocable<float, const Scene&> Visit>
void for_groups(const Scene& scene, const Visit& visit) {
  if (!scene.has_transmission()) return visit(0.0f, scene);
  Scene part = scene;
  std::vector<float> groups = transmissions_in(scene);
  groups.insert(groups.begin(), 0.0f);
  for (const float group : groups) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
      part.meshes[m].casts = scene.meshes[m].casts && transmission_of(scene.meshes[m]) == group;
    visit(group, part);
  }
}

/// A group of glass.
struct GlassGroup {
  float transmission;
  EdgeAdjacency adjacency;
  GpuFinder gpu_finder;
  EdgeAdjacency::Moved moved = {};  ///< by the last update
  std::size_t bytes() const { return adjacency.bytes() + gpu_finder.bytes(); }
};

/// How many surfaces of a group lie on any way to the light, at most.
inline std::size_t most_surfaces(const GlassGroup& group, const Found& found) {
  const auto triangles = static_cast<std::int64_t>(group.adjacency.triangles().size());
  return static_cast<std::size_t>(std::clamp<std::int64_t>(found.depth_bound, 0, triangles));
}

/// What a light makes of a group of glass.
struct GroupFaces {
  Found found;
  Silhouette silhouette;
  FaceBuffers faces;
  bool wide = false;                ///< counted in 32 bits
  Buffer powers;                    ///< of its transmission, as powers_of gives them
  std::int64_t volumes_at_eye = 0;  ///< of the last resolve, for zpass_plus
  std::size_t bytes() const { return silhouette.bytes() + faces.bytes() + powers.bytes; }
};

}  // namespace stencil_volume
