#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>

namespace gnomon {

/// The text of a file from outside. Throws Error that begins with `what` where it is no regular file (a pipe or a device may
/// never end), cannot be read, or is larger than `most` bytes.
std::string read_foreign_text(const std::string& what, const std::filesystem::path& file, std::size_t most);

/// The next line of a file from outside, as std::getline reads it. Throws Error on one longer than `most` bytes, before more of
/// it is kept.
bool next_foreign_line(std::istream& stream, std::string& line, std::size_t most);

}  // namespace gnomon
