#include "measure/scratch_folder.h"

#include <gnomon/error.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "measure/paths.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Whether the folder is of a process that is gone: its name is the prefix and the number of the process.
bool is_left_over(const fs::path& folder, const std::string& prefix) {
  const std::string name = folder.filename().string();
  if (!name.starts_with(prefix + "-")) return false;
  int process = 0;
  const char* const end = name.data() + name.size();
  const auto [stop, code] = std::from_chars(name.data() + prefix.size() + 1, end, process);
  return code == std::errc{} && stop == end && process > 0 && kill(process, 0) != 0 && errno == ESRCH;
}

}  // namespace

ScratchFolder ScratchFolder::at(const fs::path& path) {
  make_folder(path);
  return ScratchFolder(path);
}

ScratchFolder ScratchFolder::in(const fs::path& parent, const std::string& prefix) {
  make_folder(parent);
  std::string name = (parent / (prefix + ".XXXXXX")).string();
  if (!mkdtemp(name.data())) throw Error("{} cannot be written: {}", parent.string(), std::strerror(errno));
  return ScratchFolder(name);
}

ScratchFolder ScratchFolder::temporary(const std::string& prefix) { return in(fs::temp_directory_path(), prefix); }

ScratchFolder ScratchFolder::in_memory(const std::string& prefix) {
  std::error_code code;
  for (const fs::path& root : {fs::path("/dev/shm"), fs::temp_directory_path(code)}) {
    if (access(root.c_str(), W_OK) != 0) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(root, code))
      if (is_left_over(entry.path(), prefix)) fs::remove_all(entry.path(), code);
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
