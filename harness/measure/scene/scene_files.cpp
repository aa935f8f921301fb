// Which files a scene is made of: the walk through its descriptions, without loading what they say.
#include "measure/scene/scene_files.h"

#include <gnomon/registry.h>

#include <fstream>
#include <set>

#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/import.h"
#include "measure/scene/time_reference.h"
#include "measure/scene/toml_table.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

fs::path whole_path(const fs::path& file) { return fs::absolute(file).lexically_normal(); }

/// From "Source:" or "License:" to the end of the comment that opens the file.
std::string source_in(const fs::path& description) {
  std::ifstream stream(description);
  std::string line, source;
  while (std::getline(stream, line) && line.starts_with('#')) {
    const std::size_t begin = std::min(line.find_first_not_of("# \t"), line.size());
    std::string text = line.substr(begin);
    while (!text.empty() && (text.back() == '\r' || text.back() == ' ')) text.pop_back();
    if (source.empty() && !text.starts_with("Source:") && !text.starts_with("License:")) continue;
    source += (source.empty() ? "" : " ") + text;
  }
  return source;
}

class Walk {
 public:
  std::vector<SceneFile> files;

  void add_scene(const std::string& reference, std::size_t depth = 0) {
    const std::string scene = without_time(reference);
    if (!names_file(scene) && registry().find_scene(scene.substr(0, scene.find(':')))) return;  // generated
    const fs::path file = described_in(scene);
    if (file.extension() != ".toml") return add_model(file, "");
    if (!add({.file = whole_path(file), .in_cache = {}, .is_description = true, .source = source_in(file)})) return;
    if (depth >= most_descriptions) throw Error("{}: more than {} descriptions, each of which names the next", scene, depth);
    const toml::table document = read_toml(scene_in_words(reference), file);
    for (const std::string& name : files_named_in(document)) add_model(described_file(name, file), source_in(file));
    if (const auto base = document["scene"].value_exact<std::string>()) add_scene(seen_from_here(*base, file), depth + 1);
  }

 private:
  bool add(SceneFile file) {
    if (!known_.insert(file.file).second) return false;
    files.push_back(std::move(file));
    return true;
  }
  void add_model(const fs::path& model, const std::string& source) {
    importing::check_readable(model, "a file of the scene");
    for (const fs::path& file : importing::files_behind(model)) {
      const fs::path whole = whole_path(file), inside = whole.lexically_relative(fetched_);
      const bool is_fetched = !inside.empty() && *inside.begin() != "..";
      add({.file = whole, .in_cache = is_fetched ? inside : fs::path(), .is_description = false, .source = source});
    }
  }

  const fs::path fetched_ = whole_path(cache_root() / "scenes");
  std::set<fs::path> known_;
};

}  // namespace

std::vector<SceneFile> scene_files(const std::string& reference) {
  Walk walk;
  walk.add_scene(reference);
  return std::move(walk.files);
}

}  // namespace gnomon
