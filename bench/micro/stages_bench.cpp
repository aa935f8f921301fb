// Relight and resolve of techniques that draw, on scenes of suite quick at 640 x 360, beside a bare full-screen pass that
// fetches position and normal: where the time of a row goes, with a profiler or two builds side by side.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"

namespace {
using namespace gnomon;

constexpr int width = 640, height = 360;

void stage(benchmark::State& state, const std::string& scene_name, const std::string& light_name, const std::string& id,
           bool relights) {
  process_context();
  const Scene scene = load_scene(scene_name);
  const Light& light = named_or_first(scene.lights, light_name);
  const GBuffer gbuffer = seen(scene, scene.views[0], width, height);
  const GBufferTextures& textures = gbuffer_textures(gbuffer, scene);
  depth_stencil(scene, gbuffer);
  const auto technique = made(id, "", scene, light);
  VisibilityMask mask(width, height), other(width, height);
  const Program bare("bare pass", full_screen_vertex, std::string(gbuffer_snippet) + R"(
layout(location = 0) out float visibility;
void main() { visibility = dot(position_here(), normal_here()) > 0 ? 1 : 0; })");
  const Framebuffer framebuffer = make_framebuffer();
  const auto pass = [&] {
    const StateGuard guard;
    bind_gbuffer(textures);
    glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, other.texture(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, width, height);
    glUseProgram(bare.name());
    draw_full_screen();
    glFinish();
  };
  if (relights)
    alternate(
        state, [&] { technique->relight(light); }, pass);
  else
    alternate(
        state, [&] { technique->resolve(gbuffer, mask); }, pass);
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string id : {"shadow_map", "stencil_volume", "planar_projected"})
    for (const std::string scene : {"fence", "contact", "box_city", "soup:ground=false"})
      for (const std::string light : {"point", "sun"})
        for (const bool relights : {true, false})
          add_timed(fmt::format("stages/{}/{}/{}/{}", id, relights ? "relight" : "resolve", scene, light), stage, scene, light,
                    id, relights);
  return true;
}();

}  // namespace
