// gnomon site: runs, kept results and submissions as a folder of static pages, with the documentation.
#include <fcntl.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "app/app.h"
#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"
#include "report/site/site.h"
#include "report/site/source.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct SiteCommand {
  std::vector<fs::path> dirs;
  fs::path out, docs;
  bool without_docs = false, overwrite = false;
};

constexpr std::uintmax_t most_marker_bytes = 1 << 20, most_feed_bytes = 16 << 20;

/// What a site's folder says is in it; nothing where the folder is no site.
std::optional<std::vector<std::string>> site_entries(const fs::path& folder) {
  if (!is_plain_file(folder / site_file)) return std::nullopt;
  const Json json = parse_if_json(site::small_file(folder / site_file, most_marker_bytes));
  if (!json.is_object() || json.value("schema", Json()) != site_schema) return std::nullopt;
  std::vector<std::string> names;
  for (const Json& name : json.value("entries", Json::array()))
    if (name.is_string()) names.push_back(name);
  return names;
}

/// Throws Error where the folder holds what is not of a site, unless it may be overwritten.
void require_own(const fs::path& out, bool overwrite) {
  if (!fs::exists(fs::symlink_status(out))) return;
  if (!fs::is_directory(out)) throw Error("--out {} is a file; the name of a folder is required", out.string());
  if (overwrite) return;
  const std::optional<std::vector<std::string>> names = site_entries(out);
  for (const auto& entry : fs::directory_iterator(out)) {
    const std::string name = entry.path().filename().string();
    if (!names)
      throw Error("--out {} is a folder of something else ({} is in it); --overwrite puts the site there all the same",
                  out.string(), name);
    if (std::ranges::find(*names, name) == names->end())
      throw Error("--out {} is a site, but {} is not of it; --overwrite leaves that as it is", out.string(), name);
  }
}

/// Moves an entry of the new site into the folder; one of the same name goes.
void replace(const fs::path& from, const fs::path& to, const fs::path& old) {
  if (fs::exists(fs::symlink_status(to))) fs::rename(to, old / to.filename());
  fs::rename(from, to);
}

/// Gives the finished folder its place: as a whole where nothing else is there, else entry by entry, the first page last.
void put_in_place(const fs::path& made, const fs::path& out, const fs::path& old) {
  std::error_code code;
  if (!fs::exists(out) || fs::is_empty(out, code)) {
    fs::remove(out, code);
    fs::rename(made, out);
    return;
  }
  const std::optional<std::vector<std::string>> earlier = site_entries(out);
  bool is_all = earlier.has_value();
  for (const auto& entry : fs::directory_iterator(out))
    is_all = is_all && std::ranges::find(*earlier, entry.path().filename().string()) != earlier->end();
  if (is_all && renameat2(AT_FDCWD, made.c_str(), AT_FDCWD, out.c_str(), RENAME_EXCHANGE) == 0) return;
  fs::create_directories(old);
  std::vector<fs::path> names;
  for (const auto& entry : fs::directory_iterator(made)) names.push_back(entry.path().filename());
  std::ranges::sort(names, {}, [](const fs::path& name) { return std::pair(name == "index.html", name); });
  for (const fs::path& name : names) replace(made / name, out / name, old);
  for (const std::string& name : earlier.value_or(std::vector<std::string>()))
    if (fs::path(name).filename() == name && std::ranges::find(names, fs::path(name)) == names.end() && fs::exists(out / name))
      fs::rename(out / name, old / name);
}

/// The tree whose documentation is shown; empty where there is none.
fs::path tree_of(const SiteCommand& options) {
  if (options.without_docs) return {};
  if (!options.docs.empty()) return options.docs;
  const fs::path root = find_data_root();
  if (!root.empty() && fs::exists(root / "docs/README.md")) return root;
  print_notice("no documentation in the site: this program is not in a source tree; --docs names one\n");
  return {};
}

/// SOURCE_DATE_EPOCH where it is set, so that the same input gives the same site.
std::time_t now() {
  const char* const epoch = std::getenv("SOURCE_DATE_EPOCH");
  if (!epoch) return std::time(nullptr);
  char* end = nullptr;
  errno = 0;
  const long long seconds = std::strtoll(epoch, &end, 10);
  if (*epoch == 0 || *end != 0 || errno != 0 || seconds < 0)
    throw Error("SOURCE_DATE_EPOCH is '{}'; whole seconds are required", epoch);
  return static_cast<std::time_t>(seconds);
}

void make(const SiteCommand& options) {
  require_own(options.out, options.overwrite);
  SiteOptions site{.dirs = options.dirs, .tree = tree_of(options), .earlier_feed = "", .now = now()};
  if (is_plain_file(options.out / "feed.xml")) site.earlier_feed = site::small_file(options.out / "feed.xml", most_feed_bytes);
  fs::path out = fs::absolute(options.out).lexically_normal();
  if (!out.has_filename()) out = out.parent_path();
  if (fs::is_directory(out)) out = fs::canonical(out);  // a link to a folder stays
  const ScratchFolder scratch = ScratchFolder::in(out.parent_path(), ".gnomon-site");
  const fs::path made = scratch.path() / "new";
  make_folder(made);
  const SiteSummary summary = make_site(site, made);
  try {
    put_in_place(made, out, scratch.path() / "old");
  } catch (const fs::filesystem_error& error) {
    throw Error("output folder {} cannot be written: {}", options.out.string(), error.code().message());
  }
  for (const std::string& note : summary.notes) print_notice("{}\n", printable(note, true));
  fmt::print("{}  {}, {} on {}, {:.1f} MB\n", (options.out / "index.html").string(), counted(summary.pages, "page{s}"),
             counted(summary.rows, "row{s}"), counted(summary.machines, "machine{s}"),
             static_cast<double>(summary.bytes) / 1e6);
}

}  // namespace

void add_site(Program& program) {
  auto [command, options] = program.line.command<SiteCommand>(
      "site", "Static pages of runs and submissions on several machines, with search and the documentation", make);
  command.option("dir", &options.dirs, "Folders of runs, kept results or submissions", {.is_required = true});
  command.option("--out", &options.out, "Folder of the site",
                 {.is_required = true, .check = not_empty(), .type_name = "FOLDER"});
  command.option("--docs", &options.docs,
                 "Source tree whose README.md and docs are part of the site; that of the program unless given",
                 {.check = not_empty(), .type_name = "FOLDER"});
  command.flag("--no-docs", &options.without_docs, "Leave out the documentation and the feed of changes");
  command.flag("--overwrite", &options.overwrite, "Write into a folder that holds other things, too; they stay");
}

}  // namespace gnomon::app
