#pragma once
// Private to formats: what is used of an OBJ's materials.
#include <map>
#include <set>

#include "measure/formats/mesh_file.h"

namespace gnomon::importing {

class ObjMaterials {
 public:
  ObjMaterials(const std::filesystem::path& file, const ReadFile& read) : file_(file), read_(read) {}

  /// The files behind `mtllib`: one whose name may hold blanks, or several. Those that are missing are noted.
  void add_library(const std::string& names, MeshFile& answer);
  /// Color, texture and transparency of the material of this name; nothing where there is none.
  void apply(const std::string& name, ImportedMesh& mesh);
  /// Materials that no library has.
  void note(MeshFile& answer) const;

 private:
  struct Material {
    bool has_color = false, has_texture = false, is_transparent = false;
    glm::vec3 color{0};
  };
  void read_library(const std::filesystem::path& file, MeshFile& answer);

  const std::filesystem::path& file_;
  const ReadFile& read_;
  std::map<std::string, Material> materials_;
  std::set<std::string> missing_, read_before_;
  std::vector<std::string> missing_libraries_;
};

}  // namespace gnomon::importing
