#include "measure/frame/frame_cache.h"

#include <gnomon/error.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <numeric>

#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

std::uintmax_t frame_cache_limit() {
  constexpr std::uintmax_t megabyte = 1'000'000;
  const char* const text = std::getenv("GNOMON_CACHE_LIMIT");
  if (!text || !*text) return 4096 * megabyte;
  std::uintmax_t megabytes = 0;
  const std::string_view word(text);
  const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), megabytes);
  if (problem != std::errc() || end != word.data() + word.size() || megabytes > 1'000'000'000)
    throw Error("GNOMON_CACHE_LIMIT = {} is no whole number of megabytes, 0 .. 1000000000", word);
  return megabytes * megabyte;
}

std::vector<CachedFile> cached_files(const fs::path& folder) {
  std::vector<CachedFile> files;
  std::error_code code;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, code)) {
    const std::string ending = entry.path().extension().string();
    if (ending != ".scene" && ending != ".gbuffer" && ending != ".reference") continue;
    // Another program may remove it meanwhile.
    CachedFile file{entry.path(), ending.substr(1), entry.file_size(code), {}};
    if (code) continue;
    file.last_used = entry.last_write_time(code);
    if (!code && entry.is_regular_file(code)) files.push_back(std::move(file));
  }
  std::ranges::sort(files, [](const CachedFile& a, const CachedFile& b) {
    return a.last_used != b.last_used ? a.last_used > b.last_used : a.path < b.path;
  });
  return files;
}

bool is_sound(const CachedFile& file) {
  const auto mapped = MappedFile::open(file.path);
  return file.kind == "scene" ? content_hash(mapped->bytes()) == file.path.stem() : ends_with_own_hash(mapped->bytes());
}

void touch(const fs::path& file) {
  std::error_code ignored;
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
}

std::uintmax_t keep_below(const fs::path& folder, std::uintmax_t limit) {
  const std::vector<CachedFile> files = cached_files(folder);
  const auto add = [](std::uintmax_t sum, const CachedFile& file) { return sum + file.bytes; };
  std::uintmax_t total = std::accumulate(files.begin(), files.end(), std::uintmax_t{0}, add), removed = 0;
  const auto in_use = fs::file_time_type::clock::now() - std::chrono::hours(1);
  for (auto file = files.rbegin(); file != files.rend() && total > limit && file->last_used < in_use; ++file) {
    std::error_code code;
    if (!fs::remove(file->path, code)) continue;
    total -= file->bytes;
    removed += file->bytes;
  }
  return removed;
}

void append_hash(std::vector<std::byte>& bytes) {
  const std::string hash = content_hash(bytes);
  const auto view = std::as_bytes(std::span(hash));
  bytes.insert(bytes.end(), view.begin(), view.end());
}

bool ends_with_own_hash(std::span<const std::byte> bytes) {
  if (bytes.size() < hash_size) return false;
  const std::size_t size = bytes.size() - hash_size;
  const std::string hash = content_hash(bytes.first(size));
  return std::ranges::equal(std::as_bytes(std::span(hash)), bytes.subspan(size));
}

}  // namespace gnomon
