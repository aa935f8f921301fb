// OFF, as Geomview and its followers write it: [ST][C][N][4][n]OFF [BINARY], counts, vertices, faces.
// Source: Geomview manual, "OFF: Object File Format".
#include <bit>
#include <cmath>

#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

struct OffHeader {
  bool has_weight = false;  ///< a fourth coordinate, by which the others are divided
  bool has_normal = false, has_color = false, has_texture = false, is_binary = false;
  std::size_t vertex_count = 0, face_count = 0;
};

/// Reads the letters before OFF; returns what follows it: "8" of "COFF8".
std::string_view read_magic(const std::string& name, std::string_view word, OffHeader& header) {
  const std::size_t magic = word.find("OFF");
  std::string_view letters = word.substr(0, magic);
  // Geomview has them in this order; others write NCOFF.
  bool has_dimension = false;
  for (std::size_t before = 0; before != letters.size();) {
    before = letters.size();
    const auto take = [&](std::string_view letter, bool& is_there) {
      if (!letters.starts_with(letter)) return;
      is_there = true;
      letters.remove_prefix(letter.size());
    };
    take("ST", header.has_texture);
    take("C", header.has_color);
    take("N", header.has_normal);
    take("4", header.has_weight);
    take("n", has_dimension);
  }
  if (!letters.empty()) throw Error("{}: opens with '{}', not with [ST][C][N][4][n]OFF", name, word);
  if (has_dimension) throw Error("{}: opens with '{}': vertices of any number of dimensions are not read, 3 are", name, word);
  return word.substr(magic + 3);
}

/// Keyword and number of edges may both be missing.
OffHeader read_header(const std::string& name, TextLines& lines) {
  OffHeader header;
  if (!lines.next()) throw Error("{}: its head has no vertex and face counts", name);
  std::string_view first = lines.word();
  if (first.find("OFF") != first.npos) {
    first = read_magic(name, first, header);
    if (first.empty()) first = lines.word();
    header.is_binary = first == "BINARY";
    if (header.is_binary) return header;
    if (first.empty() && lines.next()) first = lines.word();
  }
  std::vector<std::size_t> counts;
  for (; counts.size() < 2; first = counts.size() < 2 ? lines.word() : std::string_view()) {
    if (first.empty() && !lines.next()) throw Error("{}: its head has no vertex and face counts", name);
    if (first.empty()) continue;
    const double count = lines.number(first);
    if (!(count >= 0 && count < 1e15 && count == std::floor(count)))
      throw Error("{}: count of vertices or faces = {} is not a whole number, 0 or more", lines.where(), first);
    counts.push_back(static_cast<std::size_t>(count));
  }
  header.vertex_count = counts[0];
  header.face_count = counts[1];
  if (TextLines ahead = lines; lines.words_left() == 0 && ahead.next() && ahead.words_left() == 1) lines.next();  // edges
  return header;
}

void need_room(const std::string& name, const OffHeader& header, std::size_t size) {
  if (header.vertex_count > size || header.face_count > size)
    throw Error("{}: declares {} vertices and {} faces in {} bytes; it is truncated", name, header.vertex_count,
                header.face_count, size);
}

/// Rounded to float32 once.
glm::dvec3 weighed(const glm::dvec3& p, double weight) { return glm::dvec3(glm::vec3(p / weight)); }

