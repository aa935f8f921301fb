// PLY: a header that names elements and the types of their properties, then a body of lines or of bytes.
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

struct PlyType {
  enum class Kind { whole, natural, real } kind = Kind::natural;
  std::size_t size = 1;  ///< bytes
};
/// The use of a value.
enum class Use { none, corners, x, y, z };
struct PlyProperty {
  PlyType type;
  std::optional<PlyType> count_type;  ///< of the count that opens a list; none for a single value
  Use use = Use::none;
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  bool is_vertex() const { return name == "vertex"; }
  bool is_strips() const { return name == "tristrips"; }
  bool is_faces() const { return name == "face" || is_strips(); }
};
enum class PlyForm { unknown, lines, little_endian, big_endian };
struct PlyHeader {
  std::vector<PlyElement> elements;
  PlyForm form = PlyForm::unknown;
  std::size_t vertex_count = 0, unknown_count = 0;  ///< unknown: lines, such as a comment without its keyword
};

PlyType ply_type(const TextLines& lines, std::string_view name) {
  using enum PlyType::Kind;
  static const std::pair<std::string_view, PlyType> types[] = {
      {"char", {whole, 1}},  {"int8", {whole, 1}},   {"uchar", {natural, 1}},  {"uint8", {natural, 1}},
      {"short", {whole, 2}}, {"int16", {whole, 2}},  {"ushort", {natural, 2}}, {"uint16", {natural, 2}},
      {"int", {whole, 4}},   {"int32", {whole, 4}},  {"uint", {natural, 4}},   {"uint32", {natural, 4}},
      {"float", {real, 4}},  {"float32", {real, 4}}, {"double", {real, 8}},    {"float64", {real, 8}}};
  for (const auto& [known, type] : types)
    if (known == name) return type;
  throw Error("{}: property type '{}' is unknown to PLY", lines.where(), name);
}

PlyForm ply_form(const TextLines& lines, std::string_view name) {
  if (name == "ascii") return PlyForm::lines;
  if (name == "binary_little_endian") return PlyForm::little_endian;
  if (name == "binary_big_endian") return PlyForm::big_endian;
  throw Error("{}: format '{}' is none of ascii, binary_little_endian, binary_big_endian", lines.where(), name);
}

Use use_of(const PlyElement& element, bool is_list, std::string_view name) {
  if (is_list) return element.is_faces() && (name == "vertex_indices" || name == "vertex_index") ? Use::corners : Use::none;
  if (!element.is_vertex() || name.size() != 1) return Use::none;
  return name == "x" ? Use::x : name == "y" ? Use::y : name == "z" ? Use::z : Use::none;
}

PlyProperty read_property(TextLines& lines, const PlyElement& element) {
  PlyProperty property;
  std::string_view type = lines.need_word();
  const bool is_list = type == "list";
  if (is_list) {
    const std::string_view count_type = lines.need_word();
    property.count_type = ply_type(lines, count_type);
    if (property.count_type->kind == PlyType::Kind::real)
      throw Error("{}: the count of a list is of type '{}', not of whole numbers", lines.where(), count_type);
    type = lines.need_word();
  }
  property.type = ply_type(lines, type);
  property.use = use_of(element, is_list, lines.need_word());
  return property;
}

