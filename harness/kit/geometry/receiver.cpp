#include <gnomon/kit/geometry/receiver.h>

#include <algorithm>

namespace gnomon {

bool Receiver::is_coplanar(const Scene& scene, const glm::vec3* corners) const {
  return has_triangle() && coplanar(scene.meshes[mesh].corners(triangle), corners);
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

}  // namespace gnomon
