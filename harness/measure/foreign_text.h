#pragma once
#include <filesystem>
#include <string>

namespace gnomon {

/// The text of a file that somebody else wrote. Throws Error that begins with `what` where it is no regular file (a pipe or a
/// device may never end), cannot be read, or is larger than `most` bytes.
std::string read_foreign_text(const std::string& what, const std::filesystem::path& file, std::size_t most);

}  // namespace gnomon
