#pragma once
// What the tests of the viewer's engine share: an engine without a window, and what `gnomon render` makes of the same.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "app/viewer/engine.h"
#include "measure/row/measure_row.h"
#include "measure/scene/pose.h"
#include "measure/scratch_folder.h"
#include "places.h"

namespace gnomon::viewer::engine_rig {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

/// An engine and a person who looks at it.
class TestRig {
 public:
  TestRig() : engine_({.threads = 0, .plugins = {}, .program = tested_program()}, 60, [this] { wake(); }) {
    selection.sides = {SideSelection{.technique = "shadow_map", .settings = "resolution=256", .layer = ""},
                       SideSelection{.technique = "embree_rays", .settings = "", .layer = ""}};
    selection.width = 160;
    selection.height = 90;
  }

  /// Opens a scene at its own first light and view.
  void open(const std::string& scene) {
    selection.scene = scene;
    engine_.select(selection);
    const EngineState state = until([&](const EngineState& s) {
      if (!s.scene_error.empty()) throw Error("{}", s.scene_error);
      return s.loaded && s.loaded->reference == scene;
    });
    selection.loaded = state.loaded;
    selection.light = state.loaded->scene.lights[0];
    selection.view = state.loaded->scene.views[0];
  }
  /// Selects and waits until nothing is left to do.
  EngineState finish() {
    const std::uint64_t number = engine_.select(selection);
    return until([&](const EngineState& s) { return s.selection_number == number && s.is_finished; });
  }
  EngineState until(const std::function<bool(const EngineState&)>& is_there) {
    const auto deadline = Clock::now() + seconds(60);
    for (;;) {
      std::unique_lock lock(mutex_);
      const std::uint64_t seen = changes_;
      lock.unlock();
      const EngineState state = engine_.state();
      if (is_there(state)) return state;
      lock.lock();
      news_.wait_until(lock, deadline, [&] { return changes_ != seen; });
      if (Clock::now() >= deadline) throw Error("the engine did not come to it within a minute");
    }
  }
  Engine& engine() { return engine_; }

  Selection selection;

 private:
  void wake() {
    const std::lock_guard lock(mutex_);
    ++changes_;
    news_.notify_all();
  }
  std::mutex mutex_;
  std::condition_variable news_;
  std::uint64_t changes_ = 0;
  Engine engine_;
};

/// The mask and causes of the same state by the way that `gnomon render` goes; of a time as a still.
inline MeasuredRow rendered(const Selection& selection, int side) {
  Scene scene = selection.loaded->scene;
  if (selection.at) freeze(scene, {selection.at->animation, selection.at->seconds});
  scene.lights = lights_of(selection);
  scene.views = {selection.view};
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_engine_test");
  SceneRun run(scene, {.cache = folder.path(), .scratch = folder.path(), .program_that_traces = tested_program()});
  ContenderWorker worker(run, selection.sides[side].technique, selection.sides[side].settings,
                         {.threads = 0, .plugins = {}, .program = tested_program()});
  worker.begin_load();
  worker.end_load();
  RowFrame frame{.width = selection.width, .height = selection.height, .path = {}};
  frame.lights.clear();
  for (std::size_t k = 0; k < scene.lights.size(); ++k) frame.lights.push_back(k);
  worker.go(frame, selection.truth);
  Record record;
  record.technique = selection.sides[side].technique;
  record.truth = selection.truth;
  record.lights.resize(scene.lights.size());
  return *measure(record, run, worker, frame);
}

inline ErrorCounts errors_of(const MeasuredRow& row, const Selection& selection) {
  const Evidence evidence = row.evidence(selection.loaded->scene);
  return Scoring(evidence).error_counts();
}

inline void expect_as_rendered(const Selection& selection, const EngineState& state) {
  const MeasuredRow row = rendered(selection, 0);
  const SideState& side = state.sides[0];
  ASSERT_EQ(side.phase, Phase::done) << side.words;
  EXPECT_EQ(side.answer->mask, row.lights[0].answer.mask);
  ASSERT_TRUE(side.verdict && side.verdict->has_causes);
  EXPECT_EQ(side.verdict->errors.wrong, errors_of(row, selection).wrong);
  EXPECT_EQ(side.verdict->errors.false_dark, errors_of(row, selection).false_dark);
  EXPECT_EQ(side.verdict->causes, row.lights[0].answer.causes);
  EXPECT_TRUE(std::ranges::equal(state.reference->mask, row.lights[0].answer.reference.mask));
  EXPECT_TRUE(std::ranges::equal(state.reference->classes, row.lights[0].answer.reference.classes));
}

}  // namespace gnomon::viewer::engine_rig
