// Finds out whether a file is as long as its own head says. Importers fill what is missing with what they read last, so this
// cannot be seen in what they return. Bodies are measured here, not understood; but an index that an importer refuses is found.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>

#include "measure/json.h"
#include "measure/scene/import.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& file, std::size_t offset, std::size_t size) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return bytes;
}

/// Little-endian 32 bits at `offset`; 0 beyond the end.
std::uint32_t word_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4 && offset + i < bytes.size(); ++i)
    word |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  return word;
}

void need_length(const fs::path& file, std::uint64_t declared) {
  if (fs::file_size(file) < declared)
    throw Error("{}: is {} bytes long but declares {}; it is truncated", file.string(), fs::file_size(file), declared);
}

/// The next line that holds more than a comment, without that; `number` counts all lines.
bool next_line(std::istream& in, std::string& line, long& number) {
  do {
    if (!std::getline(in, line)) return false;
    ++number;
    line.resize(std::min(line.find('#'), line.size()));
  } while (line.find_first_not_of(" \t\r") == std::string::npos);
  return true;
}

/// Text bodies of PLY and OFF have one line per element; the importer fills missing lines with whatever it read last. Needs
/// `count` lines, and on the last of them, where it is a face, as many corners as it announces.
void need_lines(const fs::path& file, std::istream& in, std::size_t count, bool ends_in_face) {
  std::size_t found = 0;
  long number = 0;
  std::string line, last;
  for (; found < count && next_line(in, line, number); ++found) std::swap(last, line);
  if (found < count) throw Error("{}: declares {} lines but holds {}; it is truncated", file.string(), count, found);
  if (!ends_in_face || count == 0) return;
  std::istringstream words(last);
  std::size_t corners = 0, there = 0;
  words >> corners;
  for (std::string word; words >> word;) ++there;
  if (there < corners) throw Error("{}: its last face has {} of {} corners; it is truncated", file.string(), there, corners);
}

struct PlyProperty {
  std::size_t size = 0;        ///< bytes of one value
  std::size_t count_size = 0;  ///< bytes of the count that opens a list; 0 for a single value
};
struct PlyElement {
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;
};