/// Leaves `lines` before the body.
PlyHeader read_header(const std::string& name, TextLines& lines, std::size_t file_size) {
  if (!lines.next() || lines.word() != "ply") throw Error("{}: does not open with 'ply'", name);
  PlyHeader header;
  for (std::string_view first; first != "end_header";) {
    if (!lines.next()) throw Error("{}: its header has no end_header; it is truncated", name);
    first = lines.word();
    if (first == "format") {
      header.form = ply_form(lines, lines.need_word());
    } else if (first == "element") {
      PlyElement& element = header.elements.emplace_back();
      element.name = lines.need_word();
      element.count = lines.count("count of elements");
      if (element.count > file_size)
        throw Error("{}: declares {} {} elements in {} bytes; it is truncated", lines.where(), element.count, element.name,
                    file_size);
      if (!element.is_vertex()) continue;
      if (header.vertex_count > 0) throw Error("{}: element vertex is given twice", lines.where());
      header.vertex_count = element.count;
    } else if (first == "property") {
      if (header.elements.empty()) throw Error("{}: a property is before the first element", lines.where());
      header.elements.back().properties.push_back(read_property(lines, header.elements.back()));
    } else if (first != "comment" && first != "obj_info" && first != "end_header") {
      ++header.unknown_count;
    }
  }
  if (header.form == PlyForm::unknown) throw Error("{}: its header has no format", name);
  for (const PlyElement& element : header.elements) {
    const auto uses = [&](Use use) { return std::ranges::count(element.properties, use, &PlyProperty::use) == 1; };
    if (element.is_vertex() && element.count > 0 && !(uses(Use::x) && uses(Use::y) && uses(Use::z)))
      throw Error("{}: element vertex has not one property x, one y and one z", name);
    if (element.is_faces() && element.count > 0 && !uses(Use::corners))
      throw Error("{}: element {} has not one list vertex_indices", name, element.name);
  }
  return header;
}

/// The values of a body of lines.
class LineBody {
 public:
  explicit LineBody(TextLines& lines) : lines_(lines) {}
  void begin(const PlyElement& element, std::size_t place) { lines_.begin(element.name, place, element.count); }
  double value(PlyType type) { return type.size == 4 && type.kind == PlyType::Kind::real ? lines_.real() : lines_.number(); }
  void skip(PlyType, double count) {
    for (double k = 0; k < count; ++k) lines_.need_word();
  }
  void end() { overlong_ += !lines_.word().empty(); }
  std::string where() const { return lines_.where(); }
  void note_rest(MeshFile& answer) {
    answer.note(overlong_, "line{s} {holds|hold} more than the properties; the rest is left out");
    answer.note(lines_.lines_left(), "line{s} after the last element {is|are} left out");
  }

 private:
  TextLines& lines_;
  std::size_t overlong_ = 0;
};

/// The values of a body of bytes.
class ByteBody {
 public:
  ByteBody(const std::string& name, std::string_view bytes, bool is_big_endian)
      : name_(name), rest_(bytes), is_big_endian_(is_big_endian) {}
  void begin(const PlyElement& element, std::size_t place) {
    element_ = &element;
    place_ = place;
  }
  double value(PlyType type) {
    need(type.size);
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < type.size; ++k)
      bits = bits << 8 | static_cast<unsigned char>(rest_[is_big_endian_ ? k : type.size - 1 - k]);
    rest_.remove_prefix(type.size);
    if (type.kind == PlyType::Kind::natural) return static_cast<double>(bits);
    if (type.kind == PlyType::Kind::real)
      return type.size == 8 ? std::bit_cast<double>(bits) : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    const auto unused = static_cast<int>(64 - 8 * type.size);
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }
  /// The count of a list may be anything: its bytes are not multiplied before they can be there.
  void skip(PlyType type, double count) {
    need(count >= 0 && count <= static_cast<double>(rest_.size()) ? static_cast<std::size_t>(count) * type.size
                                                                  : rest_.size() + 1);
    rest_.remove_prefix(static_cast<std::size_t>(count) * type.size);
  }
  void end() {}
  const std::string& where() const { return name_; }
  void note_rest(MeshFile& answer) { answer.note(rest_.size(), "byte{s} after the last element {is|are} left out"); }

 private:
  void need(std::size_t size) const {
    if (size > rest_.size())
      throw Error("{}: ends within {} {} of {}; it is truncated", name_, element_->name, place_, element_->count);
  }
  const std::string& name_;
  std::string_view rest_;
  bool is_big_endian_;
  const PlyElement* element_ = nullptr;
  std::size_t place_ = 0;
};

