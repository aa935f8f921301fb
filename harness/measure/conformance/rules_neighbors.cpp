// What a technique must leave alone: its inputs, textures of others, the state of OpenGL.
#include <gnomon/kit/gl/gl.h>

#include <functional>

#include "measure/conformance/gl_state.h"
#include "measure/conformance/motion_world.h"
#include "measure/conformance/trial.h"

namespace gnomon::conformance {
namespace {

using Bytes = std::vector<std::byte>;

template <class T>
void append(Bytes& bytes, const T& values) {
  const auto part = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), part.begin(), part.end());
}

Bytes bytes_of(const Scene& scene, const GBuffer& g) {
  Bytes bytes;
  for (const Mesh& mesh : scene.meshes) {
    append(bytes, mesh.positions);
    append(bytes, mesh.triangles);
    append(bytes, mesh.uv);
  }
  for (const auto& part : {g.px, g.py, g.pz, g.nx, g.ny, g.nz}) append(bytes, part);
  append(bytes, g.mesh);
  append(bytes, g.triangle);
  return bytes;
}

Bytes read(const Texture& texture, GLenum format, GLenum type) {
  Bytes bytes(texture.bytes);
  glGetTextureImage(texture.name(), 0, format, type, static_cast<GLsizei>(bytes.size()), bytes.data());
  return bytes;
}

Bytes read(const Buffer& buffer) {
  Bytes bytes(buffer.bytes);
  glGetNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes.size()), bytes.data());
  return bytes;
}

/// All that kit/gl/gl gives a technique to read, in order: name and bytes.
std::vector<std::pair<const char*, Bytes>> gl_inputs_now(const Scene& scene, const GBuffer& gbuffer) {
  const SceneBuffers& buffers = scene_buffers(scene);
  const GBufferTextures& textures = gbuffer_textures(gbuffer, scene);
  const DepthStencil& depth = depth_stencil(scene, gbuffer, gbuffer.truth);
  Bytes depths(gbuffer.size() * 4);
  glGetTextureImage(depth.texture.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(depths.size()), depths.data());
  return {{"the buffer of positions", read(buffers.positions)},
          {"the buffer of triangles", read(buffers.triangles)},
          {"the G-buffer's positions", read(textures.position, GL_RGBA, GL_FLOAT)},
          {"the G-buffer's normals", read(textures.normal, GL_RGBA, GL_FLOAT)},
          {"the G-buffer's ids", read(textures.ids, GL_RG_INTEGER, GL_UNSIGNED_INT)},
          {"the eye's depths", depths}};
}

/// A texture with numbers in it, like another technique's mask.
Texture canary(int width, int height) {
  Texture texture(GL_R32F, width, height);
  const float value = 0.25f;
  glClearTexImage(texture.name(), 0, GL_RED, GL_FLOAT, &value);
  return texture;
}

/// What a frame does in which nothing moved.
void update_and_answer(const Trial& trial, Technique& technique, const Scene& scene, const Light& light,
                       const GBuffer& gbuffer) {
  technique.update(scene, no_changes(scene));
  technique.relight(light);
  trial.resolve(technique, gbuffer);
}

