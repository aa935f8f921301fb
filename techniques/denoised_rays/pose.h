#pragma once
#include <gnomon/changes.h>

#include <memory>
#include <vector>

namespace gnomon::denoised_rays {

/// Where the vertices of a scene were at one time. Poses share the arrays of meshes that did not move between them.
class Pose {
 public:
  explicit Pose(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) meshes_.push_back(std::make_shared<const Positions>(mesh.positions));
  }
  /// That of the same scene after `changes`.
  Pose after(const Scene& scene, const Changes& changes) const {
    Pose moved = *this;
    for (std::size_t m = 0; m < changes.meshes.size(); ++m)
      if (changes.meshes[m].kind != MeshChange::Kind::still)
        moved.meshes_[m] = std::make_shared<const Positions>(scene.meshes[m].positions);
    return moved;
  }
  /// Whether a mesh is where it was in the other pose.
  bool has_still(const Pose& other, std::uint32_t mesh) const { return meshes_[mesh] == other.meshes_[mesh]; }
  const std::vector<glm::vec3>& positions(std::uint32_t mesh) const { return *meshes_[mesh]; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const auto& positions : meshes_) sum += positions->size() * sizeof(glm::vec3);
    return sum;
  }

 private:
  using Positions = std::vector<glm::vec3>;
  std::vector<std::shared_ptr<const Positions>> meshes_;
};

}  // namespace gnomon::denoised_rays
