#include "measure/worker/opengl_device.h"

#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/gl/gl_pass.h>

#include "device/card.h"
#include "measure/progress.h"

namespace gnomon {

void for_each_field(MaybeConst<CardState> auto& r, const auto& use) {
  use("name", r.name, "driver", r.driver, "graphics_mhz", r.graphics_mhz, "memory_mhz", r.memory_mhz);
  use("power_w", r.power_w, "power_limit_w", r.power_limit_w, "celsius", r.celsius);
}

std::optional<Json> card_in_json(std::string_view renderer) {
  const auto state = card_state(renderer);
  return state ? std::optional(written(*state)) : std::nullopt;
}

OpenGlDevice::OpenGlDevice() : info_(process_context().info()) {
  // llvmpipe's marks are not in order with its work: 0.2 ms for a resolve of 5, 2.6 for a build of 0.03.
  if (info_.driver != GlChoice::software) stopwatch_.emplace();
}

std::optional<WorkerGl> OpenGlDevice::description() const {
  return WorkerGl{.renderer = info_.renderer,
                  .version = info_.version,
                  .subpixel_bits = static_cast<int>(gl_limits()->subpixel_bits),
                  .card = card()};
}

std::optional<Json> OpenGlDevice::card() const { return info_.is_software() ? std::nullopt : card_in_json(info_.renderer); }

Support OpenGlDevice::within_limits(const Scene& scene, int width, int height) const {
  return gnomon::within_limits(inputs_need(scene, width, height));
}

void OpenGlDevice::finish() { glFinish(); }

void OpenGlDevice::prepare(Stage stage, const Scenes& scenes, const GBuffer& gbuffer) {
  for (const Scene* const scene : scenes) {
    if (stage == Stage::build) forget_scene(*scene);
    if (stage != Stage::resolve) continue;
    gbuffer_textures(gbuffer, *scene);
    for (const Truth sees : {Truth::shape, Truth::mesh})
      if (uses_depth_stencil(sees)) depth_stencil(*scene, gbuffer, sees);
  }
  glFinish();
  before_ = uploaded_scene_bytes();
}

void OpenGlDevice::end_stage() {
  if (const GLenum code = glGetError(); code != GL_NO_ERROR) throw Error("OpenGL error {:#x}", code);
  count_staged();
}

void OpenGlDevice::count_staged() { staged_ += uploaded_scene_bytes() - before_; }

void OpenGlDevice::forget(const Scenes& scenes) {
  for (const Scene* const scene : scenes) forget_scene(*scene);
  forget_floor();
}

std::optional<GlInputs> OpenGlDevice::inputs(const Scenes& scenes, const GBuffer& gbuffer) const {
  UploadCost pictures;
  std::uint64_t geometry = 0;
  for (const Scene* const scene : scenes) {
    const UploadCost picture = picture_uploads(*scene, gbuffer);
    pictures = {pictures.bytes + picture.bytes, pictures.ms + picture.ms};
    if (const SceneBuffers* const triangles = uploaded_scene(*scene)) geometry += triangles->bytes;
  }
  return GlInputs{.input_bytes = pictures.bytes,
                  .upload_ms = pictures.ms,
                  .geometry_bytes = geometry,
                  .loose_bytes = uploaded_scene_bytes() - staged_};
}

FloorRequest::Reply OpenGlDevice::draw_floor(Floor floor, const Scene& scene, const GBuffer& gbuffer, int times) {
  if (!(times >= 1 && times <= most_floor_times)) throw Error("times = {} is outside 1 .. {}", times, most_floor_times);
  const bool was_there = uploaded_scene(scene) != nullptr;
  before_ = uploaded_scene_bytes();
  if (!bare_pass_) {
    bare_pass_.emplace(floor, scene, gbuffer);
    bare_pass_->draw();  // drivers compile at the first draw
  }
  const FloorRequest::Reply reply = time_floor(times);
  count_staged();
  if (!was_there) forget_scene(scene);
  return reply;
}

FloorRequest::Reply OpenGlDevice::time_floor(int times) {
  bare_pass_->draw(1);  // everything it draws has been prepared when the clock starts
  glFinish();
  const auto start = std::chrono::steady_clock::now();
  if (stopwatch_) stopwatch_->start();
  bare_pass_->draw(times);
  if (stopwatch_) stopwatch_->stop();
  glFinish();
  const double ms = 1000 * seconds_since(start);
  return {.ms = ms, .device_ms = stopwatch_ ? stopwatch_->milliseconds() : std::nullopt};
}

void OpenGlDevice::upload(const Scene& scene, const GBuffer& gbuffer, VisibilityMask& mask) {
  scene_buffers(scene);
  gbuffer_textures(gbuffer, scene);
  glClearTexImage(mask.texture(), 0, GL_RED, GL_FLOAT, nullptr);
}

void OpenGlDevice::fill(VisibilityMask& mask, float value) {
  glClearTexImage(mask.texture(), 0, GL_RED, GL_FLOAT, &value);
  TechniqueDevice::fill(mask, value);
}

// Draws a few pixels: the driver frees the memory of a draw, and of deleted objects, at later draws. A software driver holds as
// many draws as it once had under way, which a busy machine makes more: it never has more than these.
void OpenGlDevice::settle() {
  constexpr int most_draws = 64;
  const StateGuard guard;
  static const Program* const program =  // never deleted: its compilation is no work of a draw
      new Program("settle", full_screen_vertex, "layout(location = 0) out float v; void main() { v = 1; }");
  for (int k = 0; k < most_draws; ++k) {
    const Texture texture(GL_R32F, 64, 64);
    const Framebuffer framebuffer = make_framebuffer();
    glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, texture.name(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, 64, 64);
    glUseProgram(program->name());
    draw_full_screen();
    glFinish();
    glUseProgram(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
  }
}

}  // namespace gnomon
