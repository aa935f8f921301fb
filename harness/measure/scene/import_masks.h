#pragma once
// Private to the importer: the alpha masks of the meshes of one file.
#include <map>
#include <tuple>

#include "measure/scene/import.h"

namespace gnomon::importing {

class FileMasks {
 public:
  /// Throws Error where the image of `choice` cannot be read. All outlive this object.
  FileMasks(const std::filesystem::path& file, const MeshFile& raw, const MaskChoice& choice, const Scene& scene);

  /// The mask of a mesh of the file; null: it is solid. `where` opens errors: "FILE: mesh 'leaf'".
  std::shared_ptr<const AlphaMask> mask(const std::string& where, const ImportedMesh& mesh);
  /// Adds notes to the scene, which open with `name`. Throws Error where the choice has a cutoff or a scale and no mesh has a
  /// mask.
  void finish(const std::string& name, Scene& scene) const;

  /// Ends errors: how a description avoids them.
  const std::string& hint() const { return choice_.hint; }
  /// Triangles that a mesh with a mask or a transmission has more than once are there once.
  void drop_duplicates(Mesh& mesh);

 private:
  using Settings = std::tuple<std::uint32_t, float, float, AlphaMask::Wrap, AlphaMask::Wrap>;
  struct MadeMask {
    std::shared_ptr<const AlphaMask> mask;
    double coverage = 1;
  };
  std::shared_ptr<const AlphaMask> made(const MaskImage& image, const ImportedMask& mask) const;

  const std::string file_;
  const MeshFile& raw_;
  const MaskChoice& choice_;
  const Scene& scene_;
  std::optional<MaskImage> chosen_;
  std::map<Settings, MadeMask> known_;
  std::size_t without_alpha_ = 0, without_hole_ = 0, without_solid_ = 0, masked_ = 0;
  std::size_t masked_duplicates_ = 0, other_duplicates_ = 0;  ///< triangles
};

/// Throws Error, which ends in `hint`, unless each used vertex has sound texture coordinates, which a mask needs, or else a
/// transmission.
void check_uv(const std::string& where, const ImportedMesh& mesh, std::span<const std::uint8_t> used, bool is_masked,
              std::string_view hint);
/// Of triangles by the numbers of their corners: whether one before has the same three, in any order.
std::vector<bool> find_duplicates(std::span<const glm::uvec3> triangles);
/// For each used vertex the first one at exactly its position and place in the image; `welded` as of gnomon::weld.
std::vector<std::uint32_t> weld_places(std::span<const std::uint32_t> welded, std::span<const glm::vec2> uv,
                                       std::span<const std::uint8_t> used);

}  // namespace gnomon::importing
