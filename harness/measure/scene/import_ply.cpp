// PLY: a header that names elements and the types of their properties, then a body of lines or of bytes.
#include <algorithm>
#include <bit>
#include <fstream>
#include <sstream>

#include "measure/scene/import_foreign.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

struct PlyType {
  enum class Kind { whole, natural, real } kind = Kind::natural;
  std::size_t size = 1;  ///< bytes
};
struct PlyProperty {
  PlyType type;
  std::optional<PlyType> count_type;  ///< of the count that opens a list; none for a single value
  bool names_vertices = false;
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

PlyType ply_type(const fs::path& file, const std::string& name) {
  using enum PlyType::Kind;
  static const std::pair<std::string_view, PlyType> types[] = {
      {"char", {whole, 1}},  {"int8", {whole, 1}},   {"uchar", {natural, 1}},  {"uint8", {natural, 1}},
      {"short", {whole, 2}}, {"int16", {whole, 2}},  {"ushort", {natural, 2}}, {"uint16", {natural, 2}},
      {"int", {whole, 4}},   {"int32", {whole, 4}},  {"uint", {natural, 4}},   {"uint32", {natural, 4}},
      {"float", {real, 4}},  {"float32", {real, 4}}, {"double", {real, 8}},    {"float64", {real, 8}}};
  for (const auto& [known, type] : types)
    if (known == name) return type;
  throw Error("{}: property type '{}' is unknown to PLY", file.string(), name);
}

struct PlyHeader {
  std::vector<PlyElement> elements;
  std::string format;
  long line_count = 0;
};

PlyHeader read_header(const fs::path& file, std::istream& in) {
  PlyHeader header;
  std::string first;
  for (std::string line; first != "end_header" && std::getline(in, line);) {
    ++header.line_count;
    std::istringstream words(line);
    std::string type, count_type, name;
    first.clear();
    words >> first;
    if (first == "format") words >> header.format;
    if (first == "element") {
      PlyElement& element = header.elements.emplace_back();
      if (!(words >> element.name >> element.count)) throw Error("{}: '{}' has no count", file.string(), line);
      if (element.count > fs::file_size(file))
        throw Error("{}: declares {} {} elements in {} bytes; it is truncated", file.string(), element.count, element.name,
                    fs::file_size(file));
    }
    if (first == "property" && !header.elements.empty() && words >> type) {
      PlyElement& element = header.elements.back();
      const bool is_list = type == "list";
      if (is_list) words >> count_type >> type;
      words >> name;
      PlyProperty& property = element.properties.emplace_back();
      property.type = ply_type(file, type);
      if (is_list) property.count_type = ply_type(file, count_type);
      property.names_vertices = is_list && element.name == "face" && (name == "vertex_indices" || name == "vertex_index");
    }
  }
  if (first != "end_header") throw Error("{}: its header has no end_header; it is truncated", file.string());
  return header;
}

/// One line for each element.
void check_lines(const fs::path& file, std::istream& in, const PlyHeader& header, std::size_t vertex_count) {
  BodyLines lines(file, in, header.line_count);
  for (const PlyElement& element : header.elements)
    for (std::size_t i = 0; i < element.count; ++i) {
      lines.begin(element.name, i, element.count);
      for (const PlyProperty& property : element.properties) {
        if (property.names_vertices) {
          lines.face(i, vertex_count);
        } else {
          const double values = property.count_type ? lines.number() : 1;
          for (double k = 0; k < values; ++k) lines.word();
        }
      }
    }
}

/// Reads values one behind the other, and knows how many bytes are left.
class BinaryBody {
 public:
  BinaryBody(std::istream& in, std::uint64_t left, bool big_endian) : in_(in), left_(left), big_endian_(big_endian) {}

  std::uint64_t left() const { return left_; }
  bool skip(std::uint64_t size) {
    if (size > left_) return false;
    left_ -= size;
    in_.seekg(static_cast<std::streamoff>(size), std::ios::cur);
    return true;
  }
  std::optional<double> value(PlyType type) {
    unsigned char bytes[8] = {};
    if (type.size > left_ || !in_.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(type.size))) return {};
    left_ -= type.size;
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < type.size; ++k) bits = bits << 8 | bytes[big_endian_ ? k : type.size - 1 - k];
    if (type.kind == PlyType::Kind::natural) return static_cast<double>(bits);
    if (type.kind == PlyType::Kind::real)
      return type.size == 8 ? std::bit_cast<double>(bits) : std::bit_cast<float>(static_cast<std::uint32_t>(bits));
    const auto unused = static_cast<int>(64 - 8 * type.size);
    return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
  }

 private:
  std::istream& in_;
  std::uint64_t left_;
  bool big_endian_;
};

/// Whether an element, counted from 0, is there to its end.
bool read_element(const fs::path& file, BinaryBody& body, const PlyElement& element, std::size_t place,
                  std::size_t vertex_count) {
  for (const PlyProperty& property : element.properties) {
    std::optional<double> values = 1;
    if (property.count_type) values = body.value(*property.count_type);
    // The count of a list may be anything: its bytes are not multiplied before they can be there.
    if (!values || !(*values >= 0 && *values <= static_cast<double>(body.left()))) return false;
    if (!property.names_vertices) {
      if (!body.skip(static_cast<std::uint64_t>(*values) * property.type.size)) return false;
      continue;
    }
    need_corners(file.string(), place, *values);
    for (double k = 0; k < *values; ++k) {
      const std::optional<double> index = body.value(property.type);
      if (!index) return false;
      need_vertex(file.string(), place, *index, vertex_count);
    }
  }
  return true;
}

void check_bytes(const fs::path& file, std::istream& in, const PlyHeader& header, std::size_t vertex_count) {
  BinaryBody body(in, fs::file_size(file) - static_cast<std::uint64_t>(in.tellg()), header.format == "binary_big_endian");
  for (const PlyElement& element : header.elements) {
    const auto refuse = [&](std::uint64_t place) {
      throw Error("{}: ends within {} {} of {}; it is truncated", file.string(), element.name, place, element.count);
    };
    std::uint64_t size = 0;
    for (const PlyProperty& property : element.properties) size += property.type.size;
    if (std::ranges::any_of(element.properties, [](const PlyProperty& p) { return p.count_type.has_value(); })) {
      for (std::size_t i = 0; i < element.count; ++i)
        if (!read_element(file, body, element, i, vertex_count)) refuse(i);
    } else if (size > 0) {
      if (element.count > body.left() / size) refuse(body.left() / size);
      body.skip(element.count * size);
    }
  }
}

}  // namespace

DeclaredCounts read_ply(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const PlyHeader header = read_header(file, in);
  DeclaredCounts declared;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") declared.vertex_count = element.count;
    if (element.name == "face") declared.face_count = element.count;
  }
  const std::size_t vertex_count = declared.vertex_count.value_or(0);
  if (header.format.starts_with("binary"))
    check_bytes(file, in, header, vertex_count);
  else
    check_lines(file, in, header, vertex_count);
  return declared;
}

}  // namespace gnomon::importing
