#pragma once
// Private to formats: meshes of glTF at their nodes, with morph targets and skins in the pose of the file.
#include <map>

#include "measure/formats/gltf_textures.h"

namespace gnomon::importing {

class GltfMeshes {
 public:
  /// `nodes`: world from node, of all nodes of the file. `with_uv`: texture coordinates of all meshes.
  GltfMeshes(const GltfFile& file, const ReadFile& read, const std::vector<glm::dmat4>& nodes, bool with_uv, MeshFile& answer)
      : file_(file), nodes_(nodes), with_uv_(with_uv), answer_(answer), textures_(file, read, answer) {}

  /// Each primitive of a mesh, once for each place.
  void add(std::size_t node, std::size_t mesh, const std::vector<glm::dmat4>& places);
  /// What was left out.
  void note();

 private:
  struct Primitive;
  void add_primitive(const Primitive& primitive, const std::vector<glm::dmat4>& places);
  std::vector<double> weights(const Primitive& primitive, std::size_t target_count) const;
  std::vector<glm::dvec3> positions(const Primitive& primitive);
  void pose(const Primitive& primitive, std::size_t skin, std::vector<glm::dvec3>& positions);
  std::vector<glm::dmat4> joints(std::size_t skin) const;
  void add_faces(const Primitive& primitive, std::size_t vertex_count, ImportedMesh& mesh);
  void read_material(const Primitive& primitive, ImportedMesh& mesh);
  void read_textures(const Primitive& primitive, const Json& material, const std::string& where, const GltfColor& color,
                     ImportedMesh& mesh);
  void add_uv(const Primitive& primitive, const Json* texture, ImportedMesh& mesh);
  void count_vertex_colors(const Primitive& primitive, const ImportedMesh& mesh);
  std::optional<std::size_t> attribute(const Primitive& primitive, const char* name) const;

  const GltfFile& file_;
  const std::vector<glm::dmat4>& nodes_;
  const bool with_uv_;
  MeshFile& answer_;
  GltfTextures textures_;
  std::map<std::string, std::size_t> known_;             ///< meshes of the answer by primitive and name
  std::optional<std::pair<std::size_t, Numbers>> last_;  ///< accessor of positions that was read last
  std::optional<std::pair<std::size_t, std::vector<glm::dmat4>>> last_skin_;
  std::size_t points_and_lines_ = 0, without_positions_ = 0, odd_weights_ = 0, vertex_alpha_ = 0, vertex_colors_ = 0;
};

}  // namespace gnomon::importing
