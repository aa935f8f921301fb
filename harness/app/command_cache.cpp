// gnomon cache: the frames that are kept from one run to the next.
#include <gnomon/error.h>

#include "app/app.h"
#include "measure/counted.h"
#include "measure/frame/frame_cache.h"
#include "measure/json.h"
#include "measure/paths.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct CacheOptions {
  std::string what = "list";
  bool json = false;
};

std::string megabytes(std::uintmax_t bytes) { return fmt::format("{:.1f}", static_cast<double>(bytes) / 1e6); }

struct Kind {
  std::string name;
  std::size_t count = 0;
  std::uintmax_t bytes = 0;
};

std::vector<Kind> kinds_of(const std::vector<CachedFile>& files) {
  std::vector<Kind> kinds = {{"scene"}, {"gbuffer"}, {"reference"}};
  for (const CachedFile& file : files)
    if (const auto kind = std::ranges::find(kinds, file.kind, &Kind::name); kind != kinds.end()) {
      ++kind->count;
      kind->bytes += file.bytes;
    }
  return kinds;
}

int list_files(const fs::path& folder, const std::vector<CachedFile>& files, bool as_json) {
  const std::vector<Kind> kinds = kinds_of(files);
  if (as_json) {
    Json json = json_object({{"folder", folder.string()}, {"limit_bytes", frame_cache_limit()}});
    for (const Kind& kind : kinds) json["files"][kind.name] = json_object({{"count", kind.count}, {"bytes", kind.bytes}});
    fmt::print("{}\n", json_text(json, 2));
    return 0;
  }
  TextTable table({{"kind", ""}, {"files", "", Align::right}, {"MB", "", Align::right}});
  std::uintmax_t bytes = 0;
  for (const Kind& kind : kinds) {
    table.add_row({kind.name, fmt::format("{}", kind.count), megabytes(kind.bytes)});
    bytes += kind.bytes;
  }
  table.add_row({"all", fmt::format("{}", files.size()), megabytes(bytes)});
  fmt::print("{}\n{}at most {} MB are kept ($GNOMON_CACHE_LIMIT), what was used last\n", folder.string(), table.text(),
             frame_cache_limit() / 1'000'000);
  return 0;
}

/// Whether it went; one that another program has removed meanwhile is gone, too. Throws Error where it may not be removed.
bool has_removed(const fs::path& file) {
  std::error_code code;
  const bool has_gone = fs::remove(file, code);
  if (code) throw Error("{} cannot be removed: {}", file.string(), code.message());
  return has_gone;
}

int check_files(const std::vector<CachedFile>& files) {
  std::size_t damaged = 0;
  for (const CachedFile& file : files) {
    std::error_code code;
    if (!fs::exists(file.path, code) || is_sound(file)) continue;
    ++damaged;
    has_removed(file.path);
    fmt::print("{} was damaged and is removed\n", file.path.string());
  }
  fmt::print("{}, {} damaged\n", counted(files.size(), "file{s}"), damaged);
  return damaged > 0 ? 1 : 0;
}

int clear(const fs::path& folder, const std::vector<CachedFile>& files) {
  std::uintmax_t bytes = 0;
  for (const CachedFile& file : files)
    if (has_removed(file.path)) bytes += file.bytes;
  remove_left_overs(folder);
  fmt::print("{}, {} MB removed\n", counted(files.size(), "file{s}"), megabytes(bytes));
  return 0;
}

int run_cache(const CacheOptions& options) {
  const fs::path folder = cache_root() / "frames";
  const std::vector<CachedFile> files = cached_files(folder);
  if (options.what == "list") return list_files(folder, files, options.json);
  if (options.json) throw Error("--json is for gnomon cache list");
  if (options.what == "check") return check_files(files);
  if (options.what == "clear") return clear(folder, files);
  throw Error("gnomon cache {} is none of list, check, clear", options.what);
}

}  // namespace

void add_cache(Program& program) {
  auto [command, options] = program.line.command<CacheOptions>(
      "cache", "The frames that are kept from one run to the next: list, check or clear them", run_cache);
  command.option("what", &options.what,
                 "list: how many and how large; check: whether they are as they were made; clear: all go");
  command.flag("--json", &options.json, "The list as JSON");
}

}  // namespace gnomon::app
