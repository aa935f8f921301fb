#pragma once
#include <gnomon/changes.h>

#include <algorithm>

// When trees over triangles that move are refitted, and when they are built anew. A refit gives boxes the places of what they
// hold and keeps which holds which; answers are those of any other tree.
namespace gnomon {

/// A tree is built anew where its cost by the surface area heuristic is so many times what it was when it was built. No clock
/// decides, so that the same poses give the same trees: docs/decisions/refit.md.
inline constexpr double rebuild_cost = 1.4;

/// A tree that had no area when it was built has decayed as soon as it has one.
inline bool is_decayed(double cost, double built_cost) { return cost > rebuild_cost * built_cost; }

/// Whether a scene is one of a row whose meshes move: what holds a tree of it then prepares for updates.
inline bool follows_animation(const Scene& scene) {
  return std::ranges::any_of(scene.meshes, [](const Mesh& mesh) { return !mesh.reach.empty(); });
}

inline bool has_moved(const Changes& changes, std::uint32_t mesh) {
  return changes.meshes[mesh].kind != MeshChange::Kind::still;
}

inline bool has_moved_caster(const Scene& scene, const Changes& changes) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    if (scene.meshes[m].casts && has_moved(changes, m)) return true;
  return false;
}

}  // namespace gnomon