/// One line for each vertex and face; what follows the corners of a face is its color.
void read_lines(TextLines& lines, const OffHeader& header, MeshFile& answer) {
  ImportedMesh& mesh = answer.meshes.front();
  // After the position: a normal, a color of 3 or 4, and a place in the texture; without letters, nothing or a color.
  const std::size_t least = 3 + header.has_weight + 3 * header.has_normal + 3 * header.has_color + 2 * header.has_texture;
  std::size_t overlong = 0;
  for (std::size_t v = 0; v < header.vertex_count; ++v) {
    lines.begin("vertex", v, header.vertex_count);
    const glm::dvec3 position{lines.number(), lines.number(), lines.number()};
    mesh.positions.push_back(weighed(position, header.has_weight ? lines.number() : 1));
    const std::size_t words = 3 + header.has_weight + lines.words_left();
    if (words < least) throw Error("{}: vertex {} has {} numbers of {}; it is truncated", lines.where(), v, words, least);
    overlong += words > least + (header.has_color ? 1 : 0);
  }
  answer.note(overlong, "vert{ex has|ices have} more numbers than the head of the file names; the rest is left out");
  std::vector<std::uint32_t> face;
  for (std::size_t f = 0; f < header.face_count; ++f) {
    lines.begin("face", f, header.face_count);
    const double count = lines.number();
    need_corners(lines.where(), f, count);
    face.clear();
    for (double k = 0; k < count; ++k) {
      const double index = lines.number();
      need_vertex(lines.where(), f, index, header.vertex_count);
      face.push_back(static_cast<std::uint32_t>(index));
    }
    mesh.add_face(face);
  }
  answer.note(lines.lines_left(), "line{s} after the last face {is|are} left out");
}

/// Numbers of 32 bits, the highest byte first.
class BigEndian {
 public:
  BigEndian(const std::string& name, std::string_view bytes) : name_(name), rest_(bytes) {}
  std::uint32_t natural() {
    if (rest_.size() < 4) throw Error("{}: ends within its {}; it is truncated", name_, within);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 4; ++k) bits = bits << 8 | static_cast<unsigned char>(rest_[k]);
    rest_.remove_prefix(4);
    return bits;
  }
  float real() { return std::bit_cast<float>(natural()); }
  std::size_t left() const { return rest_.size(); }
  const char* within = "head";

 private:
  const std::string& name_;
  std::string_view rest_;
};

void read_bytes(const std::string& name, std::string_view bytes, OffHeader header, MeshFile& answer) {
  BigEndian in(name, bytes);
  ImportedMesh& mesh = answer.meshes.front();
  header.vertex_count = in.natural();
  header.face_count = in.natural();
  in.natural();  // edges
  need_room(name, header, bytes.size());
  in.within = "vertices";
  const int beside = 3 * header.has_normal + 4 * header.has_color + 2 * header.has_texture;
  for (std::size_t v = 0; v < header.vertex_count; ++v) {
    const glm::dvec3 position{in.real(), in.real(), in.real()};
    mesh.positions.push_back(weighed(position, header.has_weight ? in.real() : 1));
    for (int k = 0; k < beside; ++k) in.natural();
  }
  in.within = "faces";
  std::vector<std::uint32_t> face;
  for (std::size_t f = 0; f < header.face_count; ++f) {
    const std::uint32_t count = in.natural();
    need_corners(name, f, count);
    face.clear();
    for (std::uint32_t k = 0; k < count; ++k) {
      face.push_back(in.natural());
      need_vertex(name, f, face.back(), header.vertex_count);
    }
    mesh.add_face(face);
    const std::uint32_t colors = in.natural();
    if (colors > 4) throw Error("{}: face {} has {} numbers of a color; at most 4 are allowed", name, f, colors);
    for (std::uint32_t k = 0; k < colors; ++k) in.natural();
  }
  answer.note(in.left(), "byte{s} after the last face {is|are} left out");
}

}  // namespace

MeshFile read_off(const std::filesystem::path& file, const ReadFile& read) {
  const std::string name = file.string(), bytes = read(file);
  const std::string_view text = without_byte_order_mark(name, bytes);
  TextLines lines(name, text, '#');
  const OffHeader header = read_header(name, lines);
  MeshFile answer;
  answer.meshes.emplace_back();
  need_room(name, header, bytes.size());  // the head of a binary file has no counts
  if (header.is_binary)
    read_bytes(name, text.substr(lines.offset()), header, answer);
  else
    read_lines(lines, header, answer);
  return answer;
}

}  // namespace gnomon::importing
