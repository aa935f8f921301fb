// The source of the program that made a run, in its archive: the tree of its commit, and what the tree differed by.
#include <gnomon/error.h>

#include "app/pack/pack.h"

namespace gnomon::app {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view dirty_end = "-dirty";

/// What git takes for the name of a commit, and for nothing else.
bool is_commit_name(const std::string& name) {
  return !name.empty() && name != "unknown" && name[0] != '-' &&
         name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-") == name.npos;
}

std::string text_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

/// Trees of commits, each packed once.
class Trees {
 public:
  Trees(Pack& pack, fs::path repository) : pack_(pack), repository_(std::move(repository)) {}

  /// The name of the tree's archive; null where it cannot be had, which is said.
  Json add(const std::string& commit) {
    const auto [known, is_new] = archives_.try_emplace(commit);
    if (!is_new) return known->second;
    if (!is_commit_name(commit)) {
      pack_.miss("the source of the program: its build did not know its commit");
      return nullptr;
    }
    std::error_code code;
    if (!fs::is_directory(repository_, code) ||
        !run_tool({"git", "rev-parse", "--verify", "--quiet", commit + "^{commit}"}, repository_).is_good) {
      pack_.miss(fmt::format("the source of the program: {} is no repository with commit {}; name one with --repository",
                             repository_.string(), commit));
      return nullptr;
    }
    const std::string name = fmt::format("source/{}.tar", commit);
    fs::create_directories(pack_.folder() / "source");
    const fs::path file = pack_.folder() / name;
    const ToolEnd end = run_tool(
        {"git", "archive", "--format=tar", "--prefix=gnomon/", "--output=" + fs::absolute(file).string(), commit}, repository_);
    if (!end.is_good) throw Error("the tree of commit {} cannot be written: {}", commit, end.said);
    return known->second = name;
  }

 private:
  Pack& pack_;
  const fs::path repository_;
  std::map<std::string, Json> archives_;  ///< by commit
};

}  // namespace

Json pack_sources(Pack& pack, const PackedRows& rows, const Json& runs, const fs::path& repository) {
  Trees trees(pack, repository);
  std::set<std::string> told;
  std::map<std::string, std::string> changes_files;
  Json list = Json::array();
  for (const Json& run : runs) {
    const Json context = run.value("context", json_object());
    const std::string written = text_in(context, "commit"), changes = text_in(run, "changes");
    const bool is_dirty = written.ends_with(dirty_end);
    const std::string commit = is_dirty ? written.substr(0, written.size() - dirty_end.size()) : written;
    told.insert(written);
    Json& source = list.emplace_back(json_object(
        {{"commit", written}, {"archive", trees.add(commit)}, {"changes", nullptr}, {"build", text_in(context, "build")}}));
    if (is_dirty && !changes.starts_with("diff "))
      pack.miss(fmt::format("what the tree of the program differed by from commit {}: run.json does not have it", commit));
    if (!changes.starts_with("diff ")) continue;
    const auto [known, is_new] =
        changes_files.try_emplace(changes, fmt::format("source/changes-{}.patch", changes_files.size() + 1));
    if (is_new) pack.write(known->second, changes);
    source["changes"] = known->second;
  }
  for (const std::string& commit : rows.commits)
    if (!told.contains(commit))
      pack.miss(fmt::format("the call that made the rows of commit {}: run.json does not have it", commit));
  return list;
}

}  // namespace gnomon::app
