#include "measure/row/current_scene.h"

#include "measure/paths.h"
#include "measure/scene/load.h"
#include "measure/scene/names.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon {

CurrentScene::CurrentScene(const std::string& reference, const std::string& place, Progress& progress) {
  try {
    scene = load_scene(place);
    frames = std::make_unique<FrameStore>(
        *scene, cache_root() / "frames",
        std::make_unique<WorkerFrameMaker>(std::filesystem::path(), "", shown_on(progress, reference)));
  } catch (const Error& problem) {
    missing = problem.what();
  }
}

std::string CurrentScene::obstacle(const Record& record) {
  if (!scene) return missing;
  const std::vector<std::string> names = light_names(record);
  for (const std::string& name : names)
    if (!find_named(scene->lights, name)) return fmt::format("the scene has no light {} any more", name);
  const std::string hash = context_text(record, "scene_hash");
  if (hash.empty()) return "its record does not say which scene was measured";
  if (hash != frames->scene_hash(names)) return "the scene is not the one that was measured";
  const View* const view = find_named(scene->views, record.view);
  if (!view) return fmt::format("the scene has no view {} any more", record.view);
  for (const std::string& name : names) {
    const Light& light = *find_named(scene->lights, name);
    if (const Support support = reference_support(frames->scene(light), light, *view); !support) return support.why();
  }
  return {};
}

}  // namespace gnomon
