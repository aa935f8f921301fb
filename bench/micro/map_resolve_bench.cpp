// Resolve of maps (contender) beside another technique (floor) in the same picture; `ratio` is the ratio of their medians.
//
// filtered_map  Maps that are filtered before they are read, beside shadow_map with 5 x 5 comparisons at the same resolution:
//               one look-up of means has to be no slower than twenty-five. Target: at most 1.
// soft_map      Maps for lights with area, beside rays to as many places as a filter has taps.
// view_map      Maps that are drawn for the picture, beside shadow_map:fit=view at as many texels: what slices and warps cost
//               over one image that is fitted and drawn as well.
// virtual_map   Beside shadow_map:fit=view at as many texels or more: what pages, their table and their lists cost over images
//               that are fitted and drawn whole.
// mask_pass     The look-up of shadow_map in a compute shader beside the same by fragments: below 1 it is the faster one.
// glass_map     Relight and resolve of maps that hold what several surfaces let through, beside a depth map that takes them for
//               opaque, at the same resolution: what lists, samples, moments and terms cost over one depth.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"

namespace {
using namespace gnomon;

/// The picture: names in the scene, no name for its first view.
struct Picture {
  std::string scene, light, view = {};
  int width = 640, height = 360;
};
struct Way {
  std::string id, settings = {};
};

void time_stage(benchmark::State& state, Stage stage, const Picture& picture, const Way& contender_way, const Way& floor_way) {
  process_context();
  const Scene scene = load_scene(picture.scene);
  const Light& light = named_or_first(scene.lights, picture.light);
  const GBuffer gbuffer = seen(scene, named_or_first(scene.views, picture.view), picture.width, picture.height);
  scene_buffers(scene);
  gbuffer_textures(gbuffer, scene);
  const auto contender = made(contender_way.id, contender_way.settings, scene, light);
  const auto floor = made(floor_way.id, floor_way.settings, scene, light);
  VisibilityMask mask(gbuffer.width, gbuffer.height), other(gbuffer.width, gbuffer.height);
  if (stage == Stage::relight)
    alternate(
        state, [&] { contender->relight(light); }, [&] { floor->relight(light); });
  else
    alternate(
        state, [&] { contender->resolve(gbuffer, mask); }, [&] { floor->resolve(gbuffer, other); });
}

void add(const std::string& name, const Picture& picture, const Way& contender, const Way& floor) {
  add_timed(name, time_stage, Stage::resolve, picture, contender, floor);
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string light : {"point", "sun"}) {
    const auto add_filtered = [&](const std::string& id, const std::string& settings) {
      add(fmt::format("filtered_map/resolve/{}/{}{}{}", id, settings, settings.empty() ? "" : "/", light),
          {.scene = "fence", .light = light, .width = 960, .height = 540}, {id, settings},
          {"shadow_map", "filter=pcf,filter_radius=2"});
    };
    for (const char* id : {"variance_map", "exponential_map", "exponential_variance_map", "moment_map"}) add_filtered(id, "");
    for (const char* settings : {"bits=16", "prefilter=mips", "prefilter=mips,bits=16"}) add_filtered("moment_map", settings);
    if (light == "sun") add_filtered("moment_map", "prefilter=table");
  }
  for (const std::string id : {"percentage_closer_soft", "backprojected_map"})
    add("soft_map/resolve/" + id, {.scene = "contact", .light = "lamp", .width = 480, .height = 270}, {id},
        {"area_rays", "samples=32"});
  for (const auto& [id, settings] : {std::pair("cascaded_map", "resolution=1024"),
                                     {"cascaded_map", "resolution=1024,placement=stable"},
                                     {"warped_map", "resolution=2048"}})
    add(fmt::format("view_map/resolve/{}:{}", id, settings), {.scene = "fence", .light = "sun", .view = "low"}, {id, settings},
        {"shadow_map", "resolution=2048,fit=view"});
  for (const auto& [scene, light, resolution] :
       {std::tuple("fence", "point", 1024), {"fence", "sun", 1600}, {"box_city", "point", 1400}, {"colonnade", "point", 1000}})
    add(fmt::format("virtual_map/resolve/{}/{}", scene, light), {.scene = scene, .light = light}, {"virtual_map"},
        {"shadow_map", fmt::format("bias=receiver_plane,fit=view,resolution={}", resolution)});
  for (const std::string scene : {"fence", "box_city"})
    for (const std::string light : {"point", "sun"})
      for (const std::string filter : {"nearest", "bilinear", "pcf,filter_radius=2"})
        add(fmt::format("mask_pass/resolve/{}/{}/{}", scene, light, filter), {.scene = scene, .light = light},
            {"shadow_map", fmt::format("filter={},pass=compute", filter)},
            {"shadow_map", fmt::format("filter={},pass=fragment", filter)});
  for (const std::string scene : {"glass_stack", "smoke_cards"})
    for (const std::string id : {"transmittance_map", "stochastic_map", "moment_transmittance", "fourier_opacity"})
      for (const Stage stage : {Stage::relight, Stage::resolve})
        add_timed(fmt::format("glass_map/{}/{}/{}", name(stage), id, scene), time_stage, stage,
                  Picture{.scene = scene, .light = "sun"}, Way{id}, Way{"shadow_map", "resolution=1024,glass=opaque"});
  return true;
}();

}  // namespace
