#pragma once
// Private to formats: what deforms the meshes of glTF: weights of morph targets, and skins.
#include "measure/formats/gltf_file.h"

namespace gnomon::importing {

/// The nodes that move the vertices of a mesh, and of each the matrix joint from mesh: the identity where the file has none.
struct GltfSkin {
  std::vector<std::size_t> joints;  ///< nodes of the file
  std::vector<glm::dmat4> inverse_bind;
};
/// Throws Error: the file, the skin, which joint.
GltfSkin read_skin(const GltfFile& file, std::size_t skin);

/// How many morph targets the mesh of a node has: those of its first primitive that has some. 0 without a mesh.
std::size_t morph_target_count(const GltfFile& file, const Json& node, const std::string& where);
/// Weights of the morph targets: those of the node, else of the mesh, else 0. Throws Error unless there are `target_count`.
std::vector<double> morph_weights(const GltfFile& file, const Json& node, const Json& mesh, const std::string& where,
                                  std::size_t target_count);

}  // namespace gnomon::importing
