// Resolve of maps that are drawn for the picture, beside shadow_map:fit=view at as many texels: what slices and warps cost over
// one image that is fitted and drawn as well. `ratio` is the ratio of their medians. Light "sun" of fence, view "low".
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/registry.h>

#include "bench/micro/alternate.h"
#include "device/context.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/scene/load.h"

namespace {
using namespace gnomon;

void resolve(benchmark::State& state, const std::string& id, const std::string& settings) {
  process_context();
  const Scene scene = load_scene("fence");
  const Light& light = *std::ranges::find(scene.lights, "sun", &Light::name);
  const View& view = *std::ranges::find(scene.views, "low", &View::name);
  const RayScene everything(scene, Truth::mesh, RayScene::Which::all);
  const GBuffer gbuffer = make_gbuffer(scene, everything, view, 640, 360, Truth::mesh);
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
  const auto contender = made(id, settings), floor = made("shadow_map", "resolution=2048,fit=view");
  VisibilityMask mask(gbuffer.width, gbuffer.height), other(gbuffer.width, gbuffer.height);
  alternate(
      state, [&] { contender->resolve(gbuffer, mask); }, [&] { floor->resolve(gbuffer, other); });
}

[[maybe_unused]] const bool is_registered = [] {
  const auto add = [](const std::string& id, const std::string& settings) {
    benchmark::RegisterBenchmark(fmt::format("view_map/resolve/{}:{}", id, settings).c_str(),
                                 [=](benchmark::State& state) { resolve(state, id, settings); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("cascaded_map", "resolution=1024");
  add("cascaded_map", "resolution=1024,placement=stable");
  add("warped_map", "resolution=2048");
  return true;
}();

}  // namespace
