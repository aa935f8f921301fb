#include "measure/paths.h"

#include <gnomon/error.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>

namespace gnomon {

namespace fs = std::filesystem;

/// Whether that is the data of an installed program, which other users share: nothing is written there.
static bool is_installed(const fs::path& root) {
  return root.filename() == "gnomon" && root.parent_path().filename() == "share";
}

void make_folder(const fs::path& folder, const std::string& what) {
  std::error_code code;
  fs::create_directories(folder, code);
  if (code) throw Error("{} {} cannot be made: {}", what, folder.string(), code.message());
}

fs::path program_path() { return fs::read_symlink("/proc/self/exe"); }

fs::path data_root() {
  const auto complete = [](const fs::path& p) {
    return fs::is_directory(p / "scenes") && fs::is_directory(p / "bench/suites");
  };
  if (const char* root = std::getenv("GNOMON_ROOT")) {
    if (complete(root)) return root;
    throw Error("GNOMON_ROOT = {} has no scenes/ and bench/suites/", root);
  }
  for (fs::path p = program_path().parent_path();; p = p.parent_path()) {
    if (complete(p)) return p;
    if (complete(p / "share/gnomon")) return p / "share/gnomon";
    if (p == p.root_path()) break;
  }
  throw Error("no folder above {} holds scenes/ and bench/suites/; set GNOMON_ROOT", program_path().string());
}

fs::path find_data_root() {
  try {
    return data_root();
  } catch (const Error&) {
    return {};
  }
}

bool is_of_another_user(const fs::path& folder) {
  struct stat facts {};
  return stat(folder.c_str(), &facts) == 0 && facts.st_uid != geteuid();
}

std::string fetch_command() { return is_installed(find_data_root()) ? "gnomon-fetch-scenes" : "scripts/fetch_scenes"; }

fs::path cache_root() {
  if (const char* cache = std::getenv("GNOMON_CACHE")) return cache;
  const fs::path root = data_root();
  if (!is_installed(root) && access(root.c_str(), W_OK) == 0) return root / "cache";
  if (const char* xdg = std::getenv("XDG_CACHE_HOME")) return fs::path(xdg) / "gnomon";
  if (const char* home = std::getenv("HOME")) return fs::path(home) / ".cache/gnomon";
  throw Error("nowhere to keep the cache: {} {} and HOME is not set; set GNOMON_CACHE", root.string(),
              is_installed(root) ? "is an installed program's" : "cannot be written");
}

}  // namespace gnomon
