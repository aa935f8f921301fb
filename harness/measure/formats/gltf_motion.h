#pragma once
// Private to formats: what the animations of a glTF file move, as a Motion.
#include <map>
#include <set>

#include "measure/formats/gltf_animations.h"
#include "measure/formats/gltf_deform.h"
#include "measure/formats/gltf_tree.h"

namespace gnomon::importing {

class GltfMotion {
 public:
  GltfMotion(const GltfFile& file, const GltfTree& tree);

  /// A skin of the file; the reference stays valid.
  const GltfSkin& skin(std::size_t skin);
  /// Whether an animation moves the node, or a node above it.
  bool moves_place(std::size_t node) const { return is_moved_[node]; }
  /// Whether an animation moves what places the mesh of the node: joints of its skin, else the node itself.
  bool moves(std::size_t node);
  /// Whether an animation changes weights of morph targets of the node's mesh.
  bool morphs(std::size_t node) const { return is_morphed_[node]; }
  /// Whether an animation moves or morphs a mesh of the file at any visible node of the scene.
  bool moves_mesh(std::size_t mesh) const { return moved_meshes_.contains(mesh); }

  /// The number in the motion of a skin of the file.
  std::uint32_t number_of_skin(std::size_t skin);
  /// Adds the nodes of the places that a node gives to a mesh, and keeps the tracks that move them.
  void place(std::size_t node, ImportedMesh& mesh);
  /// After all meshes: the motion, with what was left out of it among the notes.
  void finish(MeshFile& answer);

 private:
  struct Block {
    std::uint32_t first = 0, count = 1;
  };
  void add_nodes();
  Block block(std::size_t node, bool has_skin);
  void add_weights(std::size_t node, const Block& places, const ImportedMesh& mesh);
  bool moves(const Track& track) const;
  std::vector<Track> used_tracks(std::vector<Track>& tracks) const;
  void add_skins();
  std::string free_name(std::string name);

  const GltfFile& file_;
  const GltfTree& tree_;
  GltfAnimations read_;
  std::vector<bool> is_moved_, is_morphed_;  ///< of each node of the file
  std::vector<bool> is_used_, has_weights_;  ///< whether the node moves meshes of the answer, carries weights of them
  std::set<std::size_t> moved_meshes_;
  std::map<std::size_t, GltfSkin> skins_;                ///< by their number in the file
  std::map<std::size_t, std::uint32_t> number_of_skin_;  ///< by their number in the file
  std::vector<std::uint32_t> number_;                    ///< in the motion, of each node of the file
  std::map<std::size_t, Block> instances_;               ///< nodes of the motion, by the node of the file
  std::set<std::string> names_;                          ///< of animations
  std::map<std::string, std::size_t> numbers_;           ///< the last that free_name appended to a name
  Motion motion_;
};

}  // namespace gnomon::importing
