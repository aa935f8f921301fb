// Resolve of virtual_map beside shadow_map:fit=view at as many texels or more: what pages, their table and their lists cost
// over images that are fitted and drawn whole. `ratio` is the ratio of their medians.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/registry.h>

#include "bench/micro/alternate.h"
#include "device/context.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/scene/load.h"

namespace {
using namespace gnomon;

/// `resolution` is that of shadow_map.
void resolve(benchmark::State& state, const std::string& scene_id, const std::string& light_name, int resolution) {
  process_context();
  const Scene scene = load_scene(scene_id);
  const Light& light = *std::ranges::find(scene.lights, light_name, &Light::name);
  const RayScene everything(scene, Truth::mesh, RayScene::Which::all);
  const GBuffer gbuffer = make_gbuffer(scene, everything, scene.views[0], 640, 360, Truth::mesh);
  scene_buffers(scene);
  gbuffer_textures(gbuffer, scene);
  const auto made = [&](const std::string& id, const std::string& settings) {
    auto technique = registry().technique(id).make();
    technique->apply(settings);
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    return technique;
  };
  const auto contender = made("virtual_map", "");
  const auto floor = made("shadow_map", fmt::format("bias=receiver_plane,fit=view,resolution={}", resolution));
  VisibilityMask mask(gbuffer.width, gbuffer.height), other(gbuffer.width, gbuffer.height);
  alternate(
      state, [&] { contender->resolve(gbuffer, mask); }, [&] { floor->resolve(gbuffer, other); });
}

[[maybe_unused]] const bool is_registered = [] {
  const auto add = [](const std::string& scene, const std::string& light, int resolution) {
    benchmark::RegisterBenchmark(fmt::format("virtual_map/resolve/{}/{}", scene, light).c_str(),
                                 [=](benchmark::State& state) { resolve(state, scene, light, resolution); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("fence", "point", 1024);
  add("fence", "sun", 1600);
  add("box_city", "point", 1400);
  add("colonnade", "point", 1000);
  return true;
}();

}  // namespace
