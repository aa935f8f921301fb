#include "measure/formats/foreign_checks.h"

#include "measure/formats/little_endian.h"
#include "measure/formats/text_lines.h"

namespace gnomon::importing {
namespace {

namespace fs = std::filesystem;

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

void check_3ds(const fs::path& file, std::string_view bytes) {
  if (bytes.size() < word_at(bytes, 2))  // the outermost chunk is the file
    throw Error("{}: is {} bytes long but declares {}; it is truncated", file.string(), bytes.size(), word_at(bytes, 2));
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

}  // namespace

void check_foreign(const fs::path& file, const ReadFile& read) {
  const std::string extension = lower(file.extension().string());
  if (extension == ".3ds") check_3ds(file, read(file));
  if (extension == ".ifc" && read(file).rfind("END-ISO-10303-21;") == std::string::npos)
    throw Error("{}: does not end in END-ISO-10303-21; it is truncated", file.string());
}

}  // namespace gnomon::importing
