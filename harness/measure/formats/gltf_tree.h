#pragma once
// Private to formats: the nodes of glTF, and where they are in the file's own pose.
#include <optional>

#include "measure/formats/gltf_file.h"

namespace gnomon::importing {

class GltfTree {
 public:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  /// Throws Error where nodes form no tree.
  explicit GltfTree(const GltfFile& file);

  std::size_t size() const { return world_.size(); }
  /// World from node, of each node.
  const std::vector<glm::dmat4>& world() const { return world_; }
  /// `none` of a root.
  std::size_t parent(std::size_t node) const { return parents_[node]; }
  /// All nodes, parents before children.
  const std::vector<std::size_t>& all() const { return all_; }
  /// The nodes of the default scene, from its roots down, children in their order.
  const std::vector<std::size_t>& scene() const { return scene_; }
  /// Whether KHR_node_visibility hides the node, or one above it.
  bool is_hidden(std::size_t node) const { return is_hidden_[node]; }

  /// The node's own place as the file has it: a matrix, or translation, rotation and scale. Without parent and weights.
  MotionNode local(std::size_t node) const;
  /// EXT_mesh_gpu_instancing: node from place, of each place of the node's mesh. Nothing of a node whose mesh is there once.
  std::optional<std::vector<glm::dmat4>> instances(std::size_t node) const;
  /// World from mesh, of each place of the node's mesh.
  std::vector<glm::dmat4> places(std::size_t node) const;

 private:
  glm::dmat4 matrix(std::size_t node) const;
  std::vector<std::size_t> children(const Json& owner, const std::string& where, const char* key) const;

  const GltfFile& file_;
  std::vector<std::size_t> parents_, all_, scene_;
  std::vector<glm::dmat4> world_;
  std::vector<bool> is_hidden_;
};

}  // namespace gnomon::importing
