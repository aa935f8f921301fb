// STL: binary (80 bytes of anything, a count, 50 bytes a facet) or text (solid, facets, endsolid).
#include <bit>

#include "measure/formats/readers.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

constexpr std::size_t head_size = 84, facet_size = 50;

std::uint64_t declared_size(std::string_view bytes) { return head_size + facet_size * std::uint64_t{word_at(bytes, 80)}; }

/// No binary file of a few facets is without a zero byte.
bool looks_like_text(std::string_view bytes) { return bytes.substr(0, 1000).find('\0') == bytes.npos; }

/// Many binary files open with `solid` as well, so their length decides; where it does not match, zero bytes do.
bool is_text(const std::string& name, std::string_view bytes) {
  TextLines lines(name, bytes, 0);
  return lines.next() && same_word(lines.word(), "solid") && looks_like_text(bytes);
}

MeshFile read_binary(const std::string& name, std::string_view bytes) {
  if (bytes.size() < head_size)
    throw Error("{}: is {} bytes long and opens with no 'solid'; a binary STL has at least 84", name, bytes.size());
  const std::uint64_t size = declared_size(bytes);
  if (bytes.size() < size && looks_like_text(bytes))
    throw Error("{}: is neither a text that opens with 'solid' nor a binary STL, which has zero bytes", name);
  if (bytes.size() < size) throw Error("{}: is {} bytes long but declares {}; it is truncated", name, bytes.size(), size);
  MeshFile answer;
  ImportedMesh& mesh = answer.meshes.emplace_back();
  const std::uint32_t count = word_at(bytes, 80);
  mesh.positions.reserve(std::size_t{3} * count);
  for (std::uint32_t f = 0; f < count; ++f) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t begin = head_size + facet_size * f + 12 + 12 * corner;
      const auto real = [&](std::size_t k) { return std::bit_cast<float>(word_at(bytes, begin + 4 * k)); };
      mesh.positions.emplace_back(real(0), real(1), real(2));
    }
    mesh.add_triangle(3 * f, 3 * f + 1, 3 * f + 2);
  }
  answer.note(bytes.size() - size, "byte{s} after the last facet {is|are} left out");
  return answer;
}

/// Words one after the other, wherever lines end; but a name goes to the end of its line.
class Words {
 public:
  Words(const std::string& name, std::string_view text) : name_(name), lines_(name, text, 0) {}
  /// Empty at the end of the file.
  std::string_view next() {
    std::string_view word = lines_.word();
    while (word.empty() && lines_.next()) word = lines_.word();
    return word;
  }
  std::string_view need() {
    const std::string_view word = next();
    if (word.empty()) throw Error("{}: ends within facet {}; it is truncated", name_, facet);
    return word;
  }
  void need(std::string_view wanted) {
    const std::string_view word = need();
    if (!same_word(word, wanted)) throw Error("{}: '{}' of facet {} is where '{}' is required", where(), word, facet, wanted);
  }
  float real() { return static_cast<float>(lines_.number(need())); }
  std::string_view rest_of_line() { return lines_.rest(); }
  std::string where() const { return lines_.where(); }

  std::size_t facet = 0;

 private:
  const std::string& name_;
  TextLines lines_;
};

/// Reads what follows the word `facet`. Normals are not used: they may be anything.
void read_facet(Words& words, ImportedMesh& mesh) {
  words.need("normal");
  for (int k = 0; k < 3; ++k)
    if (same_word(words.need(), "outer"))
      throw Error("{}: the normal of facet {} has {} numbers, not 3", words.where(), words.facet, k);
  words.need("outer");
  words.need("loop");
  std::vector<std::uint32_t> face;
  for (std::string_view word = words.need(); !same_word(word, "endloop"); word = words.need()) {
    if (!same_word(word, "vertex"))
      throw Error("{}: '{}' of facet {} is neither 'vertex' nor 'endloop'", words.where(), word, words.facet);
    face.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(glm::dvec3{words.real(), words.real(), words.real()});
    if (face.size() > 3) throw Error("{}: facet {} has more than 3 vertices", words.where(), words.facet);
  }
  if (face.size() < 3) throw Error("{}: facet {} has {} vertices, not 3", words.where(), words.facet, face.size());
  words.need("endfacet");
  mesh.add_face(face);
}

MeshFile read_text(const std::string& name, std::string_view text) {
  MeshFile answer;
  Words words(name, text);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (!same_word(word, "solid")) throw Error("{}: '{}' is where a solid begins", words.where(), word);
    ImportedMesh& mesh = answer.meshes.emplace_back();
    mesh.name = words.rest_of_line();
    for (word = words.next(); !same_word(word, "endsolid"); word = words.next()) {
      if (word.empty()) throw Error("{}: has no endsolid after {} facets; it is truncated", name, words.facet);
      if (!same_word(word, "facet"))
        throw Error("{}: '{}' after {} facets is neither 'facet' nor 'endsolid'", words.where(), word, words.facet);
      read_facet(words, mesh);
      ++words.facet;
    }
    words.rest_of_line();
  }
  return answer;
}

}  // namespace

MeshFile read_stl(const std::filesystem::path& file, const ReadFile& read) {
  const std::string name = file.string(), bytes = read(file);
  if (bytes.size() >= head_size && bytes.size() == declared_size(bytes)) return read_binary(name, bytes);
  std::string_view text = without_byte_order_mark(name, bytes);
  while (text.ends_with('\0') || text.ends_with('\x1a')) text.remove_suffix(1);  // old systems end a text so
  return is_text(name, text) ? read_text(name, text) : read_binary(name, bytes);
}

}  // namespace gnomon::importing
