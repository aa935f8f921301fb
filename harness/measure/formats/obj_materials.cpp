// Source: Wavefront, "Material Library File (.mtl)", Advanced Visualizer manual, appendix B1.
#include "measure/formats/obj_materials.h"

#include <algorithm>
#include <charconv>

#include "measure/formats/readers.h"

namespace gnomon::importing {

namespace fs = std::filesystem;

namespace {

/// The file of this name in a folder. Names may be quoted, or written under Windows.
fs::path file_in(const fs::path& folder, std::string name) {
  std::error_code code;
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  if (!fs::exists(folder / name, code)) std::ranges::replace(name, '\\', '/');
  return folder / name;
}

/// Options of a map, and how many words follow each, at most; the second and later ones are numbers.
struct MapOption {
  std::string_view name;
  std::size_t most_words;
};
constexpr MapOption map_options[] = {{"-blendu", 1}, {"-blendv", 1},  {"-bm", 1},  {"-boost", 1}, {"-cc", 1},
                                     {"-clamp", 1},  {"-imfchan", 1}, {"-mm", 2},  {"-o", 3},     {"-s", 3},
                                     {"-t", 3},      {"-texres", 1},  {"-type", 1}};

bool is_number(std::string_view word) {
  return !word.empty() && word.find_first_not_of("+-.0123456789eE") == word.npos &&
         word.find_first_of("0123456789") != word.npos;
}

}  // namespace

void ObjMaterials::add_library(const std::string& names, MeshFile& answer) {
  std::error_code code;
  const fs::path folder = file_.parent_path();
  std::vector<std::string> files{names};
  if (!fs::exists(file_in(folder, names), code) && names.find(' ') != names.npos) {
    files.clear();
    TextLines words(names, names, 0);
    words.next();
    for (std::string_view word = words.word(); !word.empty(); word = words.word()) files.emplace_back(word);
  }
  for (const std::string& name : files) {
    if (!read_before_.insert(name).second) continue;
    if (fs::is_regular_file(file_in(folder, name), code))
      read_library(file_in(folder, name), answer);
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
      material->folder = file.parent_path();
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
      read_opacity(lines, word == "d", *material);
    } else if (word == "tf") {
      read_filter(lines, *material);
    } else if (word == "map_kd" || word == "map_d") {
      material->has_texture = true;
      if (word == "map_d") read_map(lines, *material);
    }
  }
  answer.note(spectral, "color{s} of materials {is|are} spectral or XYZ and not used");
}

/// d, or 1 - Tr, which the specification does not have: where a material has both, d counts.
void ObjMaterials::read_opacity(TextLines& lines, bool is_dissolve, Material& material) {
  std::string_view first = lines.word();
  const bool has_halo = first == "-halo";
  if (has_halo) first = lines.word();
  const double value = first.empty() ? (is_dissolve ? 1 : 0) : lines.number(first);
  if (!is_dissolve && material.has_opacity) return;
  material.has_opacity |= is_dissolve;
  material.has_halo = has_halo;
  material.opacity = is_dissolve ? value : 1 - value;
  const bool is_share = value >= 0 && value <= 1;
  material.opacity_fault =
      is_share ? "" : fmt::format("{} = {} ({}) is not within 0 .. 1", is_dissolve ? "d" : "Tr", value, lines.where());
}

/// Whether Tf is anything but 1 1 1.
void ObjMaterials::read_filter(TextLines& lines, Material& material) {
  for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
    double value = 0;
    std::from_chars(word.data(), word.data() + word.size(), value);
    material.has_filter |= value != 1;
  }
}

/// Options, then a file whose name may contain blanks.
void ObjMaterials::read_map(TextLines& lines, Material& material) {
  std::string_view rest = lines.rest();
  const auto first_word = [&] { return rest.substr(0, rest.find_first_of(" \t")); };
  const auto drop = [&] {
    rest.remove_prefix(first_word().size());
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
  };
  while (rest.starts_with('-')) {
    const auto option = std::ranges::find(map_options, lower(first_word()), &MapOption::name);
    if (option == std::end(map_options)) break;
    drop();
    if (option->name == "-clamp")
      material.is_clamped = lower(first_word()) == "on";
    else
      material.has_more_options = true;
    drop();
    for (std::size_t k = 1; k < option->most_words && is_number(first_word()); ++k) drop();
  }
  material.map = rest;
}

void ObjMaterials::apply(const std::string& name, ImportedMesh& mesh, MeshFile& answer) {
  if (name.empty()) return;
  const auto found = materials_.find(name);
  if (found == materials_.end()) {
    missing_.insert(name);
    return;
  }
  Material& material = found->second;
  ImportedTransmission& transmission = material.transmission;
  if (material.opacity_fault.empty())
    transmission.alpha = material.opacity;
  else if (!transmission.has_image())
    transmission.alpha_image = add_broken_image(answer, name, fmt::format("material '{}': {}", name, material.opacity_fault));
  material.is_transparent = material.transmission.is_there();
  if (!material.map.empty()) read_mask(name, material, answer);
  if (material.is_transparent && material.has_halo) with_halo_.insert(name);
  if (material.is_transparent && material.has_filter) with_filter_.insert(name);
  if (material.is_transparent && material.mask.has_image()) masked_and_thin_.insert(name);
  static_cast<ImportedMaterial&>(mesh) = material;
}

/// The image beside the library, else beside the OBJ.
void ObjMaterials::read_mask(const std::string& name, Material& material, MeshFile& answer) {
  if (material.mask.has_image() || without_image_.contains(name)) return;
  std::error_code code;
  fs::path image = file_in(material.folder, material.map);
  if (!fs::exists(image, code)) image = file_in(file_.parent_path(), material.map);
  if (!fs::exists(image, code)) {
    without_image_.insert(name);
    return;
  }
  const auto [known, is_new] = images_.emplace(image, ImportedMask::no_image);
  if (is_new) known->second = add_image_file(answer, image, read_, true);
  const AlphaMask::Wrap wrap = material.is_clamped ? AlphaMask::Wrap::clamp : AlphaMask::Wrap::repeat;
  material.mask = {.image = known->second, .wrap_u = wrap, .wrap_v = wrap};
  masked_.insert(name);
  if (material.has_more_options) with_more_options_.insert(name);
}

void ObjMaterials::note(MeshFile& answer) const {
  if (!missing_libraries_.empty())
    answer.note(missing_libraries_.size(), "librar{y|ies} of materials {is|are} not there, or no regular {file|files}",
                fmt::format(" ('{}' is one)", missing_libraries_.front()));
  if (!missing_.empty())
    answer.note(missing_.size(), "material{s} of unknown color {is|are} in no library",
                fmt::format(" ('{}' is one)", *missing_.begin()));
  answer.note(masked_.size(),
              "material{s} {has|have} a mask (map_d), and the format has no cutoff: an alpha of 0.5 or more is solid");
  answer.note(with_more_options_.size(), "material{s} {has|have} a mask with options that are not used (all but -clamp)");
  answer.note(masked_and_thin_.size(), "material{s} {has|have} a mask (map_d) and d or Tr: what is solid transmits 1 - d");
  answer.note(with_halo_.size(), "material{s} {has|have} d -halo, which is read as d: it does not depend on the direction");
  answer.note(with_filter_.size(),
              "material{s} {has|have} a filter (Tf), which is not used: d dissolves all colors alike, as the format says");
  if (!without_image_.empty())
    answer.note(without_image_.size(), "material{s} {has|have} a mask whose image is not there and {is|are} solid",
                fmt::format(" ('{}' is one)", *without_image_.begin()));
}

}  // namespace gnomon::importing
