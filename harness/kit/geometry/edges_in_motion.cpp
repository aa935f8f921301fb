// An edge adjacency that follows the poses of its scene: what is joined never depends on the pose.
#include <gnomon/kit/geometry/edges.h>

#include <algorithm>
#include <cassert>
#include <numeric>

namespace gnomon {

/// Meshes are numbered by the first of those that they are joined with, over any number of others.
void EdgeAdjacency::find_groups() {
  std::vector<std::uint32_t> leader(meshes_.size());
  std::iota(leader.begin(), leader.end(), 0u);
  const auto find = [&](std::uint32_t m) {
    while (leader[m] != m) m = leader[m] = leader[leader[m]];
    return m;
  };
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
    const std::uint32_t begin = meshes_[m].first_vertex;
    for (std::uint32_t v = begin; v < begin + meshes_[m].vertex_count; ++v) {
      const std::uint32_t first = first_at_position_[v];
      if (first >= begin) continue;
      const auto after = std::ranges::upper_bound(meshes_, first, {}, &MeshTriangles::first_vertex);
      const std::uint32_t a = find(static_cast<std::uint32_t>(after - meshes_.begin()) - 1), b = find(m);
      leader[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) meshes_[m].group = find(m);
}

bool EdgeAdjacency::can_follow(const Changes& changes) const {
  if (!joins_by_rigs_ || changes.meshes.size() != meshes_.size()) return false;
  for (std::size_t m = 0; m < meshes_.size(); ++m)
    if (changes.meshes[m].kind != MeshChange::Kind::still && meshes_[m].casts && !meshes_[m].has_rig) return false;
  return true;
}

EdgeAdjacency::Moved EdgeAdjacency::move(const Scene& scene, const Changes& changes) {
  assert(can_follow(changes) && scene.meshes.size() == meshes_.size());
  std::vector<std::uint8_t> has_moved(meshes_.size());  // of each group
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    const MeshChange& change = changes.meshes[m];
    if (change.kind == MeshChange::Kind::still) continue;
    MeshTriangles& mesh = meshes_[m];
    const std::vector<glm::vec3>& from = scene.meshes[m].positions;
    assert(from.size() == mesh.vertex_count && change.first + change.count <= mesh.vertex_count);
    std::copy_n(from.begin() + change.first, change.count, positions_.begin() + mesh.first_vertex + change.first);
    mesh.bounds = {};
    mesh.bounds.add(from);
    has_moved[mesh.group] = 1;
  }
  extent_ = 0;
  Moved moved;
  for (std::uint32_t m = 0; m < meshes_.size(); ++m) {
    extent_ = std::max(extent_, meshes_[m].bounds.extent());
    if (has_moved[meshes_[m].group]) moved.push_back(m);
  }
  for (const std::uint32_t m : moved) {
    const MeshTriangles& mesh = meshes_[m];
    for (std::uint32_t t = mesh.first; t < mesh.first + mesh.count; ++t) {
      if (part_of_[t] == no_part) continue;
      parts_[part_of_[t]].bounds = {};
      parts_[part_of_[t]].volume = 0;
    }
    find_planes(mesh.first, mesh.count);
  }
  for (const std::uint32_t m : moved) add_bounds(meshes_[m]);
  for (const std::uint32_t m : moved) add_volumes(meshes_[m]);
  return moved;
}

}  // namespace gnomon
