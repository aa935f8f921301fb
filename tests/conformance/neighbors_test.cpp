// What a technique must leave alone: its inputs, other people's textures, the state of OpenGL.
#include <cstring>

#include "gl_state.h"
#include "stage.h"

namespace conformance {
namespace {

class Neighbors : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Neighbors, testing::ValuesIn(technique_ids()), id_of);

class GlNeighbors : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, GlNeighbors,
                         testing::ValuesIn(ids_where([](const About& about) { return about.needs_gl; })), id_of);

using Bytes = std::vector<std::uint8_t>;

template <class T>
void append(Bytes& bytes, const T& values) {
  const auto part = std::as_bytes(std::span(values));
  const auto* first = reinterpret_cast<const std::uint8_t*>(part.data());
  bytes.insert(bytes.end(), first, first + part.size());
}

Bytes bytes_of(const Scene& scene, const GBuffer& g) {
  Bytes bytes;
  for (const Mesh& mesh : scene.meshes) append(bytes, mesh.positions), append(bytes, mesh.triangles);
  for (const auto& part : {g.px, g.py, g.pz, g.nx, g.ny, g.nz}) append(bytes, part);
  append(bytes, g.mesh), append(bytes, g.triangle);
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

/// All that kit/gl hands to a technique to read, in order.
std::vector<Bytes> gl_inputs(const Scene& scene, const GBuffer& gbuffer) {
  const SceneBuffers& buffers = scene_buffers(scene);
  const GBufferTextures& textures = gbuffer_textures(gbuffer, scene);
  const DepthStencil& depth = depth_stencil(scene, gbuffer, gbuffer.truth);
  Bytes depths(gbuffer.size() * 4);
  glGetTextureImage(depth.texture.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(depths.size()), depths.data());
  return {read(buffers.positions),
          read(buffers.triangles),
          read(textures.position, GL_RGBA, GL_FLOAT),
          read(textures.normal, GL_RGBA, GL_FLOAT),
          read(textures.ids, GL_RG_INTEGER, GL_UNSIGNED_INT),
          depths};
}

/// A texture with something in it, like the mask of somebody else.
Texture canary(int width, int height) {
  Texture texture(GL_R32F, width, height);
  const float value = 0.25f;
  glClearTexImage(texture.name(), 0, GL_RED, GL_FLOAT, &value);
  return texture;
}

TEST_P(Neighbors, inputs_in_memory_stay_as_they_are) {
  const auto w = world("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  const Bytes before = bytes_of(w->scene, gbuffer);
  for (const Light& light : supported_lights(w->scene)) fresh_answer(w->scene, light, gbuffer);
  EXPECT_EQ(bytes_of(w->scene, gbuffer), before);
}

TEST_P(GlNeighbors, inputs_and_textures_in_opengl_stay_as_they_are) {
  const auto w = world("box_city:count=12");
  const GBuffer gbuffer = w->gbuffer();
  const Texture first = canary(gbuffer.width, gbuffer.height);
  const std::vector<Bytes> before = gl_inputs(w->scene, gbuffer);
  const Bytes colors = read(first, GL_RED, GL_FLOAT);
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto technique = set_up();
    const Texture second = canary(gbuffer.width, gbuffer.height);
    answer(*technique, w->scene, light, gbuffer);
    EXPECT_TRUE(gl_inputs(w->scene, gbuffer) == before) << "an input was written to";
    EXPECT_TRUE(read(first, GL_RED, GL_FLOAT) == colors && read(second, GL_RED, GL_FLOAT) == colors) << "a stranger's texture";
  }
}

TEST_P(GlNeighbors, every_stage_restores_the_state_of_opengl) {
  const auto w = world("sphere_over_plane:segments=16");
  const GBuffer gbuffer = w->gbuffer();
  const std::vector<std::string> none;
  ASSERT_EQ(state_differences(), none);
  for (const Light& light : supported_lights(w->scene)) {
    SCOPED_TRACE(title(light));
    const auto technique = set_up();
    EXPECT_EQ(state_differences(), none) << "setup";
    technique->build(w->scene);
    EXPECT_EQ(state_differences(), none) << "build";
    technique->relight(light);
    EXPECT_EQ(state_differences(), none) << "relight";
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    technique->resolve(gbuffer, mask);
    EXPECT_EQ(state_differences(), none) << "resolve";
    technique->explain(gbuffer.size() / 2);
    for (const DebugLayer& layer : technique->debug_layers()) technique->draw_debug(layer.name);
    EXPECT_EQ(state_differences(), none) << "explain, draw_debug";
  }
  EXPECT_EQ(state_differences(), none) << "destruction";
}

}  // namespace
}  // namespace conformance
