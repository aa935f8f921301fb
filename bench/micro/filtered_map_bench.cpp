// Resolve of maps that are filtered before they are asked, beside shadow_map with 5 x 5 comparisons (filter=pcf,
// filter_radius=2) at the same resolution: one look-up of means has to be no slower than twenty-five. `ratio` is the ratio of
// their medians. Wanted: at most 1.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/registry.h>

#include "bench/micro/alternate.h"
#include "device/context.h"
#include "measure/frame/gbuffer_maker.h"
#include "measure/scene/load.h"

namespace {
using namespace gnomon;

constexpr int width = 960, height = 540;

void resolve(benchmark::State& state, const std::string& id, const std::string& settings, const std::string& light_name) {
  process_context();
  const Scene scene = load_scene("fence");
  const Light& light = *std::ranges::find(scene.lights, light_name, &Light::name);
  const RayScene everything(scene, Truth::mesh, RayScene::Which::all);
  const GBuffer gbuffer = make_gbuffer(scene, everything, scene.views[0], width, height, Truth::mesh);
  scene_buffers(scene);
  gbuffer_textures(gbuffer, scene);
  const auto made = [&](const std::string& which, const std::string& settings) {
    auto technique = registry().technique(which).make();
    technique->apply(settings);
    technique->setup();
    technique->build(scene);
    technique->relight(light);
    return technique;
  };
  const auto contender = made(id, settings), floor = made("shadow_map", "filter=pcf,filter_radius=2");
  VisibilityMask mask(width, height), other(width, height);
  alternate(
      state, [&] { contender->resolve(gbuffer, mask); }, [&] { floor->resolve(gbuffer, other); });
}

[[maybe_unused]] const bool is_registered = [] {
  const auto add = [](const std::string& id, const std::string& settings, const std::string& light) {
    const std::string name = fmt::format("filtered_map/resolve/{}/{}{}{}", id, settings, settings.empty() ? "" : "/", light);
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { resolve(state, id, settings, light); })
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  for (const std::string light : {"point", "sun"}) {
    for (const std::string id : {"variance_map", "exponential_map", "exponential_variance_map", "moment_map"})
      add(id, "", light);
    for (const std::string settings : {"bits=16", "prefilter=mips", "prefilter=mips,bits=16", "prefilter=table"})
      if (settings != "prefilter=table" || light == "sun") add("moment_map", settings, light);
  }
  return true;
}();

}  // namespace
