#pragma once
// Private to the importer: what moves the meshes of one file.
#include "measure/scene/import.h"

namespace gnomon::importing {

/// Collects the rigs of a file's meshes, and hands them on with the file's nodes, skins and animations.
class FileMotion {
 public:
  /// Throws Error, which opens with `file`, unless the motion is sound. `file_bytes` bound the numbers in rigs.
  FileMotion(const std::string& file, std::uintmax_t file_bytes, Motion motion);

  /// What moves the vertices of a mesh of the file, before any are welded; null where nothing does. It holds until the next
  /// call. Throws Error, which opens with `where`: "FILE: mesh 'leaf'".
  const Rig* rig_of(const std::string& where, ImportedMesh& raw);
  /// Adds the rig of the mesh that rig_of was called for last, at one of its places: `sources` are the vertices of the file
  /// that its vertices are, `mesh` is its number in the scene.
  void add(const ImportedMesh& raw, std::size_t place, const Placement& placement, std::span<const std::uint32_t> sources,
           std::size_t mesh);
  /// Adds the motion to that of the scene, unless nothing moves.
  void finish(Scene& scene);

 private:
  Motion motion_;
  Rig whole_;                                    ///< of the mesh that rig_of was called for last, of all vertices of the file
  std::size_t number_count_ = 0, most_numbers_;  ///< in the rigs of all places, before vertices are welded
};

/// For each used vertex the first one at its position that moves with it in whatever pose: with an equal base, and equal
/// targets, joints and weights. `welded` as of gnomon::weld.
std::vector<std::uint32_t> weld_rigged(std::span<const std::uint32_t> welded, const Rig& rig,
                                       std::span<const std::uint8_t> used);

}  // namespace gnomon::importing
