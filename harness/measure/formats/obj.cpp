// OBJ: lines of vertices, faces and much else. Objects and groups become meshes, and so do the parts of them that have another
// material.
// Source: Wavefront, "Object Files (.obj)" and "Material Library File (.mtl)", Advanced Visualizer manual, appendix B1.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <unordered_map>

#include "measure/formats/obj_materials.h"
#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

// What a line may open with beside v, f, o, g, usemtl, mtllib, p and l.
constexpr std::string_view no_geometry[] = {"vn",     "vp",     "s",      "mg",         "bevel",     "c_interp", "d_interp",
                                            "lod",    "maplib", "usemap", "shadow_obj", "trace_obj", "ctech",    "stech",
                                            "cstype", "deg",    "bmat",   "step",       "parm",      "trim",     "hole",
                                            "scrv",   "sp",     "end",    "con"};
constexpr std::string_view free_form[] = {"curv", "curv2", "surf", "bsp", "bzp", "cdc", "cdp", "res"};
constexpr std::string_view foreign_file[] = {"call", "csh"};

/// The first two numbers of "7", "7/1", "-2//3": those of a vertex and of its texture coordinate, 0 where there is none. The
/// third must be a number, or missing. The vertex is 0 where a number exceeds 64 bits.
struct CornerNumbers {
  std::int64_t vertex = 0, place = 0;
};
CornerNumbers corner_numbers(std::string_view word, const TextLines& lines) {
  std::string_view rest = word;
  CornerNumbers numbers;
  for (int k = 0; k < 3; ++k) {
    std::int64_t value = 0;
    const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (code == std::errc::result_out_of_range) return {};
    if (code != std::errc{} && k == 0) break;
    if (k == 0) numbers.vertex = value;
    if (k == 1) numbers.place = value;
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
    if (!rest.starts_with('/')) break;
    rest.remove_prefix(1);
  }
  if (!rest.empty()) throw Error("{}: '{}' names no vertex", lines.where(), word);
  return numbers;
}

/// The faces of one object, or of one material in it.
struct Part {
  std::string name, material;
  std::vector<std::int64_t> corners;  ///< numbers of vertices, from 0
  std::vector<std::int64_t> places;   ///< of each corner the number of its texture coordinate, from 0, or `no_place`
  std::vector<std::uint32_t> corner_counts;
};
constexpr std::int64_t no_place = -1;

class ObjReader {
 public:
  ObjReader(const fs::path& file, const ReadFile& read, std::string_view text, bool with_uv)
      : name_(file.string()), text_(text), with_uv_(with_uv), materials_(file, read) {}

  MeshFile read() {
    TextLines lines(name_, text_, '#', true);
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
    if (first == "vt") return void(++place_count_);
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
      throw Error("{}: '{}' refers to another file or program, which is not read", lines.where(), first);
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

  /// From 0, `no_place` for 0; below that, counted back beyond the first.
  std::int64_t place_of(std::int64_t number) const {
    if (number >= 0) return number - 1;
    return number >= -place_count_ ? place_count_ + number : no_place - 1;
  }

  void read_face(TextLines& lines) {
    Part& part = current();
    std::uint32_t count = 0;
    for (std::string_view word = lines.word(); !word.empty(); word = lines.word()) {
      const auto [number, place] = corner_numbers(word, lines);
      if (number == 0 || number < -vertex_count()) note_outside(lines.line_number(), std::string(word));
      part.corners.push_back(number > 0 ? number - 1 : vertex_count() + number);
      part.places.push_back(place_of(place));
      if (part.corners.back() >= vertex_count()) ahead_.emplace_back(part.corners.back(), lines.line_number());
      ++count;
    }
    need_corners(lines.where(), part.corner_counts.size(), count);
    if (count < 3) {
      part.corners.resize(part.corners.size() - count);
      part.places.resize(part.corners.size());
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
    parts_.push_back({.name = name, .material = material_, .corners = {}, .places = {}, .corner_counts = {}});
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

  void finish(Part& part) {
    if (part.corner_counts.empty()) return;
    ImportedMesh& mesh = answer_.meshes.emplace_back();
    mesh.name = part.name;
    mesh.corner_counts = std::move(part.corner_counts);
    mesh.corners.reserve(part.corners.size());
    materials_.apply(part.material, mesh, answer_);
    const bool has_places = std::ranges::any_of(part.places, [](std::int64_t place) { return place != no_place; });
    if ((mesh.mask.has_image() || with_uv_) && has_places)
      add_places(part, mesh);
    else
      add_vertices(part, mesh);
  }

  /// Vertices in the order of the faces that use them.
  void add_vertices(const Part& part, ImportedMesh& mesh) {
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
  }

  /// The same where a vertex with two texture coordinates is two. One without any gets no numbers.
  void add_places(const Part& part, ImportedMesh& mesh) {
    read_places();
    std::unordered_map<std::int64_t, std::uint32_t> known;
    for (std::size_t c = 0; c < part.corners.size(); ++c) {
      const std::int64_t corner = part.corners[c], place = part.places[c];
      if (place >= place_count_ || place < no_place)
        throw Error("{}: mesh '{}', corner {}: texture coordinate {} is out of range: allowed are 1 .. {}, or counted back",
                    name_, part.name, c, place < no_place ? "before the first" : std::to_string(place + 1), place_count_);
      const auto count = static_cast<std::uint32_t>(mesh.positions.size());
      const auto [vertex, is_new] = known.emplace(corner * (place_count_ + 1) + place + 1, count);
      if (is_new) {
        mesh.positions.push_back(positions_[static_cast<std::size_t>(corner)]);
        mesh.uv.push_back(place == no_place ? glm::vec2(NAN) : uv_[static_cast<std::size_t>(place)]);
      }
      mesh.corners.push_back(vertex->second);
    }
  }

  /// v runs upwards in the file: 1 - v is in double, rounded once.
  void read_places() {
    if (!uv_.empty()) return;
    TextLines lines(name_, text_, '#', true);
    while (lines.next()) {
      if (lines.word() != "vt") continue;
      const double u = lines.number(), v = lines.words_left() > 0 ? lines.number() : 0;
      uv_.emplace_back(glm::dvec2(u, 1 - v));
    }
  }

  void note() {
    answer_.note(points_and_lines_, "{point or line is|points and lines are} left out");
    answer_.note(short_faces_, "face{s} {has|have} fewer than three corners and {is|are} left out");
    answer_.note(free_form_, "free-form {curve or surface is|curves and surfaces are} left out");
    answer_.note(weighted_, "vert{ex has|ices have} a weight, which is for free-form surfaces and not used");
    if (unknown_ > 0)
      answer_.note(unknown_, "line{s} {opens|open} with a word that is unknown to OBJ and {is|are} left out",
                   fmt::format(" ({})", first_unknown_));
    materials_.note(answer_);
  }

  static constexpr std::uint32_t unused = 0xffffffffu;

  const std::string name_;
  const std::string_view text_;
  const bool with_uv_;
  ObjMaterials materials_;
  MeshFile answer_;
  std::vector<glm::dvec3> positions_;
  std::int64_t place_count_ = 0;  ///< lines of texture coordinates so far
  std::vector<glm::vec2> uv_;     ///< those, read where a mesh needs them
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

MeshFile read_obj(const fs::path& file, const ReadFile& read, bool with_uv) {
  const std::string name = file.string(), bytes = read(file);
  return ObjReader(file, read, without_byte_order_mark(name, bytes), with_uv).read();
}

}  // namespace gnomon::importing
