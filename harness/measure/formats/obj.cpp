// OBJ: lines of vertices, faces and much else. Objects and groups become meshes, and so do the parts of them that have another
// material.
// Source: Wavefront, "Object Files (.obj)", Advanced Visualizer manual, appendix B1.
#include <algorithm>
#include <charconv>
#include <unordered_map>

#include "measure/formats/obj_material.h"
#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

/// What a line may open with beside v, f, o, g, usemtl and mtllib.
enum class Statement { unknown, no_geometry, points_and_lines, free_form, foreign_file };
Statement statement(std::string_view word) {
  static const std::unordered_map<std::string_view, Statement> known = [] {
    using enum Statement;
    std::unordered_map<std::string_view, Statement> all;
    for (const char* name : {"vt",     "vn",     "vp",         "s",         "mg",    "bevel", "c_interp", "d_interp", "lod",
                             "maplib", "usemap", "shadow_obj", "trace_obj", "ctech", "stech", "cstype",   "deg",      "bmat",
                             "step",   "parm",   "trim",       "hole",      "scrv",  "sp",    "end",      "con"})
      all[name] = no_geometry;
    for (const char* name : {"p", "l"}) all[name] = points_and_lines;
    for (const char* name : {"curv", "curv2", "surf", "bsp", "bzp", "cdc", "cdp", "res"}) all[name] = free_form;
    for (const char* name : {"call", "csh"}) all[name] = foreign_file;
    return all;
  }();
  const auto found = known.find(word);
  return found == known.end() ? Statement::unknown : found->second;
}

/// The first number of "7", "7/1", "-2//3", 0 where no 64 bits hold it; the others must be numbers, or missing.
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
  ObjReader(const std::filesystem::path& file, const ReadFile& read) : name_(file.string()), materials_(file, read) {}

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
    switch (statement(first)) {
      case Statement::no_geometry:
        return;
      case Statement::points_and_lines: {
        const std::size_t ends = std::max<std::size_t>(lines.words_left(), 1);
        points_and_lines_ += first == "p" ? ends : std::max<std::size_t>(ends - 1, 1);
        return;
      }
      case Statement::free_form:
        ++free_form_;
        return;
      case Statement::foreign_file:
        throw Error("{}: '{}' wants another file or program, which is not read", lines.where(), first);
      case Statement::unknown:
        if (unknown_++ == 0) first_unknown_ = fmt::format("'{}' of line {}", first, lines.line_number());
    }
  }

  /// x y z, then a weight, or a color of 3 or 4, or both.
  void read_vertex(TextLines& lines) {
    glm::dvec3 position(0);
    for (int k = 0; k < 3; ++k) position[k] = lines.real();
    positions_.push_back(position);
    const std::size_t more = lines.words_left();
    for (std::size_t k = 0; k < more; ++k) {
      const double value = lines.number();
      weighted_ += more == 1 && value != 1;
    }
  }

  /// What is allowed is known at the end of the file.
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

  /// A group of the name of the one before goes on with it; an object of a name that was there does so with that one.
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
    Part& part = parts_[part_];
    if (part.material != name && !part.corner_counts.empty())
      begin_part(name);
    else
      part.material = name;
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

MeshFile read_obj(const std::filesystem::path& file, const ReadFile& read) {
  const std::string name = file.string(), bytes = read(file);
  return ObjReader(file, read).read(without_byte_order_mark(name, bytes));
}

}  // namespace gnomon::importing
