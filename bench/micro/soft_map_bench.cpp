// Resolve of maps for lights with area, beside rays to as many places as a filter has taps: area_rays:samples=32. `ratio` is
// the ratio of their medians. Scene contact, light lamp.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/registry.h>

#include "bench/micro/alternate.h"
#include "device/context.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/scene/load.h"

namespace {
using namespace gnomon;

void resolve(benchmark::State& state, const std::string& id) {
  process_context();
  const Scene scene = load_scene("contact");
  const Light& light = *std::ranges::find(scene.lights, "lamp", &Light::name);
  const RayScene everything(scene, Truth::mesh, RayScene::Which::all);
  const GBuffer gbuffer = make_gbuffer(scene, everything, scene.views[0], 480, 270, Truth::mesh);
  scene_buffers(scene);
  gbuffer_textures(gbuffer, scene);
  const auto made = [&](const std::string& which, const std::string& how) {
    auto technique = registry().technique(which).make();
    technique->apply(how);
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    return technique;
  };
  const auto contender = made(id, ""), floor = made("area_rays", "samples=32");
  VisibilityMask mask(gbuffer.width, gbuffer.height), other(gbuffer.width, gbuffer.height);
  alternate(
      state, [&] { contender->resolve(gbuffer, mask); }, [&] { floor->resolve(gbuffer, other); });
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string id : {"percentage_closer_soft", "backprojected_map"})
    benchmark::RegisterBenchmark(fmt::format("soft_map/resolve/{}", id).c_str(),
                                 [=](benchmark::State& state) { resolve(state, id); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  return true;
}();

}  // namespace
