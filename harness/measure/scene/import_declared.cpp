// Finds out whether a file is as long as its own head says, and whether its indices name what there is.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <fstream>
#include <sstream>

#include "measure/json.h"
#include "measure/scene/import_foreign.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

/// `OFF`, with a prefix for extra vertex data, then the counts of vertices, faces and edges; # opens a comment.
DeclaredCounts read_off(const fs::path& file) {
  std::ifstream in(file);
  BodyLines lines(file, in, 0);
  std::vector<std::string> words;
  for (std::string line; words.size() < 2 && lines.next(line);) {
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
  for (std::size_t v = 0; v < vertices; ++v) {
    lines.begin("vertex", v, vertices);
    for (int k = 0; k < 3; ++k) lines.word();
  }
  for (std::size_t f = 0; f < faces; ++f) {
    lines.begin("face", f, faces);
    lines.face(f, vertices);
  }
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
    const auto size_of = [&](const Json& object, const char* key) {
      const Json size = object.value(key, Json(std::uint64_t{0}));
      if (!size.is_number_unsigned()) throw Error("{}: {} = {} is not a whole number", file.string(), key, json_text(size));
      return size.get<std::uint64_t>();
    };
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
      const std::uint64_t begin = size_of(view, "byteOffset"), size = size_of(view, "byteLength");
      const std::uint64_t whole = size_of(items("buffers").at(size_of(view, "buffer")), "byteLength");
      if (begin > whole || size > whole - begin)
        throw Error("{}: a buffer view of {} bytes from byte {} ends after its buffer", file.string(), size, begin);
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
      const std::uint64_t begin = size_of(accessor, "byteOffset"), whole = size_of(view, "byteLength");
      const bool fits =
          begin <= whole && size <= whole - begin && (stride == 0 || count - 1 <= (whole - begin - size) / stride);
      if (count > 0 && !fits)
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
  if (extension == ".obj") check_obj(file);
  if (extension == ".3ds") check_3ds(file);
  constexpr std::size_t tail = 1024;
  if (extension == ".ifc" &&
      read_bytes(file, std::max(fs::file_size(file), tail) - tail, tail).find("END-ISO-10303-21;") == std::string::npos)
    throw Error("{}: does not end in END-ISO-10303-21; it is truncated", file.string());
  return {};
}

}  // namespace gnomon::importing
