#include "app/viewer/scene_lane.h"

#include <utility>

#include "measure/notice.h"
#include "measure/scene/load.h"
#include "measure/worker/worker_frame_maker.h"

namespace gnomon::viewer {

namespace {

/// Throws WorkerFailure for a scene that crashes the ray tracer, which the viewer's own process uses from then on.
void try_in_a_worker(const Scene& scene, const std::filesystem::path& folder, const std::string& program) {
  const ScratchFolder trial = ScratchFolder::at(folder / "trial");
  FrameStore frames(scene, trial.path(), std::make_unique<WorkerFrameMaker>(trial.path() / "frame", program));
  const View& view = scene.views.front();
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    const FrameKey key{view, 64, 36, truth};
    frames.gbuffer(key);
    for (const Light& light : scene.lights)
      if (reference_support(frames.scene(light), light, view)) frames.reference(key, light);
  }
}

}  // namespace

Work SceneLane::next() {
  const std::string& reference = board_.selection.scene;
  if (reference.empty() || reference == tried_) return {};
  tried_ = reference;
  board_.state.scene_error.clear();
  if (board_.state.loaded && board_.state.loaded->reference == reference) return {};
  board_.state.is_loading = true;
  return [this, reference] {
    board_.changed();  // it may take long
    std::shared_ptr<const LoadedScene> loaded;
    std::string trouble;
    try {
      loaded = load(reference);
    } catch (const std::exception& error) {
      trouble = message_of(error);
    }
    board_.change([&](EngineState& s) {
      s.is_loading = false;
      s.scene_error = trouble;
      if (loaded) s.loaded = loaded;
    });
  };
}

std::shared_ptr<const LoadedScene> SceneLane::load(const std::string& reference) {
  std::shared_ptr<LoadedScene> loaded = std::exchange(offered_, nullptr);
  if (!loaded || loaded->reference != reference)
    loaded = std::make_shared<LoadedScene>(LoadedScene{reference, load_scene(reference)});
  try_in_a_worker(loaded->scene, board_.scratch.path(), board_.workers.program);
  auto store = std::make_unique<FrameStore>(loaded->scene, board_.scratch.path());
  // Made here, because they are made on first use, and not for two threads at once.
  for (const Truth truth : {Truth::shape, Truth::mesh}) {
    store->everything(truth);
    for (const Light& light : loaded->scene.lights) store->casters(truth, light);
  }
  // Its file for the workers goes with it.
  const auto end = [file = owned_file(store->scene_file())](FrameStore* gone) { delete gone; };
  loaded->store = {store.release(), end};
  return loaded;
}

}  // namespace gnomon::viewer
