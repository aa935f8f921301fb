#include "app/staged_folder.h"

#include <gnomon/error.h>
#include <unistd.h>

#include <algorithm>

namespace gnomon::app {

namespace fs = std::filesystem;

StagedFolder::StagedFolder(fs::path staged, fs::path out) : path(std::move(staged)), out_(std::move(out)) {}

StagedFolder StagedFolder::beside(const fs::path& out) {
  std::error_code code;
  const fs::path parent = fs::absolute(out).parent_path();
  fs::create_directories(parent, code);
  if (!code && fs::exists(out) && !fs::is_directory(out)) code = std::make_error_code(std::errc::not_a_directory);
  const fs::path staged = parent / fmt::format(".{}.{}.part", out.filename().string(), getpid());
  if (!code) fs::create_directories(staged, code);
  if (code) throw Error("output folder {} cannot be made: {}", out.string(), code.message());
  return StagedFolder(staged, out);
}

StagedFolder StagedFolder::for_file(const fs::path& file) {
  std::error_code code;
  const fs::path parent = fs::absolute(file).parent_path();
  fs::create_directories(parent, code);
  if (!code && fs::is_directory(file)) code = std::make_error_code(std::errc::is_a_directory);
  const fs::path staged = parent / fmt::format(".{}.{}.part", file.filename().string(), getpid());
  if (!code) fs::create_directories(staged, code);
  if (code) throw Error("{} cannot be written: {}", file.string(), code.message());
  return StagedFolder(staged, parent);
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

void StagedFolder::publish() const {
  std::error_code code;
  const auto is_file = [](const fs::directory_entry& entry) { return entry.is_regular_file(); };
  if (!fs::exists(out_, code) && std::ranges::all_of(fs::directory_iterator(path), is_file)) {
    fs::rename(path, out_, code);  // all of it at once
    if (!code) return;
  }
  fs::create_directories(out_, code);
  for (const auto& entry : fs::directory_iterator(path))
    if (!code && is_file(entry)) fs::rename(entry.path(), out_ / entry.path().filename(), code);
  if (code) throw Error("output folder {} cannot be written: {}", out_.string(), code.message());
}

}  // namespace gnomon::app
