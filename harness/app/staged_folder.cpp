#include "app/staged_folder.h"

#include <gnomon/error.h>

#include <algorithm>

#include "measure/part_file.h"

namespace gnomon::app {

namespace fs = std::filesystem;

StagedFolder::StagedFolder(const fs::path& target, Target kind)
    : path(part_of(fs::absolute(target))), out_(kind == Target::file ? path.parent_path() : target) {
  const bool is_file = kind == Target::file;
  std::error_code code;
  fs::create_directories(path.parent_path(), code);
  if (!code && fs::exists(target) && fs::is_directory(target) == is_file)
    code = std::make_error_code(is_file ? std::errc::is_a_directory : std::errc::not_a_directory);
  if (!code) fs::create_directories(path, code);
  if (code && is_file) throw Error("{} cannot be written: {}", target.string(), code.message());
  if (is_file) replaced_file(target);
  if (code) throw Error("output folder {} cannot be made: {}", target.string(), code.message());
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
  for (const auto& entry : fs::directory_iterator(path))
    if (is_file(entry)) replaced_file(out_ / entry.path().filename());
  fs::create_directories(out_, code);
  for (const auto& entry : fs::directory_iterator(path))
    if (!code && is_file(entry)) fs::rename(entry.path(), out_ / entry.path().filename(), code);
  if (code) throw Error("output folder {} cannot be written: {}", out_.string(), code.message());
}

}  // namespace gnomon::app