void inputs(Trial& trial) {
  const auto w = trial.enter("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  const Bytes before = bytes_of(w->scene, gbuffer);
  for (const Light& light : trial.supported_lights(w->scene)) {
    trial.at(light);
    const auto technique = trial.set_up();
    trial.answer(*technique, w->scene, light, gbuffer);
    update_and_answer(trial, *technique, w->scene, light, gbuffer);
    if (bytes_of(w->scene, gbuffer) != before) return trial.found("scene or G-buffer were written to");
  }
}

void gl_inputs(Trial& trial) {
  const auto w = trial.enter("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  const Texture first = canary(gbuffer.width, gbuffer.height);
  const auto before = gl_inputs_now(w->scene, gbuffer);
  const Bytes colors = read(first, GL_RED, GL_FLOAT);
  for (const Light& light : trial.supported_lights(w->scene)) {
    trial.at(light);
    const auto technique = trial.set_up();
    const Texture second = canary(gbuffer.width, gbuffer.height);
    trial.answer(*technique, w->scene, light, gbuffer);
    update_and_answer(trial, *technique, w->scene, light, gbuffer);
    const auto after = gl_inputs_now(w->scene, gbuffer);
    for (std::size_t k = 0; k < before.size(); ++k)
      trial.expect(after[k].second == before[k].second, fmt::format("{} were written to", before[k].first));
    trial.expect(read(first, GL_RED, GL_FLOAT) == colors && read(second, GL_RED, GL_FLOAT) == colors,
                 "a texture that is not the technique's was written to");
  }
}

/// The same of a scene that moved. `look` finds what is not at its default.
void gl_state_after_update(Trial& trial, const std::function<void(std::string_view)>& look) {
  MovingWorld world(moving_things(true), trial.entry().about.sees);
  trial.at(world.scene().name);
  const std::vector<Light> lights = trial.supported_lights(world.scene());
  if (lights.empty()) return;
  trial.at(lights[0]);
  const auto technique = trial.set_up();
  trial.answer(*technique, world.scene(), lights[0], world.gbuffer());
  world.take_changes();
  world.go_to(MovingWorld::inside_frame);
  const GBuffer& gbuffer = world.gbuffer();
  if (!trial.support(world.scene(), lights[0])) return;
  technique->update(world.scene(), world.take_changes());
  look("update");
  technique->relight(lights[0]);
  look("relight after update");
  trial.resolve(*technique, gbuffer);
  look("resolve after update");
}

void gl_state(Trial& trial) {
  const auto w = trial.enter("sphere_over_plane:segments=16");
  const GBuffer gbuffer = w->gbuffer();
  const auto look = [&](std::string_view after) {
    for (const std::string& difference : state_differences()) trial.found(fmt::format("after {}: {}", after, difference));
  };
  look("nothing but the harness");
  for (const Light& light : trial.supported_lights(w->scene)) {
    trial.at(light);
    const auto technique = trial.set_up();
    look("setup");
    technique->build(w->scene);
    look("build");
    technique->relight(light);
    look("relight");
    trial.begin(*technique);
    look("forget");
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    technique->resolve(gbuffer, mask);
    look("resolve");
    technique->explain(gbuffer.size() / 2);
    for (const DebugLayer& layer : technique->debug_layers()) technique->draw_debug(layer.name);
    look("explain and draw_debug");
  }
  gl_state_after_update(trial, look);
  look("destruction");
}

}  // namespace

std::vector<Rule> neighbor_rules() {
  return {Rule("inputs", inputs, {.has_small_pictures = true, .sanitized = Sanitized::nothing},
               "Scene and G-buffer in memory stay unchanged.", "Take no const away: copy what has to be changed.",
               "Open the files of scene and G-buffer for reading only: copy what has to be changed."),
          Rule("gl_inputs", gl_inputs,
               {.applies_to = AppliesTo::drawing, .has_small_pictures = true, .sanitized = Sanitized::nothing},
               "OpenGL buffers and textures of scene and G-buffer stay unchanged, and so do textures of others.",
               "Write to objects of your own only: look for a framebuffer, an image unit or a storage binding that still holds "
               "somebody else's name."),
          Rule("gl_state", gl_state,
               {.applies_to = AppliesTo::drawing, .has_small_pictures = true, .sanitized = Sanitized::nothing},
               "Every stage, explain, draw_debug and the destructor leave the state of OpenGL at its defaults, and no error "
               "pending.",
               "Put a StateGuard (gnomon/kit/gl/gl_pass.h) at the beginning of every function that draws, or set back what is "
               "named.")};
}

}  // namespace gnomon::conformance
