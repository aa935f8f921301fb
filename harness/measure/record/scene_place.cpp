#include "measure/record/scene_place.h"

#include "measure/scene/load.h"

namespace gnomon {

namespace fs = std::filesystem;

std::optional<std::string> path_to_scene(const fs::path& run_folder, const std::string& reference) {
  std::error_code code;
  if (!names_file(reference) || !fs::is_regular_file(reference, code)) return {};
  const fs::path file = fs::weakly_canonical(reference, code), folder = fs::weakly_canonical(run_folder, code);
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
  return fs::is_regular_file(file, code) ? file.string() : record.scene;
}

}  // namespace gnomon
