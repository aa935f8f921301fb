// Indices of OBJ and 3DS. Importers wrap those that no 32 bits hold, and put the last vertex in the place of one that is not
// there.
#include <charconv>
#include <fstream>

#include "measure/scene/import_foreign.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view blanks = " \t\r\v\f";

/// What follows `letter` and a blank, where the line opens so; else nothing.
std::string_view arguments_of(char letter, std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  if (line.size() < 2 || line[0] != letter || blanks.find(line[1]) == blanks.npos) return {};
  return line.substr(1);
}

/// Chunks of a 3DS file: an id of 16 bits, a length of 32 that counts these six bytes too, and what the chunk holds.
class Chunks {
 public:
  Chunks(const fs::path& file, std::string_view bytes) : file_(file), rest_(bytes) {}

  /// Whether there is one more; throws Error where it is longer than what holds it.
  bool next() {
    if (rest_.size() < header) return false;
    id_ = word_at(rest_, 0) & 0xffff;
    const std::size_t size = word_at(rest_, 2);
    if (size < header || size > rest_.size())
      throw Error("{}: chunk {:#x} of {} bytes lies in {} bytes; it is damaged", file_.string(), id_, size, rest_.size());
    body_ = rest_.substr(header, size - header);
    rest_.remove_prefix(size);
    return true;
  }
  std::uint32_t id() const { return id_; }
  std::string_view body() const { return body_; }
  Chunks inner() const { return {file_, body_}; }
  /// Of what is listed behind a count of 16 bits.
  std::size_t count(std::size_t item_size) const {
    const std::size_t items = word_at(body_, 0) & 0xffff;
    if (body_.size() < 2 || items * item_size > body_.size() - 2)
      throw Error("{}: chunk {:#x} declares {} items in {} bytes; it is truncated", file_.string(), id_, items, body_.size());
    return items;
  }

 private:
  static constexpr std::size_t header = 6;
  const fs::path& file_;
  std::string_view rest_, body_;
  std::uint32_t id_ = 0;
};

/// A list of faces may stand before that of the vertices.
void check_mesh(const std::string& where, Chunks chunks) {
  std::size_t vertex_count = 0;
  std::string_view faces;
  std::size_t face_count = 0;
  while (chunks.next()) {
    if (chunks.id() == 0x4110) vertex_count = chunks.count(12);
    if (chunks.id() == 0x4120) {
      face_count = chunks.count(8);
      faces = chunks.body().substr(2);
    }
  }
  for (std::size_t f = 0; f < face_count; ++f)
    for (std::size_t k = 0; k < 3; ++k) need_vertex(where, f, word_at(faces, 8 * f + 2 * k) & 0xffff, vertex_count);
}

}  // namespace

void check_obj(const fs::path& file) {
  std::ifstream in(file);
  long total = 0, so_far = 0, number = 0;
  std::string line;
  while (std::getline(in, line)) total += !arguments_of('v', line).empty();
  in.clear();
  in.seekg(0);
  while (std::getline(in, line)) {
    ++number;
    so_far += !arguments_of('v', line).empty();
    std::string_view words = arguments_of('f', line);
    while (!words.empty()) {
      words.remove_prefix(std::min(words.find_first_not_of(blanks), words.size()));
      const std::string_view word = words.substr(0, words.find_first_of(blanks));
      words.remove_prefix(word.size());
      long index = 0;  // "7", "7/1", "-2//3"
      const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), index);
      const bool is_outside = code == std::errc{} && (index == 0 || index > total || index < -so_far);
      if (code == std::errc::result_out_of_range || is_outside)
        throw Error("{}:{}: face names vertex {}, out of range: allowed are 1 .. {}, or -1 .. -{} counted back", file.string(),
                    number, word, total, so_far);
    }
  }
}

void check_3ds(const fs::path& file) {
  const std::string bytes = read_bytes(file, 0, fs::file_size(file));
  need_length(file, word_at(bytes, 2));  // the outermost chunk is the file
  Chunks top(file, bytes);
  if (!top.next() || top.id() != 0x4d4d) return;  // not one that the importer knows
  for (Chunks main = top.inner(); main.next();) {
    if (main.id() != 0x3d3d) continue;
    for (Chunks editor = main.inner(); editor.next();) {
      if (editor.id() != 0x4000) continue;
      const std::size_t name = std::min(editor.body().find('\0'), editor.body().size());
      const std::string where = fmt::format("{}: mesh '{}'", file.string(), editor.body().substr(0, name));
      for (Chunks object(file, editor.body().substr(std::min(name + 1, editor.body().size()))); object.next();)
        if (object.id() == 0x4100) check_mesh(where, object.inner());
    }
  }
}

}  // namespace gnomon::importing
