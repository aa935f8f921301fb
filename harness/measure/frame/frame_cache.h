#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "measure/scratch_folder.h"

namespace gnomon {

// The folder where scenes, G-buffers and references lie from one run to the next, each a file that is named by the hash of all
// that it was made from. Two programs may use it at once: files appear whole, and one that is removed stays with who uses it
// (FrameFiles).

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

/// Removes what programs that were killed have left of FrameFiles.
void remove_left_overs(const std::filesystem::path& folder);

/// Removes files that were used longest ago until the others take no more than `limit`, but none that was used within the last
/// hour: a running program may be about to open it. Answers the bytes that went.
std::uintmax_t keep_below(const std::filesystem::path& folder, std::uintmax_t limit);

/// The hash that a G-buffer's or reference's file ends with, of what comes before.
void append_hash(std::vector<std::byte>& bytes);
inline constexpr std::size_t hash_size = 32;
/// Whether bytes end with the hash of what comes before.
bool ends_with_own_hash(std::span<const std::byte> bytes);

/// The files of the cache that one program uses. It holds each by a link of its own in a folder beside them, so that one which
/// another program removes, or makes anew, stays as it was for this one and its workers. A folder that cannot be written costs
/// time, and no row: files go to a scratch folder. So do copies of what another user's cache holds, who could change it
/// meanwhile.
class FrameFiles {
 public:
  /// Throws Error where $GNOMON_CACHE_LIMIT is no limit.
  explicit FrameFiles(std::filesystem::path folder);

  using IsSound = std::function<bool(std::span<const std::byte>)>;
  /// Where the file of that name is, if it has this size and its content is sound; nothing else. It is looked at once.
  std::filesystem::path find(const std::string& name, std::size_t size, const IsSound& is_sound);
  /// Writes a file of that name; returns where it is.
  std::filesystem::path put(const std::string& name, std::span<const std::byte> bytes);

 private:
  /// The program's own name for a file of the cache, or that of the cache where there can be no links.
  std::filesystem::path held(const std::string& name);
  /// Copies a sound file of another user's cache, if it has one of that name.
  std::filesystem::path take(const std::string& name, std::size_t size, const IsSound& is_sound);
  std::filesystem::path put_in_cache(const std::string& name, std::span<const std::byte> bytes);

  std::filesystem::path folder_;
  std::filesystem::path source_;  ///< another user's cache; empty where there is none
  std::uintmax_t limit_;
  std::optional<ScratchFolder> links_, scratch_;  ///< scratch: where folder_ is once the cache could not be written
  std::set<std::filesystem::path> sound_;         ///< files whose content was looked at
};

}  // namespace gnomon
