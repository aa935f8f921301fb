#include <gnomon/kit/receiver.h>

#include <algorithm>

namespace gnomon {

Receiver receiver_at(const Scene& scene, const GBuffer& gbuffer, std::size_t i) {
  const std::uint32_t mesh = gbuffer.mesh[i];
  const bool is_on_shape = mesh != no_mesh && gbuffer.truth == Truth::shape && scene.meshes[mesh].has_curved_shape();
  return {gbuffer.position(i), mesh, is_on_shape ? Receiver::whole_mesh : gbuffer.triangle[i]};
}

bool Receiver::is_coplanar(const Scene& scene, const glm::vec3* corners) const {
  if (!has_triangle()) return false;
  const Mesh& own = scene.meshes[mesh];
  const glm::uvec3& t = own.triangles[triangle];
  return coplanar({{own.positions[t.x], own.positions[t.y], own.positions[t.z]}}, corners);
}

TriangleNumbers::TriangleNumbers(const Scene& scene) {
  std::uint32_t count = 0;
  for (const Mesh& mesh : scene.meshes) {
    first_.push_back(count);
    count += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  first_.push_back(count);
}

// The last mesh that begins here or before: one without triangles begins where the next one does.
std::uint32_t TriangleNumbers::mesh_of(std::uint32_t number) const {
  return static_cast<std::uint32_t>(std::ranges::upper_bound(first_, number) - first_.begin() - 1);
}

NumberedReceiver TriangleNumbers::numbered(const Receiver& r) const {
  if (r.mesh == no_mesh) return {r, 0, 0};
  if (r.triangle == Receiver::whole_mesh) return {r, first_of(r.mesh), end_of(r.mesh) - first_of(r.mesh)};
  return {r, first_of(r.mesh) + r.triangle, 1};
}

}  // namespace gnomon
