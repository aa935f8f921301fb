#include "measure/foreign_text.h"

#include <gnomon/error.h>

#include <fstream>

namespace gnomon {

std::string read_foreign_text(const std::string& what, const std::filesystem::path& file, std::size_t most) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) throw Error("{} does not exist", what);
  if (!std::filesystem::is_regular_file(file, code)) throw Error("{} is not a file", what);
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  if (size > most) throw Error("{} is {} bytes long; at most {} are read", what, size, most);
  std::ifstream in(file, std::ios::binary);
  std::string text(size, '\0');
  if (!in.read(text.data(), static_cast<std::streamsize>(size))) throw Error("{} cannot be read", what);
  return text;
}

bool next_foreign_line(std::istream& stream, std::string& line, std::size_t most) {
  line.clear();
  for (char piece[1 << 16];;) {
    stream.getline(piece, sizeof piece);
    const auto count = static_cast<std::size_t>(stream.gcount());
    const bool has_end = stream.good(), is_full = !has_end && !stream.eof() && !stream.bad() && count > 0;
    line.append(piece, has_end ? count - 1 : count);
    if (line.size() > most) throw Error("a line is longer than {} bytes", most);
    if (!is_full) return has_end || !line.empty();
    stream.clear();
  }
}

}  // namespace gnomon
