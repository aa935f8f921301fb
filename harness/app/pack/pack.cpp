#include "app/pack/pack.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "measure/child_process.h"
#include "measure/paths.h"
#include "measure/run/suite.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace gnomon::app {

namespace fs = std::filesystem;

namespace {

bool stays_within(const fs::path& name) {
  const fs::path normal = name.lexically_normal();
  return !name.empty() && name == normal && name.is_relative() && name.has_filename() && name != "." && *name.begin() != "..";
}

}  // namespace

Pack::Pack(fs::path folder) : folder_(std::move(folder)) { make_folder(folder_); }

fs::path Pack::place_of(const fs::path& name) {
  if (!stays_within(name)) throw Error("{} is no name in an archive", name.string());
  make_folder((folder_ / name).parent_path());
  return folder_ / name;
}

void Pack::add(const fs::path& file, const fs::path& name) {
  const fs::path whole = fs::absolute(file).lexically_normal();
  const auto [known, is_new] = files_.try_emplace(name, whole);
  if (!is_new && known->second != whole)
    throw Error("{} and {} would have one name in the archive, {}", known->second.string(), file.string(), name.string());
  if (!is_new) return;
  std::error_code code;
  if (!fs::is_regular_file(whole, code) || access(whole.c_str(), R_OK) != 0)
    throw Error("{} cannot be read: {}", file.string(), code ? code.message() : "it is no regular file, or not to be read");
  fs::create_symlink(whole, place_of(name), code);
  if (code) throw Error("{} cannot be written: {}", (folder_ / name).string(), code.message());
}

void Pack::write(const fs::path& name, std::string_view text) {
  if (!files_.try_emplace(name).second) throw Error("{} is in the archive twice", name.string());
  write_file(place_of(name), std::as_bytes(std::span(text)));
}

void Pack::miss(const std::string& what) {
  if (std::ranges::find(missing_, what) == missing_.end()) missing_.push_back(what);
}

ToolEnd run_tool(std::vector<std::string> words, const fs::path& folder) {
  const std::string name = words.front();
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon-tool");
  const fs::path output = scratch.path() / "output";
  // What a person's settings would change of what the tool does, and of the language of its errors.
  const Launch launch(std::move(words), {{"GIT_DIR", ""},
                                         {"GIT_WORK_TREE", ""},
                                         {"GIT_INDEX_FILE", ""},
                                         {"GIT_OPTIONAL_LOCKS", "0"},
                                         {"TAR_OPTIONS", ""},
                                         {"GZIP", ""},
                                         {"LC_ALL", "C"}});
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int code = posix_spawnp(&child, launch.argv[0], &actions, nullptr, launch.argv.data(), launch.envp.data());
  posix_spawn_file_actions_destroy(&actions);
  if (code != 0) throw Error("{} cannot be run, which packing needs: {}", name, std::strerror(code));
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  ToolEnd end{WIFEXITED(status) && WEXITSTATUS(status) == 0, fs::exists(output) ? file_text(output) : ""};
  while (!end.said.empty() && end.said.back() == '\n') end.said.pop_back();
  return end;
}

void make_archive(const fs::path& parent, const std::string& name, const fs::path& archive) {
  // Times and owners of this machine's files say nothing: without them one run packs to the same bytes each time.
  const ToolEnd end =
      run_tool({"tar", "--create", "--gzip", "--format=gnu", "--dereference", "--hard-dereference", "--sort=name",
                "--mtime=@1000000000", "--owner=0", "--group=0", "--numeric-owner", "--mode=u+rw,go=rX",
                "--file=" + fs::absolute(archive).string(), "--force-local", "--add-file=" + name},
               parent);
  if (!end.is_good) throw Error("the archive cannot be written: {}", end.said.empty() ? "tar was stopped" : end.said);
}

fs::path common_folder(const std::vector<fs::path>& files) {
  fs::path common = files.front().parent_path();
  for (const fs::path& file : files) {
    const fs::path folder = file.parent_path();
    fs::path shared;
    for (auto a = common.begin(), b = folder.begin(); a != common.end() && b != folder.end() && *a == *b; ++a, ++b)
      shared /= *a;
    common = shared;
  }
  return common;
}

std::string first_of(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  return names.size() == 1 ? names[0] : fmt::format("{} and {} more", names[0], names.size() - 1);
}

}  // namespace gnomon::app
