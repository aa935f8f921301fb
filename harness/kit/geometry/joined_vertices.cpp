#include <gnomon/kit/geometry/joined_vertices.h>

#include <array>
#include <bit>
#include <cassert>
#include <map>
#include <tuple>

namespace gnomon {

namespace {

/// Rigs with the same key move equal vertices alike.
using RigKey = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::size_t, std::array<double, 9>>;

std::size_t target_count(const Rig& rig) { return rig.base.empty() ? 0 : rig.targets.size() / rig.base.size(); }

RigKey key_of(const Rig& rig) {
  const auto& [scale, turn, offset] = rig.placement;
  const std::array<double, 9> placement{scale.x, scale.y, scale.z, turn.x, turn.y, turn.z, offset.x, offset.y, offset.z};
  return {rig.node, rig.skin, rig.joints_per_vertex, target_count(rig), placement};
}

/// A vertex of a mesh with a rig.
struct RigVertex {
  const Rig* rig;
  std::size_t vertex;    ///< of the mesh
  std::uint32_t number;  ///< over the scene
};

/// Both are of rigs with the same key.
bool move_alike(const RigVertex& a, const RigVertex& b) {
  const Rig &one = *a.rig, &other = *b.rig;
  if (one.base[a.vertex] != other.base[b.vertex]) return false;
  for (std::size_t k = 0; k < target_count(one); ++k)
    if (one.targets[k * one.base.size() + a.vertex] != other.targets[k * other.base.size() + b.vertex]) return false;
  for (std::size_t k = 0; k < one.joints_per_vertex; ++k) {
    const std::size_t i = a.vertex * one.joints_per_vertex + k, j = b.vertex * one.joints_per_vertex + k;
    if (one.weights[i] != other.weights[j] || (one.weights[i] != 0 && one.joints[i] != other.joints[j])) return false;
  }
  return true;
}

std::uint64_t hash_of(const glm::dvec3& p) {
  const auto b = std::bit_cast<std::array<std::uint64_t, 3>>(p + 0.0);  // minus zero becomes zero
  std::uint64_t hash = b[0] * 0x9e3779b97f4a7c15ull ^ b[1] * 0xc2b2ae3d27d4eb4full ^ b[2] * 0x165667b19e3779f9ull;
  hash ^= hash >> 29;
  hash *= 0xbf58476d1ce4e5b9ull;
  return hash ^ hash >> 32;
}

/// Open addressing. `vertices` rise by number.
void join(const std::vector<RigVertex>& vertices, std::vector<std::uint32_t>& first) {
  constexpr std::uint32_t empty = 0xffffffffu;
  std::vector<std::uint32_t> table(std::bit_ceil(2 * vertices.size() + 1), empty);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    const RigVertex& v = vertices[i];
    for (std::size_t place = hash_of(v.rig->base[v.vertex]) & (table.size() - 1);; place = (place + 1) & (table.size() - 1)) {
      if (table[place] == empty) table[place] = i;
      if (table[place] != i && !move_alike(vertices[table[place]], v)) continue;
      first[v.number] = vertices[table[place]].number;
      break;
    }
  }
}

}  // namespace

std::vector<std::uint32_t> join_vertices(const Scene& scene, std::span<const glm::vec3> positions,
                                         std::span<const std::uint8_t> wanted) {
  if (!scene.motion || scene.motion->rigs.empty()) return weld(positions, wanted);
  std::vector<const Rig*> rig_of(scene.meshes.size());
  for (const Rig& rig : scene.motion->rigs) rig_of[rig.mesh] = &rig;
  std::vector<std::uint8_t> still(wanted.begin(), wanted.end());
  std::map<RigKey, std::vector<RigVertex>> moving;
  std::uint32_t number = 0;  // of the first vertex of a mesh
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto count = static_cast<std::uint32_t>(scene.meshes[m].positions.size());
    if (const Rig* const rig = rig_of[m]) {
      assert(rig->base.size() == count);
      std::vector<RigVertex>& vertices = moving[key_of(*rig)];
      for (std::uint32_t v = 0; v < count; ++v) {
        still[number + v] = 0;
        if (wanted[number + v]) vertices.push_back({rig, v, number + v});
      }
    }
    number += count;
  }
  std::vector<std::uint32_t> first = weld(positions, still);
  for (const auto& [key, vertices] : moving) join(vertices, first);
  return first;
}

}  // namespace gnomon
