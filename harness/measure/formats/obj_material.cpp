// Source: Wavefront, "Material Library File (.mtl)", Advanced Visualizer manual.
#include "measure/formats/obj_material.h"

#include "measure/formats/text_lines.h"

namespace gnomon::importing {

namespace fs = std::filesystem;

void ObjMaterials::add_library(const std::string& names, MeshFile& answer) {
  const auto path_of = [&](std::string name) {
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    std::error_code code;
    if (!fs::exists(file_.parent_path() / name, code))
      for (char& c : name)  // written under Windows
        if (c == '\\') c = '/';
    return file_.parent_path() / name;
  };
  std::error_code code;
  std::vector<std::string> files{names};
  if (!fs::exists(path_of(names), code) && names.find(' ') != names.npos) {
    files.clear();
    TextLines words(names, names, 0);
    words.next();
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) files.emplace_back(word);
  }
  for (const std::string& name : files) {
    if (!read_before_.insert(name).second) continue;
    if (fs::is_regular_file(path_of(name), code))
      read_library(path_of(name), answer);
    else
      missing_libraries_.push_back(name);
  }
}

void ObjMaterials::read_library(const fs::path& file, MeshFile& answer) {
  const std::string name = file.string(), bytes = read_(file);
  TextLines lines(name, without_byte_order_mark(name, bytes), '#', true);
  Material* material = nullptr;
  std::size_t spectral = 0;
  while (lines.next()) {
    const std::string word = lower(lines.word());
    if (word == "newmtl") {
      material = &materials_[std::string(lines.rest())];
    } else if (!material) {
      continue;
    } else if (word == "kd") {
      const std::string_view first = lines.word();
      if (first == "spectral" || first == "xyz") {
        ++spectral;
        continue;
      }
      // One number is for all three.
      const auto red = static_cast<float>(lines.number(first));
      material->has_color = true;
      material->color = glm::vec3(red);
      for (int k = 1; k < 3 && lines.words_left() > 0; ++k) material->color[k] = lines.real();
    } else if (word == "d" || word == "tr") {
      std::string_view first = lines.word();
      if (first == "-halo") first = lines.word();
      const double value = first.empty() ? (word == "d" ? 1 : 0) : lines.number(first);
      material->is_transparent |= word == "d" ? value < 1 : value > 0;
    } else if (word == "map_kd" || word == "map_d") {
      material->has_texture = true;
    }
  }
  answer.note(spectral, "colors of materials are spectral or XYZ and not used");
}

void ObjMaterials::apply(const std::string& name, ImportedMesh& mesh) {
  if (name.empty()) return;
  const auto found = materials_.find(name);
  if (found == materials_.end()) {
    missing_.insert(name);
    return;
  }
  const Material& material = found->second;
  mesh.has_color = material.has_color;
  mesh.color = material.color;
  mesh.has_texture = material.has_texture;
  mesh.is_transparent = material.is_transparent;
}

void ObjMaterials::note(MeshFile& answer) const {
  if (!missing_libraries_.empty())
    answer.note(
        missing_libraries_.size(),
        fmt::format("libraries of materials are not there, or no regular files ('{}' is one)", missing_libraries_.front()));
  if (!missing_.empty())
    answer.note(missing_.size(),
                fmt::format("materials are in no library ('{}' is one); their color is not known", *missing_.begin()));
}

}  // namespace gnomon::importing
