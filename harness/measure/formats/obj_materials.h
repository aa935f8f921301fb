#pragma once
// Private to formats: the materials of an OBJ.
#include <map>
#include <set>

#include "measure/formats/mesh_file.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {

/// What is used of an OBJ's materials.
class ObjMaterials {
 public:
  ObjMaterials(const std::filesystem::path& file, const ReadFile& read) : file_(file), read_(read) {}

  /// The files behind `mtllib`: one whose name may contain blanks, or several. Those that are missing are noted.
  void add_library(const std::string& names, MeshFile& answer);
  /// Color, texture, mask and transmission of the material of this name; nothing where there is none.
  void apply(const std::string& name, ImportedMesh& mesh, MeshFile& answer);
  /// Materials that no library has, and what is not used of the others.
  void note(MeshFile& answer) const;

 private:
  struct Material : ImportedMaterial {
    std::string map;               ///< file of map_d, as written
    std::filesystem::path folder;  ///< of the library
    double opacity = 1;            ///< d, or 1 - Tr
    std::string opacity_fault;     ///< why it is refused where it is used; empty where it is within 0 .. 1
    bool has_opacity = false;      ///< by d, which counts before Tr
    bool is_clamped = false, has_more_options = false, has_halo = false, has_filter = false;
  };
  void read_library(const std::filesystem::path& file, MeshFile& answer);
  static void read_opacity(TextLines& lines, bool is_dissolve, Material& material);
  static void read_filter(TextLines& lines, Material& material);
  static void read_map(TextLines& lines, Material& material);
  void read_mask(const std::string& name, Material& material, MeshFile& answer);

  const std::filesystem::path& file_;
  const ReadFile& read_;
  std::map<std::string, Material> materials_;
  std::map<std::filesystem::path, std::uint32_t> images_;  ///< those of the answer
  std::set<std::string> missing_, read_before_, masked_, without_image_, with_more_options_, with_halo_, with_filter_,
      masked_and_thin_;  ///< names
  std::vector<std::string> missing_libraries_;
};

}  // namespace gnomon::importing
