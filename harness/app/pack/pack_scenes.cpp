// The scenes of a run in its archive, and under what license their models are.
#include <gnomon/error.h>
#include <gnomon/param.h>

#include <algorithm>
#include <cctype>

#include "app/pack/pack.h"
#include "measure/paths.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scene/scene_files.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view license_stems[] = {"license", "licence", "copying", "copyright"};

bool names_a_license(const fs::path& file) {
  std::string stem = file.stem().string();
  std::ranges::transform(stem, stem.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::ranges::any_of(license_stems, [&](std::string_view word) { return stem.starts_with(word); });
}

/// FILE.license beside a model, and what is called LICENSE, COPYING or the like in its folder.
std::vector<fs::path> license_files(const fs::path& model) {
  std::vector<fs::path> found;
  std::error_code code;
  for (fs::directory_iterator entry(model.parent_path(), code); !code && entry != fs::directory_iterator();
       entry.increment(code)) {
    const fs::path& file = entry->path();
    const bool is_of_model = file.filename() == model.filename().string() + ".license";
    if ((is_of_model || names_a_license(file)) && entry->is_regular_file(code)) found.push_back(file);
  }
  std::ranges::sort(found);
  return found;
}

/// The page of licenses: what each scene is made of and what is said of it.
class Licenses {
 public:
  std::string text() const {
    return text_.empty() ? "# Licenses\n\nNo scene of this run reads a model: each is generated or described.\n"
                         : "# Licenses\n\nThe models of this archive belong to their authors. What is said of them:\n" + text_;
  }
  void begin(const std::string& scene) { text_ += fmt::format("\n## {}\n", scene); }
  void add(const std::string& line) { text_ += fmt::format("\n{}\n", line); }

 private:
  std::string text_;
};

/// Whether it is a description that comes with the program.
bool is_of_testbed(const SceneFile& file) {
  return file.is_description && file.file.parent_path() == (fs::absolute(data_root()) / "scenes").lexically_normal();
}

/// One scene and its files. They go below `folder`, but for fetched ones and descriptions that come with the program.
class PackedScene {
 public:
  PackedScene(Pack& pack, std::string written, fs::path folder, std::vector<SceneFile> files)
      : pack_(pack), written_(std::move(written)), folder_(std::move(folder)), files_(std::move(files)) {
    std::vector<fs::path> own;
    for (const SceneFile& file : files_)
      if (file.in_cache.empty() && !is_of_testbed(file)) own.push_back(file.file);
    if (!own.empty()) common_ = common_folder(own);
  }
  fs::path name(const SceneFile& file) const {
    if (!file.in_cache.empty()) return fs::path("cache/scenes") / file.in_cache;
    return is_of_testbed(file) ? "scenes/testbed" / file.file.filename() : folder_ / file.file.lexically_relative(common_);
  }
  void add(Licenses& licenses) {
    std::vector<std::string> without, said;
    for (const SceneFile& file : files_) {
      pack_.add(file.file, name(file));
      if (file.is_description) continue;
      std::vector<std::string> pages;
      for (const fs::path& page : license_files(file.file)) {
        const fs::path packed = name(file).parent_path() / page.filename();
        pack_.add(page, packed);
        pages.push_back(packed.string());
      }
      if (pages.empty() && file.source.empty()) without.push_back(file.file.string());
      lines_.push_back(fmt::format("- {}{}", name(file).string(), pages.empty() ? "" : ": " + joined(pages, ", ")));
      if (!file.source.empty() && std::ranges::find(said, file.source) == said.end()) said.push_back(file.source);
    }
    if (lines_.empty()) return;
    licenses.begin(written_);
    licenses.add(joined(lines_, "\n"));
    for (const std::string& sentence : said) licenses.add(sentence);
    if (without.empty()) return;
    licenses.add(fmt::format("Without a license: {}.", joined(without, ", ")));
    pack_.miss(
        fmt::format("a license of {}: scene {} reads it. Write FILE.license beside it, a LICENSE in its folder, or a "
                    "line '# Source: ...' at the top of the scene's description",
                    first_of(without), written_));
  }

 private:
  Pack& pack_;
  const std::string written_;
  const fs::path folder_;
  const std::vector<SceneFile> files_;
  fs::path common_;
  std::vector<std::string> lines_;
};

/// Says where the scene is another one than the rows were measured on.
void check_scene(Pack& pack, const std::string& written, const PackedRows::SceneRow& row) {
  if (row.hash.empty()) return;
  const Scene scene = load_scene(row.reference);
  if (scene_hash(scene, row.lights, row.is_moving ? WithMotion::yes : WithMotion::no) != row.hash)
    pack.miss(
        fmt::format("scene {} as it was: it has changed since its rows were measured, and is packed as it is now", written));
}

}  // namespace

void pack_scenes(Pack& pack, const PackedRows& rows, PackedNames& names) {
  Licenses licenses;
  std::set<std::string> seen;
  for (const auto& [written, row] : rows.scenes) {
    std::vector<SceneFile> files;
    const std::string word = without_time(written);
    try {
      check_scene(pack, written, row);
      if (seen.insert(word).second) files = scene_files(row.reference);
    } catch (const SceneNotFetched& lacking) {
      pack.miss(fmt::format("the files of scene {}: {}", word, lacking.what()));
    } catch (const Error& error) {
      pack.miss(fmt::format("scene {}: {}", word, error.what()));
    }
    if (files.empty()) continue;
    PackedScene packed(pack, word, fs::path("scenes") / fmt::format("{}", seen.size()), files);
    packed.add(licenses);
    if (names_file(word)) names[word] = packed.name(files.front()).string();
  }
  for (const auto& [written, row] : rows.scenes)  // stills: each time of a file is a scene of its own
    if (const auto packed = names.find(without_time(written)); packed != names.end() && packed->first != written)
      names[written] = packed->second + written.substr(packed->first.size());
  pack.write("LICENSES.md", licenses.text());
}

}  // namespace gnomon::app
