// gnomon pack: a run as one file from which others run it again. docs/pack.md describes what is in it.
#include <fcntl.h>

#include <cerrno>
#include <cstdio>

#include "app/app.h"
#include "app/pack/pack.h"
#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/record/scene_place.h"
#include "measure/run/run_file.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct PackOptions {
  fs::path run, out, repository;
  bool overwrite = false;
};

constexpr std::string_view ending = ".tar.gz";
constexpr const char* schema = "gnomon-pack-1";
constexpr const char* script = "reproduce";

/// The script that runs the rows again: in the source tree, or installed.
fs::path script_file() {
  const fs::path root = data_root();
  const fs::path in_tree = root / "harness/app/pack/reproduce";
  return fs::exists(in_tree) ? in_tree : root / script;
}

PackedRows rows_of(const fs::path& run) {
  PackedRows rows;
  const RecordLines lines(run, [&](const Record& record) {
    ++rows.count;
    if (is_foreign(record)) {
      ++rows.foreign_count;
      return;
    }
    rows.commits.insert(context_text(record, "commit"));
    PackedRows::SceneRow& scene = rows.scenes[record.scene];
    if (scene.hash.empty()) {
      scene = {scene_reference(record, run), context_text(record, "scene_hash"), {}, record.start.has_value()};
      for (const Record::LightFacts& light : record.lights) scene.lights.push_back(light.name);
    }
    const auto plugin = record.context.find("plugin");
    if (plugin != record.context.end() && plugin->is_object() && plugin->contains("path"))
      rows.hashes[plain_text((*plugin)["path"])] = plugin_hash(record);
  });
  rows.count = lines.order().size();
  return rows;
}

/// The files of the run itself.
void pack_run(Pack& pack, const fs::path& run) {
  for (const char* const name : {"records.jsonl", "run.json", "table.md", "table.csv", "table.tex", "table.json"}) {
    if (!fs::exists(fs::symlink_status(run / name))) continue;
    if (!is_plain_file(run / name)) throw Error("{} cannot be packed: it is no file", (run / name).string());
    pack.add(run / name, fs::path("run") / name);
  }
}

std::string readme(const std::string& name, const PackedRows& rows, const Pack& pack) {
  std::string text = fmt::format(
      "# {}\n\nA run of Gnomon, a testbed for shadow techniques: {}, with all that makes them again.\n\n"
      "```sh\n./reproduce          # builds the program, runs the rows again, compares\n"
      "./reproduce --help   # a program that is there already, a part of the rows, another folder\n```\n\n"
      "| where | what |\n|---|---|\n"
      "| `run/` | the records, how they were made, and the tables |\n"
      "| `suites/` | the suites that were run |\n"
      "| `scenes/`, `cache/scenes/` | the scenes: described ones and files, and models that were fetched |\n"
      "| `LICENSES.md` | under what license each model is |\n"
      "| `plugins/`, `programs/` | techniques from outside, with their sources |\n"
      "| `source/` | the tree of the program's commit, and by what the build differed from it |\n"
      "| `pack.json` | the calls that are repeated, in the names of this archive |\n",
      name, counted(rows.count, "row{s}"));
  if (pack.missing().empty()) return text;
  text += "\n## What is missing\n\n";
  for (const std::string& what : pack.missing()) text += "- " + what + "\n";
  return text;
}

