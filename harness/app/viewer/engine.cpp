#include "app/viewer/engine.h"

#include <gnomon/error.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <utility>

#include "app/viewer/engine_side.h"
#include "measure/scene/load.h"

namespace gnomon::viewer {

namespace fs = std::filesystem;

Engine::Body::Body(WorkerOptions the_workers, double timeout, std::function<void()> on_change)
    : workers(std::move(the_workers)), timeout_seconds(timeout), changed(std::move(on_change)) {
  for (int k = 0; k < 2; ++k) sides[k] = std::make_unique<Side>(*this, k);
  for (int lane = 0; lane < lane_count; ++lane) threads.emplace_back([this, lane] { serve(static_cast<Lane>(lane)); });
}

Engine::Body::~Body() {
  {
    const std::lock_guard lock(mutex);
    stop = true;
    for (const auto& side : sides) side->interrupt();
    refinement.give_up();
    news.notify_all();
  }
  for (std::thread& thread : threads) thread.join();
}

void Engine::Body::wake_threads() {
  ++state.number;
  state.is_finished = false;
  std::ranges::fill(is_idle, false);
  news.notify_all();
}

Engine::Body::Work Engine::Body::next(Lane lane) {
  switch (lane) {
    case loading:
      return next_scene();
    case framing:
      return next_frame();
    case refining:
      return next_reference();
    default:
      return sides[lane - left_side]->next();
  }
}

void Engine::Body::serve(Lane lane) {
  // What makes the picture better must not hold up what makes it.
  if (lane == refining) setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 5);
  std::unique_lock lock(mutex);
  while (!stop) {
    if (const Work work = next(lane)) {
      lock.unlock();
      work();
      lock.lock();
      continue;
    }
    is_idle[lane] = true;
    if (!state.is_finished && std::ranges::all_of(is_idle, std::identity{})) {
      state.is_finished = true;
      ++state.number;
      lock.unlock();
      changed();
      lock.lock();
      if (!is_idle[lane] || stop) continue;
    }
    news.wait(lock);
  }
}

Engine::Body::Work Engine::Body::next_scene() {
  if (selection.scene.empty() || selection.scene == tried_scene) return {};
  tried_scene = selection.scene;
  state.scene_error.clear();
  if (state.loaded && state.loaded->reference == selection.scene) return {};
  state.is_loading = true;
  return [this, reference = selection.scene] {
    changed();  // it may take long
    auto loaded = std::make_shared<LoadedScene>();
    std::string trouble;
    try {
      loaded->reference = reference;
      const auto given = std::exchange(offered, nullptr);
      loaded->scene = given && given->reference == reference ? std::move(given->scene) : load_scene(reference);
      auto store = std::make_unique<FrameStore>(loaded->scene, scratch.path());
      // Made here, because they are made on first use, and not for two threads at once.
      for (const Truth truth : {Truth::shape, Truth::mesh}) {
        store->everything(truth);
        store->casters(truth);
      }
      // Its file for the workers goes with it.
      const auto end = [file = store->scene_file()](FrameStore* gone) {
        std::error_code ignored;
        fs::remove(file, ignored);
        delete gone;
      };
      loaded->store = {store.release(), end};
    } catch (const std::exception& error) {
      trouble = error.what();
    }
    change([&](EngineState& s) {
      s.is_loading = false;
      s.scene_error = trouble;
      if (trouble.empty()) s.loaded = loaded;
    });
  };
}

Engine::Engine(WorkerOptions workers, double timeout_seconds, std::function<void()> changed)
    : body_(std::make_unique<Body>(std::move(workers), timeout_seconds, std::move(changed))) {}

Engine::~Engine() = default;

void Engine::offer(const std::string& reference, Scene scene) {
  const std::lock_guard lock(body_->mutex);
  body_->offered = std::make_shared<LoadedScene>();
  body_->offered->reference = reference;
  body_->offered->scene = std::move(scene);
}

std::uint64_t Engine::select(const Selection& selection) {
  const std::lock_guard lock(body_->mutex);
  for (const auto& side : body_->sides) side->drop_work_before(selection);
  if (selection.scene != body_->selection.scene) body_->state.scene_error.clear();
  body_->selection = selection;
  ++body_->state.selection_number;
  body_->wake_threads();
  return body_->state.selection_number;
}

EngineState Engine::state() const {
  const std::lock_guard lock(body_->mutex);
  EngineState state = body_->state;
  const auto now = Body::Clock::now();
  for (int k = 0; k < 2; ++k)
    if (const auto since = body_->sides[k]->since_)
      state.sides[k].seconds = std::chrono::duration<double>(now - *since).count();
  return state;
}

}  // namespace gnomon::viewer