/// Triangles of a strip, every second one turned round; -1 ends a strip and begins the next.
void add_strip(std::span<const std::int64_t> corners, ImportedMesh& mesh) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] < 0) begin = i + 1;
    if (corners[i] < 0 || i < begin + 2) continue;
    const auto at = [&](std::size_t k) { return static_cast<std::uint32_t>(corners[k]); };
    if ((i - begin) % 2 == 0)
      mesh.add_triangle(at(i - 2), at(i - 1), at(i));
    else
      mesh.add_triangle(at(i - 1), at(i - 2), at(i));
  }
}

template <class Body>
class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Body body) : header_(header), body_(std::move(body)) {}

  MeshFile read() {
    mesh_.positions.reserve(header_.vertex_count);
    answer_.note(header_.unknown_count,
                 "line{s} of the header {opens|open} with a word that is unknown to PLY and {is|are} left out");
    std::size_t others = 0;
    for (const PlyElement& element : header_.elements) {
      if (!element.properties.empty()) read(element);
      constexpr std::size_t most_notes = 10;
      if (element.is_vertex() || element.is_faces() || element.count == 0) continue;
      if (answer_.notes.size() < most_notes)
        answer_.note(element.count, "element{s} {is|are} left out", fmt::format(": '{}'", element.name));
      else
        others += element.count;
    }
    answer_.note(others, "element{s} of other kinds {is|are} left out");
    body_.note_rest(answer_);
    return std::move(answer_);
  }

 private:
  void read(const PlyElement& element) {
    for (std::size_t i = 0; i < element.count; ++i) {
      body_.begin(element, i);
      glm::dvec3 position(0);
      for (const PlyProperty& property : element.properties) read(element, i, property, position);
      body_.end();
      if (element.is_vertex()) mesh_.positions.push_back(position);
    }
  }
  void read(const PlyElement& element, std::size_t place, const PlyProperty& property, glm::dvec3& position) {
    if (property.use == Use::none) body_.skip(property.type, property.count_type ? body_.value(*property.count_type) : 1);
    if (property.use == Use::corners) read_corners(element, place, property);
    if (property.use >= Use::x)
      position[static_cast<int>(property.use) - static_cast<int>(Use::x)] = body_.value(property.type);
  }
  void read_corners(const PlyElement& element, std::size_t place, const PlyProperty& property) {
    const double count = body_.value(*property.count_type);
    if (!element.is_strips())
      need_corners(body_.where(), place, count);
    else if (!(count >= 0 && count == std::floor(count)))
      throw Error("{}: strip {} has {} corners; a whole number is allowed", body_.where(), place, count);
    strip_.clear();
    face_.clear();
    for (double k = 0; k < count; ++k) {
      const double index = body_.value(property.type);
      const bool ends_strip = element.is_strips() && index == -1;
      if (!ends_strip) need_vertex(body_.where(), place, index, header_.vertex_count);
      if (element.is_strips())
        strip_.push_back(static_cast<std::int64_t>(index));
      else
        face_.push_back(static_cast<std::uint32_t>(index));
    }
    if (element.is_strips())
      add_strip(strip_, mesh_);
    else
      mesh_.add_face(face_);
  }

  const PlyHeader& header_;
  Body body_;
  MeshFile answer_;
  ImportedMesh& mesh_ = answer_.meshes.emplace_back();
  std::vector<std::uint32_t> face_;
  std::vector<std::int64_t> strip_;
};

}  // namespace

MeshFile read_ply(const std::filesystem::path& file, const ReadFile& read) {
  const std::string name = file.string(), bytes = read(file);
  const std::string_view text = without_byte_order_mark(name, bytes);
  TextLines lines(name, text, 0);
  const PlyHeader header = read_header(name, lines, bytes.size());
  if (header.form == PlyForm::lines) return PlyReader(header, LineBody(lines)).read();
  // Where lines end in \r alone, a \n after the last one is the first byte of the body.
  const bool ends_in_return = text.substr(3).starts_with('\r') && !text.substr(3).starts_with("\r\n");
  const std::size_t body = lines.offset() - (ends_in_return && text[lines.offset() - 1] == '\n' ? 1 : 0);
  return PlyReader(header, ByteBody(name, text.substr(body), header.form == PlyForm::big_endian)).read();
}

}  // namespace gnomon::importing
