// What a new geometry costs: the stages and uploads that a worker reports, beside the wall clock of the same work done here,
// from an empty OpenGL to a finished mask. It is an error if the worker reports less than nine tenths of the clock.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl.h>
#include <gnomon/registry.h>

#include <chrono>

#include "measure/frame/frame.h"
#include "measure/scene/load.h"
#include "measure/statistics/statistics.h"
#include "measure/worker/technique_device.h"
#include "measure/worker/worker_client.h"

namespace {
using namespace gnomon;

constexpr int width = 640, height = 360, rounds = 7;

void geometry_cost(benchmark::State& state, const std::string& scene_name, const std::string& id) {
  const TechniqueEntry& entry = registry().technique(id);
  const std::unique_ptr<TechniqueDevice> device = device_of(entry.about);
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_bench");
  const Scene scene = load_scene(scene_name);
  FrameStore frames(scene, folder.path() / "frames");
  const FrameKey key{scene.views[0], width, height, Truth::mesh};
  const GBuffer gbuffer = frames.gbuffer(key);
  const auto program = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "gnomon";
  WorkerClient worker({.threads = 0, .plugins = {}, .program = program.string()}, folder.path() / "worker", 60);
  worker.load({.scene_file = frames.scene_file(), .technique = id, .settings = {}});
  worker.frame({.gbuffer_file = frames.gbuffer_file(key),
                .width = width,
                .height = height,
                .truth = Truth::mesh,
                .seen = SceneLightAndView{.lights = {0}, .view = 0}});
  const MaskReply answer = worker.answer();
  const auto technique = entry.make();
  technique->setup();
  VisibilityMask mask(width, height);
  std::vector<double> told, clock;
  for (auto _ : state) {
    for (int round = 0; round < rounds; ++round) {
      double sum = answer.gl ? answer.gl->upload_ms : 0;
      for (const Stage stage : {Stage::build, Stage::relight, Stage::resolve}) sum += worker.time(stage);
      told.push_back(sum);
      if (draws(entry.about)) release_inputs();
      const auto start = std::chrono::steady_clock::now();
      technique->build(scene);
      technique->relight(scene.lights[0]);
      technique->resolve(gbuffer, mask);
      device->finish();
      clock.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
  }
  const double told_ms = *median_of_medians({told}), clock_ms = *median_of_medians({clock});
  state.counters["told_ms"] = told_ms;
  state.counters["clock_ms"] = clock_ms;
  state.counters["told/clock"] = told_ms / clock_ms;
  if (told_ms < 0.9 * clock_ms) state.SkipWithError("the stages tell less than nine tenths of the time that passes");
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string scene : {"box_city", "dragon"})
    for (const std::string id : {"shadow_map", "stencil_volume", "embree_rays", "svbsp"})
      benchmark::RegisterBenchmark(("geometry_cost/" + scene + "/" + id).c_str(),
                                   [=](benchmark::State& state) { geometry_cost(state, scene, id); })
          ->Iterations(1)
          ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
