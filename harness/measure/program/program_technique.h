#pragma once
#include <gnomon/registry.h>

#include <filesystem>

namespace gnomon {

/// Version of the protocol with programs, docs/protocol.md.
inline constexpr int program_protocol = 1;

/// Registers the technique of a description under the file's stem; the same file again changes nothing. Throws Error on a file
/// that is no description, and on an id that another has.
void load_program(const std::filesystem::path& file);

/// Every FOLDER/*.toml, in the order of their names.
void load_programs_of(const std::filesystem::path& folder);

}  // namespace gnomon
