#include "measure/record/scene_place.h"

#include "measure/scene/load.h"
#include "measure/scene/time_reference.h"

namespace gnomon {

namespace fs = std::filesystem;

std::optional<std::string> path_to_scene(const fs::path& run_folder, const std::string& reference) {
  std::error_code code;
  const std::string scene = without_time(reference);
  if (!names_file(scene) || !fs::is_regular_file(scene, code)) return {};
  // A relative path of which nothing is there yet would stay relative.
  const auto canonical = [&](const fs::path& path) { return fs::weakly_canonical(fs::absolute(path), code); };
  const fs::path file = canonical(scene), folder = canonical(run_folder);
  if (code) return {};
  const auto first_name = [](const fs::path& path) { return *std::next(path.begin()); };  // behind the root
  if (folder == folder.root_path() || first_name(file) != first_name(folder)) return {};
  return file.lexically_relative(folder).string();
}

std::string scene_reference(const Record& record, const fs::path& run_folder) {
  const std::string path = context_text(record, "scene_file");
  std::error_code code;
  if (path.empty() || !names_file(record.scene)) return record.scene;
  const fs::path file = (run_folder / path).lexically_normal();
  if (!fs::is_regular_file(file, code)) return record.scene;
  return file.string() + record.scene.substr(without_time(record.scene).size());
}

}  // namespace gnomon
