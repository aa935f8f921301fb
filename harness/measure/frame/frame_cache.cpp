#include "measure/frame/frame_cache.h"

#include <gnomon/error.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <mutex>

#include "measure/notice.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

constexpr const char* links_prefix = "in_use";

/// Of the folders where frames lie when the cache cannot be written.
constexpr const char* scratch_prefix = "gnomon-frames";

}  // namespace

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
  constexpr std::uintmax_t most_bytes = std::uintmax_t{16384} * 16384 * 40;  // of any frame; what is larger is not read
  if (file.kind != "scene" && file.bytes > most_bytes) return false;
  const auto mapped = MappedFile::copy(file.path);
  return file.kind == "scene" ? content_hash(mapped->bytes()) == file.path.stem() : ends_with_own_hash(mapped->bytes());
}

std::uintmax_t keep_below(const fs::path& folder, std::uintmax_t limit) {
  const std::vector<CachedFile> files = cached_files(folder);
  std::uintmax_t total = 0, removed = 0;
  for (const CachedFile& file : files) total += file.bytes;
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

void remove_left_overs(const fs::path& folder) {
  remove_left_over_folders(folder, links_prefix);
  remove_left_over_parts(folder);
}

FrameFiles::FrameFiles(fs::path folder) : folder_(std::move(folder)), limit_(frame_cache_limit()) {
  std::error_code code;
  if (is_of_another_user(folder_) || is_of_another_user(folder_.parent_path())) {
    static std::once_flag is_said;
    std::call_once(is_said, [&] {
      print_notice("the cache {} is another user's: it is read, and frames are made for this run alone\n", folder_.string());
    });
    source_ = std::exchange(folder_, scratch_.emplace(ScratchFolder::temporary(scratch_prefix)).path());
  } else {
    remove_left_overs(folder_);
  }
  if (const fs::path temporary = fs::temp_directory_path(code); !code) remove_left_over_folders(temporary, scratch_prefix);
}

fs::path FrameFiles::find(const std::string& name, std::size_t size, const IsSound& is_sound) {
  const fs::path file = held(name);
  if (!source_.empty() && !fs::exists(file)) return take(name, size, is_sound);
  if (!is_plain_file(file) || fs::file_size(file) != size) return {};  // a link may lead anywhere
  if (sound_.contains(file)) return file;
  if (!is_sound(MappedFile::copy(file)->bytes())) return {};
  std::error_code ignored;
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);  // it is used now
  sound_.insert(file);
  return file;
}

fs::path FrameFiles::take(const std::string& name, std::size_t size, const IsSound& is_sound) {
  if (!is_plain_file(source_ / name) || fs::file_size(source_ / name) != size) return {};
  const auto copied = MappedFile::copy(source_ / name);
  if (!is_sound(copied->bytes())) return {};
  sound_.insert(folder_ / name);
  return put(name, copied->bytes());
}

fs::path FrameFiles::held(const std::string& name) {
  if (scratch_) return folder_ / name;
  try {
    if (!links_) links_.emplace(ScratchFolder::in(folder_, links_prefix));
  } catch (const Error&) {  // who writes will see it, and who reads may still read
    return folder_ / name;
  }
  const fs::path link = links_->path() / name;
  std::error_code code;
  if (fs::is_symlink(folder_ / name, code)) return folder_ / name;
  if (!fs::exists(link, code)) fs::create_hard_link(folder_ / name, link, code);
  return fs::exists(link, code) ? link : folder_ / name;
}

fs::path FrameFiles::put(const std::string& name, std::span<const std::byte> bytes) {
  if (!scratch_) try {
      const fs::path file = put_in_cache(name, bytes);
      keep_below(folder_, limit_);
      return file;
    } catch (const Error& error) {
      print_notice("{}; frames are made for this run alone\n", error.what());
      folder_ = scratch_.emplace(ScratchFolder::temporary(scratch_prefix)).path();
    }
  write_file(folder_ / name, bytes);
  return folder_ / name;
}

fs::path FrameFiles::put_in_cache(const std::string& name, std::span<const std::byte> bytes) {
  if (links_) {
    // Ours first: a name in the cache may be gone at once.
    const fs::path file = links_->path() / name, link = links_->path() / "link";
    write_file(file, bytes, Durable::yes);
    std::error_code code;
    fs::create_hard_link(file, link, code);
    if (!code) fs::rename(link, folder_ / name, code);
    if (!code) return file;
    fs::remove(file, code);
  }
  write_file(folder_ / name, bytes, Durable::yes);
  return folder_ / name;
}

}  // namespace gnomon
