#pragma once
// Private to formats: meshes of glTF at their nodes, with morph targets and skins in the pose of the file.
#include <map>

#include "measure/formats/gltf_motion.h"
#include "measure/formats/gltf_textures.h"

namespace gnomon::importing {

class GltfMeshes {
 public:
  /// `with_uv`: texture coordinates of all meshes.
  GltfMeshes(const GltfFile& file, const ReadFile& read, const GltfTree& tree, GltfMotion& motion, bool with_uv,
             MeshFile& answer)
      : file_(file), tree_(tree), motion_(motion), with_uv_(with_uv), answer_(answer), textures_(file, read, answer) {}

  /// Each primitive of a node's mesh, once for each place of the node.
  void add(std::size_t node, std::size_t mesh);
  /// After all meshes: gives those that an animation moves their nodes, and notes what was left out.
  void finish();

 private:
  /// One primitive of one node's mesh.
  struct Primitive {
    const Json &node, &mesh, &json;
    std::size_t node_index, mesh_index;
    std::string where, name;
  };
  /// The nodes of the places of one mesh of the answer, and whether an animation moves the mesh at one of them.
  struct Origin {
    std::vector<std::size_t> nodes;
    bool is_moved = false;
  };
  void add_primitive(const Primitive& primitive, const std::vector<glm::dmat4>& places);
  void add_origin(const Primitive& primitive, const ImportedMesh& mesh, Origin& origin) const;
  void add_positions(const Primitive& primitive, ImportedMesh& mesh);
  void check_targets(const Primitive& primitive, const ImportedMesh& mesh) const;
  void add_joints(const Primitive& primitive, std::size_t joint_count, ImportedMesh& mesh);
  void pose(std::size_t skin, ImportedMesh& mesh);
  void add_faces(const Primitive& primitive, std::size_t vertex_count, ImportedMesh& mesh);
  void read_material(const Primitive& primitive, ImportedMesh& mesh);
  void read_textures(const Primitive& primitive, const Json& material, const std::string& where, const GltfColor& color,
                     ImportedMesh& mesh);
  void add_uv(const Primitive& primitive, const Json* texture, ImportedMesh& mesh);
  void count_vertex_colors(const Primitive& primitive, const ImportedMesh& mesh);
  std::optional<std::size_t> attribute(const Primitive& primitive, const char* name) const;

  const GltfFile& file_;
  const GltfTree& tree_;
  GltfMotion& motion_;
  const bool with_uv_;
  MeshFile& answer_;
  GltfTextures textures_;
  std::vector<Origin> origins_;                          ///< of each mesh of the answer
  std::map<std::string, std::size_t> known_;             ///< meshes of the answer by primitive and name
  std::optional<std::pair<std::size_t, Numbers>> last_;  ///< accessor of positions that was read last
  std::optional<std::pair<std::size_t, std::vector<glm::dmat4>>> last_skin_;
  std::size_t points_and_lines_ = 0, without_positions_ = 0, odd_weights_ = 0, vertex_alpha_ = 0, vertex_colors_ = 0;
};

}  // namespace gnomon::importing
