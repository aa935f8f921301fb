#pragma once
#include <gnomon/scene.h>

#include <cstdint>
#include <vector>

namespace gnomon {

/// The bit of a mesh's first triangle that says that it stands for a curved shape.
inline constexpr std::uint32_t shape_bit = 0x80000000u;

/// For shaders that count triangles over the scene: of each mesh the number of its first triangle, with `shape_bit` where the
/// mesh has a curved shape; then how many triangles there are.
inline std::vector<std::uint32_t> first_triangles(const Scene& scene) {
  std::vector<std::uint32_t> firsts;
  std::uint32_t count = 0;
  for (const Mesh& mesh : scene.meshes) {
    firsts.push_back(count | (mesh.has_curved_shape() ? shape_bit : 0));
    count += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  firsts.push_back(count);
  return firsts;
}

}  // namespace gnomon
