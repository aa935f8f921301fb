// OBJ: lines of vertices, faces and much else. Objects and groups become meshes, and so do the parts of them that have another
// material.
// Source: Wavefront, "Object Files (.obj)" and "Material Library File (.mtl)", Advanced Visualizer manual, appendix B1.
#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <unordered_map>

#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// What is used of an OBJ's materials.
class ObjMaterials {
 public:
  ObjMaterials(const fs::path& file, const ReadFile& read) : file_(file), read_(read) {}

  /// The files behind `mtllib`: one whose name may contain blanks, or several. Those that are missing are noted.
  void add_library(const std::string& names, MeshFile& answer);
  /// Color, texture and transparency of the material of this name; nothing where there is none.
  void apply(const std::string& name, ImportedMesh& mesh);
  /// Materials that no library has.
  void note(MeshFile& answer) const;

 private:
  void read_library(const fs::path& file, MeshFile& answer);

  const fs::path& file_;
  const ReadFile& read_;
  std::map<std::string, ImportedMaterial> materials_;
  std::set<std::string> missing_, read_before_;
  std::vector<std::string> missing_libraries_;
};

void ObjMaterials::add_library(const std::string& names, MeshFile& answer) {
  std::error_code code;
  const auto path_of = [&](std::string name) {
    if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    if (!fs::exists(file_.parent_path() / name, code))
      for (char& c : name)  // written under Windows
        if (c == '\\') c = '/';
    return file_.parent_path() / name;
  };
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
  ImportedMaterial* material = nullptr;
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
  if (const auto found = materials_.find(name); found != materials_.end())
    static_cast<ImportedMaterial&>(mesh) = found->second;
  else
    missing_.insert(name);
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

// What a line may open with beside v, f, o, g, usemtl, mtllib, p and l.
constexpr std::string_view no_geometry[] = {"vn",       "vt",     "vp",     "s",      "mg",         "bevel",     "c_interp",
                                            "d_interp", "lod",    "maplib", "usemap", "shadow_obj", "trace_obj", "ctech",
                                            "stech",    "cstype", "deg",    "bmat",   "step",       "parm",      "trim",
                                            "hole",     "scrv",   "sp",     "end",    "con"};
constexpr std::string_view free_form[] = {"curv", "curv2", "surf", "bsp", "bzp", "cdc", "cdp", "res"};
constexpr std::string_view foreign_file[] = {"call", "csh"};

/// The first number of "7", "7/1", "-2//3", 0 where it exceeds 64 bits; the others must be numbers, or missing.
std::int64_t vertex_number(std::string_view word, const TextLines& lines) {
  std::string_view rest = word;
  std::int64_t number = 0;
  for (int k = 0; k < 3; ++k) {
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (code == std::errc::result_out_of_range) return 0;
    if (code != std::errc{} && k == 0) break;
    if (k == 0) number = value;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (!rest.starts_with('/')) break;
    rest.remove_prefix(1);
  }
  if (!rest.empty()) throw Error("{}: '{}' names no vertex", lines.where(), word);
  return number;
}

/// The faces of one object, or of one material in it.
struct Part {
  std::string name, material;
  std::vector<std::int64_t> corners;  ///< numbers of vertices, from 0
  std::vector<std::uint32_t> corner_counts;
};

class ObjReader {
 public:
  ObjReader(const fs::path& file, const ReadFile& read) : name_(file.string()), materials_(file, read) {}

  MeshFile read(std::string_view text) {
    TextLines lines(name_, text, '#', true);
    while (lines.next()) read_line(lines);
    for (const auto& [index, line] : ahead_)
      if (index >= vertex_count()) note_outside(line, std::to_string(index + 1));
    if (!outside_.empty())
      throw Error("{}, out of range: allowed are 1 .. {}, or counted back from the line", outside_, vertex_count());
    for (Part& part : parts_) finish(part);
    note();
    return std::move(answer_);
  }

 private:
  std::int64_t vertex_count() const { return static_cast<std::int64_t>(positions_.size()); }

  void read_line(TextLines& lines) {
    const std::string_view first = lines.word();
    if (first == "v") return read_vertex(lines);
    if (first == "f" || first == "fo") return read_face(lines);
    if (first == "o" || first == "g") return begin_object(first == "g", std::string(lines.rest()));
    if (first == "usemtl") return use_material(std::string(lines.rest()));
    if (first == "mtllib") return materials_.add_library(std::string(lines.rest()), answer_);
    const auto is_among = [&](const auto& words) { return std::ranges::find(words, first) != std::end(words); };
    if (is_among(no_geometry)) return;
    if (first == "p" || first == "l") {
      const std::size_t ends = std::max<std::size_t>(lines.words_left(), 1);
      points_and_lines_ += first == "p" ? ends : std::max<std::size_t>(ends - 1, 1);
    } else if (is_among(foreign_file)) {
      throw Error("{}: '{}' wants another file or program, which is not read", lines.where(), first);
    } else if (is_among(free_form)) {
      ++free_form_;
    } else if (unknown_++ == 0) {
      first_unknown_ = fmt::format("'{}' of line {}", first, lines.line_number());
    }
  }

  /// x y z, then a weight, or a color of 3 or 4, or both.
  void read_vertex(TextLines& lines) {
    positions_.push_back(glm::dvec3{lines.real(), lines.real(), lines.real()});
    const std::size_t more = lines.words_left();
    for (std::size_t k = 0; k < more; ++k) weighted_ += lines.number() != 1 && more == 1;
  }

  /// The number of vertices is final at the end of the file alone.
  void note_outside(long line, const std::string& word) {
    if (outside_.empty()) outside_ = fmt::format("{}:{}: face names vertex {}", name_, line, word);
  }

  void read_face(TextLines& lines) {
    Part& part = current();
    std::uint32_t count = 0;
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
      const std::int64_t number = vertex_number(word, lines);
      if (number == 0 || number < -vertex_count()) note_outside(lines.line_number(), std::string(word));
      part.corners.push_back(number > 0 ? number - 1 : vertex_count() + number);
      if (part.corners.back() >= vertex_count()) ahead_.emplace_back(part.corners.back(), lines.line_number());
      ++count;
    }
    need_corners(lines.where(), part.corner_counts.size(), count);
    if (count < 3) {
      part.corners.resize(part.corners.size() - count);
      ++short_faces_;
    } else {
      part.corner_counts.push_back(count);
    }
  }

  /// A group with the name of the group before continues it; an object with the name of an earlier object continues that one.
  void begin_object(bool is_group, const std::string& name) {
    if (is_group && !parts_.empty() && name == group_) return;
    if (is_group) group_ = name;
    const auto [same, is_new] = objects_.emplace(name, parts_.size());
    const auto fits = [&](const Part& part) { return part.material == material_ || part.corner_counts.empty(); };
    if (!is_group && !is_new && fits(parts_[same->second])) {
      part_ = same->second;
      parts_[part_].material = material_;
    } else {
      begin_part(name);
    }
  }
  void begin_part(const std::string& name) {
    part_ = parts_.size();
    parts_.push_back({.name = name, .material = material_, .corners = {}, .corner_counts = {}});
  }
  Part& current() {
    if (parts_.empty()) begin_object(false, "");
    return parts_[part_];
  }
  void use_material(const std::string& name) {
    material_ = name;
    if (parts_.empty()) return;
    if (parts_[part_].material != name && !parts_[part_].corner_counts.empty()) begin_part(name);
    parts_[part_].material = name;
  }

  /// Vertices in the order of the faces that use them.
  void finish(Part& part) {
    if (part.corner_counts.empty()) return;
    ImportedMesh& mesh = answer_.meshes.emplace_back();
    mesh.name = part.name;
    mesh.corner_counts = std::move(part.corner_counts);
    mesh.corners.reserve(part.corners.size());
    place_.resize(positions_.size(), unused);
    for (const std::int64_t corner : part.corners) {
      std::uint32_t& place = place_[static_cast<std::size_t>(corner)];
      if (place == unused) {
        place = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.push_back(positions_[static_cast<std::size_t>(corner)]);
      }
      mesh.corners.push_back(place);
    }
    for (const std::int64_t corner : part.corners) place_[static_cast<std::size_t>(corner)] = unused;
    materials_.apply(part.material, mesh);
  }

  void note() {
    answer_.note(points_and_lines_, "points and lines are left out");
    answer_.note(short_faces_, "faces have fewer than three corners and are left out");
    answer_.note(free_form_, "free-form curves and surfaces are left out");
    answer_.note(weighted_, "vertices have a weight, which is for free-form surfaces and not used");
    if (unknown_ > 0)
      answer_.note(unknown_,
                   fmt::format("lines open with a word that is unknown to OBJ ({}) and are left out", first_unknown_));
    materials_.note(answer_);
  }

  static constexpr std::uint32_t unused = 0xffffffffu;

  const std::string name_;
  ObjMaterials materials_;
  MeshFile answer_;
  std::vector<glm::dvec3> positions_;
  std::vector<Part> parts_;
  std::unordered_map<std::string, std::size_t> objects_;  ///< by name, the first part
  std::size_t part_ = 0;
  std::string group_, material_;
  std::vector<std::pair<std::int64_t, long>> ahead_;  ///< vertices that were not there yet, and the line that names them
  std::vector<std::uint32_t> place_;
  std::size_t points_and_lines_ = 0, short_faces_ = 0, free_form_ = 0, weighted_ = 0, unknown_ = 0;
  std::string first_unknown_, outside_;
};

}  // namespace

MeshFile read_obj(const fs::path& file, const ReadFile& read) {
  const std::string name = file.string(), bytes = read(file);
  return ObjReader(file, read).read(without_byte_order_mark(name, bytes));
}

}  // namespace gnomon::importing