/// Fills the folder. Returns how many scenes, plugins and programs are in it.
std::string fill(Pack& pack, const PackOptions& options, const std::string& name) {
  const PackedRows rows = rows_of(options.run);
  const Json runs = run_entries(options.run);
  pack_run(pack, options.run);
  if (runs.empty()) pack.miss("how the rows were made: the folder has no run.json");
  if (rows.foreign_count > 0)
    pack.miss(fmt::format("what made {} of the rows: their masks are of other programs", rows.foreign_count));
  PackedNames names;
  pack_scenes(pack, rows, names);
  const PackedNames scenes = names;
  const Json plugins = pack_outside(pack, rows, commands_of(runs), names);
  const Json sources = pack_sources(pack, rows, runs, options.repository.empty() ? data_root() : options.repository);
  const Json commands = pack_commands(pack, runs, names);
  pack.add(script_file(), script);
  pack.write("pack.json", json_text(json_object({{"schema", schema},
                                                 {"rows", rows.count},
                                                 {"commands", commands},
                                                 {"sources", sources},
                                                 {"scenes", Json(scenes)},
                                                 {"plugins", plugins},
                                                 {"missing", pack.missing()}}),
                                    1) +
                              "\n");
  pack.write("README.md", readme(name, rows, pack));
  return fmt::format("{}, {}, {}, {}, {}", counted(rows.count, "row{s}"), counted(rows.scenes.size(), "scene{s}"),
                     counted(commands.size(), "call{s}"), counted(plugins.size(), "plugin{s}"),
                     counted(pack.file_count(), "file{s}"));
}

/// What the archive and the folder in it are called.
std::string name_of(const fs::path& out) {
  const std::string file = out.filename().string();
  if (!file.ends_with(ending) || file.size() == ending.size())
    throw Error("--out {} does not end in NAME{}", out.string(), ending);
  return file.substr(0, file.size() - ending.size());
}

/// Gives the archive its name. Where nobody asked for it, a file that came meanwhile is not replaced.
void put_in_place(const fs::path& archive, const fs::path& out, const PackOptions& options) {
  const unsigned how = options.overwrite ? 0 : RENAME_NOREPLACE;
  int result = renameat2(AT_FDCWD, archive.c_str(), AT_FDCWD, out.c_str(), how);
  if (result != 0 && errno == EINVAL) result = std::rename(archive.c_str(), out.c_str());  // a file system without the flag
  if (result != 0)
    throw Error("{} cannot be written: {}", options.out.string(), std::error_code(errno, std::generic_category()).message());
}

int pack(PackOptions& options) {
  if (!fs::exists(records_file(options.run)))
    throw Error("{} is not the folder of a run: it has no {}", options.run.string(), records_file("").string());
  if (options.out.empty()) {
    const fs::path run = fs::absolute(options.run).lexically_normal();
    const fs::path folder = run.has_filename() ? run : run.parent_path();
    options.out = (fs::path(options.run) / "." / "..").lexically_normal() / (folder.filename().string() + std::string(ending));
  }
  const std::string name = name_of(options.out);
  const fs::path out = replaced_file(options.out);
  if (fs::exists(out) && !options.overwrite)
    throw Error("{} is there already: name another file with --out, or replace it with --overwrite", options.out.string());
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  const ScratchFolder scratch = ScratchFolder::in(folder, ".gnomon-pack");
  Pack packed(scratch.path() / name);
  const std::string what = [&] {
    try {
      return fill(packed, options, name);
    } catch (const Json::exception& problem) {
      throw Error("{} does not say how the folder was run: {}", (options.run / "run.json").string(), complaint(problem));
    }
  }();
  const fs::path archive = scratch.path() / ".archive";
  make_archive(scratch.path(), name, archive);
  const std::uintmax_t bytes = fs::file_size(archive);
  put_in_place(archive, out, options);
  fmt::print("{}  {:.1f} MB: {}\n", options.out.string(), static_cast<double>(bytes) / 1e6, what);
  for (const std::string& missing : packed.missing()) print_notice("missing: {}\n", printable(missing, true));
  return packed.missing().empty() ? 0 : 1;
}

}  // namespace

void add_pack(Program& program) {
  auto [command, options] = program.line.command<PackOptions>(
      "pack", "A run as one archive: records, scenes, plugins, source, and a script that runs it again and compares",
      [](PackOptions& read) { return pack(read); });
  command.option("run", &options.run, "Folder of the run", {.is_required = true, .check = not_empty()});
  command.option("--out", &options.out, "The archive, NAME.tar.gz; RUN.tar.gz beside the folder by default",
                 {.check = not_empty()});
  command.option("--repository", &options.repository,
                 "Folder of the repository that has the program's commit; the one that the program is in by default",
                 {.check = not_empty()});
  command.flag("--overwrite", &options.overwrite, "Replace an archive that is there");
}

}  // namespace gnomon::app
