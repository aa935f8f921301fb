#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace gnomon {

// The folder where scenes, G-buffers and references lie from one run to the next, each a file that is named by the hash of all
// that it was made from. Two programs may use it at once: files appear whole, and one that is removed stays with who has it
// open.

/// Room that the files may take: $GNOMON_CACHE_LIMIT in megabytes, 4096 without it. Throws Error on what is no whole number.
std::uintmax_t frame_cache_limit();

struct CachedFile {
  std::filesystem::path path;
  std::string kind;  ///< "scene", "gbuffer" or "reference"
  std::uintmax_t bytes = 0;
  std::filesystem::file_time_type last_used;
};

/// Its files, those that were used last first; nothing where there is no such folder. Other files are passed over.
std::vector<CachedFile> cached_files(const std::filesystem::path& folder);

/// Whether a file's content is that of its hash: of a scene its name, of others what it ends with.
bool is_sound(const CachedFile& file);

/// Notes that a file is used now.
void touch(const std::filesystem::path& file);

/// Removes files that were used longest ago until the others take no more than `limit`, but none that was used within the last
/// hour: a running program may be about to open it. Answers the bytes that went.
std::uintmax_t keep_below(const std::filesystem::path& folder, std::uintmax_t limit);

/// The hash that a G-buffer's or reference's file ends with, of what comes before.
void append_hash(std::vector<std::byte>& bytes);
inline constexpr std::size_t hash_size = 32;
/// Whether bytes end with the hash of what comes before.
bool ends_with_own_hash(std::span<const std::byte> bytes);

}  // namespace gnomon
