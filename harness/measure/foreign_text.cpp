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

}  // namespace gnomon
