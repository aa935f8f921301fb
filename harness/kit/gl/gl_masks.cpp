#include "kit/gl/gl_masks.h"

#include <gnomon/kit/gl/gl.h>

#include <cstring>
#include <map>

namespace gnomon {

std::vector<const AlphaMask*> masks_in(const Scene& scene) {
  std::vector<const AlphaMask*> masks;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.alpha_mask && std::ranges::find(masks, mesh.alpha_mask.get()) == masks.end())
      masks.push_back(mesh.alpha_mask.get());
  return masks;
}

std::size_t mask_bytes(const Scene& scene) {
  std::size_t words = 0;
  for (const AlphaMask* mask : masks_in(scene)) words += mask_facts_words + mask->bits().size();
  return 4 * words;
}

void upload_masks(const Scene& scene, SceneBuffers& buffers) {
  if (!scene.has_alpha_masks()) return;
  const std::vector<const AlphaMask*> masks = masks_in(scene);
  require_storage_block(mask_bytes(scene));
  std::vector<std::uint32_t> words(mask_facts_words * masks.size());
  std::map<const AlphaMask*, std::int32_t> number_of;
  for (std::size_t k = 0; k < masks.size(); ++k) {
    const AlphaMask& mask = *masks[k];
    number_of[&mask] = static_cast<std::int32_t>(k);
    const std::uint32_t facts[mask_facts_words] = {std::uint32_t(mask.width()),  std::uint32_t(mask.height()),
                                                   std::uint32_t(mask.wrap_u()), std::uint32_t(mask.wrap_v()),
                                                   std::uint32_t(mask.words()),  std::uint32_t(words.size())};
    std::ranges::copy(facts, words.begin() + static_cast<std::ptrdiff_t>(mask_facts_words * k));
    words.insert(words.end(), mask.bits().begin(), mask.bits().end());
  }
  std::vector<glm::vec2> uv;
  std::vector<std::int32_t> mask_of;
  for (const Mesh& mesh : scene.meshes) {
    uv.insert(uv.end(), mesh.uv.begin(), mesh.uv.end());
    mask_of.resize(mask_of.size() + mesh.positions.size(), mesh.alpha_mask ? number_of.at(mesh.alpha_mask.get()) : -1);
    uv.resize(mask_of.size());
  }
  buffers.masks = Buffer(words.data(), words.size() * 4);
  buffers.uv = Buffer(uv.data(), uv.size() * sizeof(glm::vec2));
  buffers.mask_of = Buffer(mask_of.data(), mask_of.size() * 4);
  add_mask_attributes(buffers.vertex_array, buffers);
  buffers.bytes += buffers.masks.bytes + buffers.uv.bytes + buffers.mask_of.bytes;
}

void add_mask_attributes(const VertexArray& vertex_array, const SceneBuffers& buffers) {
  if (!buffers.masks) return;
  const GLuint vao = vertex_array.name();
  glVertexArrayVertexBuffer(vao, 2, buffers.uv.name(), 0, sizeof(glm::vec2));
  glVertexArrayAttribFormat(vao, 2, 2, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayVertexBuffer(vao, 3, buffers.mask_of.name(), 0, 4);
  glVertexArrayAttribIFormat(vao, 3, 1, GL_INT, 0);
  for (const GLuint attribute : {2u, 3u}) {
    glVertexArrayAttribBinding(vao, attribute, attribute);
    glEnableVertexArrayAttrib(vao, attribute);
  }
}

void SceneBuffers::bind_masks(const HoleTest& test) const {
  if (masks) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, test.alpha != 0 ? test.alpha : masks.name());
}

void SceneBuffers::draw(const std::vector<std::uint32_t>& which, const CasterPrograms& programs, const HoleTest& test) const {
  std::vector<std::uint32_t> solid, with_holes;
  for (const std::uint32_t m : which) (meshes[m].has_holes ? with_holes : solid).push_back(m);
  glUseProgram(programs.solid().name());
  draw(solid);
  if (with_holes.empty()) return;
  bind_masks(test);
  glUseProgram(programs.masked(test.rule).name());
  draw(with_holes);
  glUseProgram(programs.solid().name());
}

}  // namespace gnomon