std::size_t ply_size(const fs::path& file, const std::string& type) {
  static const std::pair<std::string_view, std::size_t> sizes[] = {
      {"char", 1}, {"uchar", 1}, {"int8", 1},  {"uint8", 1},  {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
      {"int", 4},  {"uint", 4},  {"int32", 4}, {"uint32", 4}, {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  for (const auto& [name, size] : sizes)
    if (name == type) return size;
  throw Error("{}: property type '{}' is unknown to PLY", file.string(), type);
}

/// Walks the lists of a binary body from count to count.
void need_ply_bytes(const fs::path& file, std::istream& in, const std::vector<PlyElement>& elements, bool big_endian) {
  const std::uint64_t length = fs::file_size(file);
  std::uint64_t position = static_cast<std::uint64_t>(in.tellg());
  for (const PlyElement& element : elements)
    for (std::size_t i = 0; i < element.count; ++i)
      for (const PlyProperty& property : element.properties) {
        std::uint64_t values = 1;
        if (property.count_size > 0) {
          unsigned char bytes[8] = {};
          in.seekg(static_cast<std::streamoff>(position));
          in.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(property.count_size));
          values = 0;
          for (std::size_t k = 0; k < property.count_size; ++k)
            values = values << 8 | bytes[big_endian ? k : property.count_size - 1 - k];
        }
        // The count of a list may be anything: its bytes are not multiplied before they can be there.
        const bool fits = values <= length && (position += property.count_size + values * property.size) <= length;
        if (!fits) throw Error("{}: ends within {} {} of {}; it is truncated", file.string(), element.name, i, element.count);
      }
}

DeclaredCounts read_ply(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::vector<PlyElement> elements;
  std::string format, first;
  for (std::string line; first != "end_header" && std::getline(in, line);) {
    std::istringstream words(line);
    std::string type, count_type;
    first.clear();
    words >> first;
    if (first == "format") words >> format;
    if (first == "element") {
      PlyElement& element = elements.emplace_back();
      if (!(words >> element.name >> element.count)) throw Error("{}: '{}' has no count", file.string(), line);
      if (element.count > fs::file_size(file))
        throw Error("{}: declares {} {} elements in {} bytes; it is truncated", file.string(), element.count, element.name,
                    fs::file_size(file));
    }
    if (first == "property" && !elements.empty() && words >> type) {
      const bool is_list = type == "list";
      if (is_list) words >> count_type >> type;
      elements.back().properties.push_back({ply_size(file, type), is_list ? ply_size(file, count_type) : 0});
    }
  }
  if (first != "end_header") throw Error("{}: its header has no end_header; it is truncated", file.string());
  DeclaredCounts declared;
  std::size_t lines = 0;
  for (const PlyElement& element : elements) {
    if (element.name == "vertex") declared.vertex_count = element.count;
    if (element.name == "face") declared.face_count = element.count;
    lines += element.count;
  }
  if (format.starts_with("binary"))
    need_ply_bytes(file, in, elements, format == "binary_big_endian");
  else
    need_lines(file, in, lines, !elements.empty() && elements.back().name == "face" && elements.back().properties.size() == 1);
  return declared;
}

/// Faces "n i1 .. in", one a line, which count vertices from 0; importers take some that there are not. `number`: of the line
/// before them.
void need_vertices(const fs::path& file, std::istream& in, std::size_t face_count, std::size_t vertex_count, long number) {
  std::string line;
  for (std::size_t f = 0; f < face_count && next_line(in, line, number); ++f) {
    const char *at = line.data(), *const end = at + line.size();
    const auto read = [&](auto& value) {
      while (at != end && std::isspace(static_cast<unsigned char>(*at))) ++at;
      const auto [rest, code] = std::from_chars(at, end, value);
      at = rest;
      return code == std::errc{};
    };
    std::int64_t corners = 0, index = 0;
    if (!read(corners)) continue;
    if (corners > std::int64_t{most_corners})
      throw Error("{}:{}: face {} has {} corners; at most {} are taken", file.string(), number, f, corners, most_corners);
    for (std::int64_t c = 0; c < corners && read(index); ++c)
      if (index < 0 || static_cast<std::size_t>(index) >= vertex_count)
        throw Error("{}:{}: face {} names vertex {}, out of range: allowed are 0 .. {}", file.string(), number, f, index,
                    static_cast<std::int64_t>(vertex_count) - 1);
  }
}

/// `OFF`, with a prefix for extra vertex data, then the counts of vertices, faces and edges; # opens a comment.
DeclaredCounts read_off(const fs::path& file) {
  std::ifstream in(file);
  std::vector<std::string> words;
  long number = 0;
  for (std::string line; words.size() < 2 && next_line(in, line, number);) {
    std::istringstream text(line);
    for (std::string word; text >> word;) words.push_back(word);
    if (!words.empty() && words[0].ends_with("OFF")) words.erase(words.begin());
  }
  std::size_t vertices = 0, faces = 0;
  const auto parse = [&](std::size_t i, std::size_t& count) {
    if (i >= words.size()) return false;
    const char* end = words[i].data() + words[i].size();
    return std::from_chars(words[i].data(), end, count).ptr == end;
  };
  if (!parse(0, vertices) || !parse(1, faces)) throw Error("{}: its head has no vertex and face counts", file.string());
  if (vertices > fs::file_size(file) || faces > fs::file_size(file))
    throw Error("{}: declares {} vertices and {} faces in {} bytes; it is truncated", file.string(), vertices, faces,
                fs::file_size(file));
  const auto body = in.tellg();
  need_lines(file, in, vertices + faces, faces > 0);
  in.clear();
  in.seekg(body);
  std::string line;
  for (std::size_t v = 0; v < vertices; ++v) next_line(in, line, number);
  need_vertices(file, in, faces, vertices, number);
  return {.vertex_count = std::nullopt, .face_count = faces};
}

/// Binary: 80 bytes of anything, a count, 50 bytes a facet. Many binary files open with `solid` too, so length decides.
DeclaredCounts read_stl(const fs::path& file) {
  const std::string head = read_bytes(file, 0, 84);
  const std::uint64_t count = word_at(head, 80), length = 84 + 50 * count;
  if (!head.starts_with("solid") || fs::file_size(file) == length) {
    if (head.size() < 84) throw Error("{}: is {} bytes long; a binary STL has at least 84", file.string(), head.size());
    need_length(file, length);
    return {.vertex_count = std::nullopt, .face_count = count};
  }
  std::ifstream in(file);
  DeclaredCounts declared{.vertex_count = std::nullopt, .face_count = 0};
  bool ended = false;
  for (std::string word; in >> word;) {
    std::ranges::transform(word, word.begin(), [](unsigned char c) { return std::tolower(c); });
    if (word == "facet") ++*declared.face_count;
    ended = ended || word == "endsolid";
  }
  if (!ended) throw Error("{}: has no endsolid after {} facets; it is truncated", file.string(), *declared.face_count);
  return declared;
}

/// Buffers must hold their views, and views their accessors; `binary_size` is that of the GLB's own buffer.
void check_gltf(const fs::path& file, const std::string& text, std::size_t binary_size) {
  try {
    const Json json = parse_json(text);
    const auto size_of = [](const Json& object, const char* key) { return object.value(key, std::uint64_t{0}); };
    const Json none = Json::array();
    const auto items = [&](const char* key) -> const Json& { return json.contains(key) ? json.at(key) : none; };
    if (!items("buffers").is_array() || !items("accessors").is_array()) return;  // glTF 1.0 keeps objects here
    for (const Json& buffer : items("buffers")) {
      const std::string uri = buffer.value("uri", "");
      const std::uint64_t declared = size_of(buffer, "byteLength");
      std::uint64_t have = binary_size;
      if (uri.starts_with("data:")) {
        have = (uri.size() - uri.find(',')) / 4 * 3;
      } else if (!uri.empty()) {
        const fs::path path = file.parent_path() / uri;
        if (!fs::is_regular_file(path)) throw Error("{}: its buffer {} does not exist", file.string(), path.string());
        have = fs::file_size(path);
      }
      if (have < declared)
        throw Error("{}: a buffer holds {} bytes but declares {}; it is truncated", file.string(), have, declared);
    }
    for (const Json& view : items("bufferViews")) {
      const std::uint64_t end = size_of(view, "byteOffset") + size_of(view, "byteLength");
      if (end > size_of(items("buffers").at(size_of(view, "buffer")), "byteLength"))
        throw Error("{}: a buffer view ends at byte {}, after its buffer", file.string(), end);
    }
    for (const Json& accessor : items("accessors")) {
      if (!accessor.contains("bufferView")) continue;
      static const std::pair<const char*, unsigned> widths[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
      const unsigned type = accessor.value("componentType", 0u);
      const unsigned bytes = type == 5120 || type == 5121 ? 1 : type == 5122 || type == 5123 ? 2 : 4;
      std::uint64_t size = 0;
      for (const auto& [name, width] : widths)
        if (accessor.value("type", "") == name) size = std::uint64_t{width} * bytes;
      const Json& view = items("bufferViews").at(size_of(accessor, "bufferView"));
      const std::uint64_t count = size_of(accessor, "count"), stride = view.value("byteStride", size);
      if (count > 0 && size_of(accessor, "byteOffset") + (count - 1) * stride + size > size_of(view, "byteLength"))
        throw Error("{}: an accessor declares {} elements, more than its buffer view holds", file.string(), count);
    }
  } catch (const Json::exception& problem) {
    throw Error("{}: is not sound glTF: {}", file.string(), complaint(problem));
  }
}

void check_glb(const fs::path& file) {
  const std::string head = read_bytes(file, 0, 20);
  if (head.size() < 20 || !head.starts_with("glTF")) throw Error("{}: has no GLB header", file.string());
  need_length(file, word_at(head, 8));
  if (word_at(head, 4) < 2) return;  // GLB 1 is laid out in another way
  const std::size_t json_size = word_at(head, 12), binary = 20 + json_size;
  need_length(file, binary);
  const std::string binary_head = read_bytes(file, binary, 8);
  check_gltf(file, read_bytes(file, 20, json_size), word_at(binary_head, 0));
}

/// Vertex index that a face's corner starts with ("7", "7/1", "-2//3"); nothing when it is no number.
std::optional<long> leading_index(const std::string& word) {
  long index = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), index);
  if (code != std::errc{} || end == word.data()) return std::nullopt;
  return index;
}

/// Faces count from 1, or back from the last vertex so far; vertices may follow the faces that name them.
void check_obj(std::ifstream& in, const std::string& name) {
  long total = 0;
  std::string line, word;
  while (std::getline(in, line)) total += line.starts_with("v ");
  in.clear();
  in.seekg(0);
  long number = 0, so_far = 0;
  while (std::getline(in, line)) {
    ++number;
    so_far += line.starts_with("v ");
    if (!line.starts_with("f ")) continue;
    std::istringstream words(line.substr(2));
    while (words >> word)
      if (const auto index = leading_index(word); index && (*index == 0 || *index > total || -*index > so_far))
        throw Error("{}:{}: face names vertex {}, out of range: allowed are 1 .. {}, or -1 .. -{} counted back", name, number,
                    *index, total, so_far);
  }
}

}  // namespace

std::string lower_extension(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return std::tolower(c); });
  return extension;
}

DeclaredCounts read_declared(const fs::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".ply") return read_ply(file);
  if (extension == ".off") return read_off(file);
  if (extension == ".stl") return read_stl(file);
  if (extension == ".glb") check_glb(file);
  if (extension == ".gltf") check_gltf(file, read_bytes(file, 0, fs::file_size(file)), 0);
  if (extension == ".3ds") need_length(file, word_at(read_bytes(file, 0, 6), 2));  // the outermost chunk is the file
  constexpr std::size_t tail = 1024;
  if (extension == ".ifc" &&
      read_bytes(file, std::max(fs::file_size(file), tail) - tail, tail).find("END-ISO-10303-21;") == std::string::npos)
    throw Error("{}: does not end in END-ISO-10303-21; it is truncated", file.string());
  return {};
}

void blame_index(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (lower_extension(file) == ".obj") check_obj(in, file.string());
}

}  // namespace gnomon::importing
