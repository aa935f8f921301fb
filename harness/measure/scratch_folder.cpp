#include "measure/scratch_folder.h"

#include <gnomon/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "measure/part_file.h"
#include "measure/paths.h"

namespace gnomon {

namespace fs = std::filesystem;

ScratchFolder ScratchFolder::at(const fs::path& path) {
  make_folder(path);
  return ScratchFolder(path);
}

ScratchFolder ScratchFolder::in(const fs::path& parent, const std::string& prefix) {
  make_folder(parent);
  remove_left_over_folders(parent, prefix);
  std::string name = (parent / fmt::format("{}-{}.XXXXXX", prefix, getpid())).string();
  if (!mkdtemp(name.data())) throw Error("{} cannot be written: {}", parent.string(), std::strerror(errno));
  return ScratchFolder(name);
}

ScratchFolder ScratchFolder::temporary(const std::string& prefix) { return in(fs::temp_directory_path(), prefix); }

ScratchFolder ScratchFolder::in_memory(const std::string& prefix) {
  std::error_code code;
  for (const fs::path& root : {fs::path("/dev/shm"), fs::temp_directory_path(code)}) {
    if (access(root.c_str(), W_OK) != 0) continue;
    remove_left_over_folders(root, prefix);
    const fs::path folder = root / fmt::format("{}-{}", prefix, getpid());
    fs::create_directories(folder, code);
    if (!code) return ScratchFolder(folder);
  }
  throw Error("there is no folder for files between processes: neither memory nor the temporary folder is writable");
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

}  // namespace gnomon
