#include "kit/gl/gl_masks.h"

#include <gnomon/kit/gl/gl.h>

#include <bit>
#include <map>

namespace gnomon {

namespace {

/// What a scene's meshes have of a kind, each once, in the order of their first meshes.
template <class Held>
std::vector<const Held*> held_by(const Scene& scene, std::shared_ptr<const Held> Mesh::*member) {
  std::vector<const Held*> all;
  for (const Mesh& mesh : scene.meshes)
    if (const Held* one = (mesh.*member).get(); one && std::ranges::find(all, one) == all.end()) all.push_back(one);
  return all;
}

/// For each vertex the number of what its mesh has among these; -1: nothing.
template <class Held>
Buffer numbers_of(const Scene& scene, std::shared_ptr<const Held> Mesh::*member, const std::vector<const Held*>& all) {
  std::map<const Held*, std::int32_t> number_of{{nullptr, -1}};
  for (const Held* one : all) number_of.emplace(one, static_cast<std::int32_t>(number_of.size()) - 1);
  std::vector<std::int32_t> numbers;
  for (const Mesh& mesh : scene.meshes)
    numbers.resize(numbers.size() + mesh.positions.size(), number_of.at((mesh.*member).get()));
  return Buffer(numbers.data(), numbers.size() * 4);
}

Buffer place_buffer(const Scene& scene) {
  std::vector<glm::vec2> uv;
  std::size_t vertices = 0;
  for (const Mesh& mesh : scene.meshes) {
    uv.insert(uv.end(), mesh.uv.begin(), mesh.uv.end());
    vertices += mesh.positions.size();
    uv.resize(vertices);
  }
  return Buffer(uv.data(), uv.size() * sizeof(glm::vec2));
}

/// Facts and bits, as in_hole() reads them (gl_caster_programs.cpp).
std::vector<std::uint32_t> words_of(const std::vector<const AlphaMask*>& masks) {
  std::vector<std::uint32_t> words(mask_facts_words * masks.size());
  for (std::size_t k = 0; k < masks.size(); ++k) {
    const AlphaMask& mask = *masks[k];
    const std::uint32_t facts[mask_facts_words] = {std::uint32_t(mask.width()),  std::uint32_t(mask.height()),
                                                   std::uint32_t(mask.wrap_u()), std::uint32_t(mask.wrap_v()),
                                                   std::uint32_t(mask.words()),  std::uint32_t(words.size())};
    std::ranges::copy(facts, words.begin() + static_cast<std::ptrdiff_t>(mask_facts_words * k));
    words.insert(words.end(), mask.bits().begin(), mask.bits().end());
  }
  return words;
}

/// Facts and floats, as transmission_here() reads them.
std::vector<std::uint32_t> words_of(const std::vector<const Transmission*>& transmissions) {
  std::vector<std::uint32_t> words(mask_facts_words * transmissions.size());
  for (std::size_t k = 0; k < transmissions.size(); ++k) {
    const Transmission& one = *transmissions[k];
    const std::uint32_t facts[mask_facts_words] = {std::uint32_t(one.width()),    std::uint32_t(one.height()),
                                                   std::uint32_t(one.wrap_u()),   std::uint32_t(one.wrap_v()),
                                                   std::uint32_t(one.channels()), std::uint32_t(words.size())};
    std::ranges::copy(facts, words.begin() + static_cast<std::ptrdiff_t>(mask_facts_words * k));
    for (const float value : one.values()) words.push_back(std::bit_cast<std::uint32_t>(value));
  }
  return words;
}

Buffer uploaded_words(const std::vector<std::uint32_t>& words) {
  require_storage_block(words.size() * 4);
  return Buffer(words.data(), words.size() * 4);
}

}  // namespace

std::vector<const AlphaMask*> masks_in(const Scene& scene) { return held_by(scene, &Mesh::alpha_mask); }

std::size_t mask_bytes(const Scene& scene) {
  std::size_t words = 0;
  for (const AlphaMask* mask : masks_in(scene)) words += mask_facts_words + mask->bits().size();
  return 4 * words;
}

std::size_t transmission_bytes(const Scene& scene) {
  std::size_t words = 0;
  for (const Transmission* one : held_by(scene, &Mesh::transmission)) words += mask_facts_words + one->values().size();
  return 4 * words;
}

void upload_masks(const Scene& scene, SceneBuffers& buffers) {
  if (const auto masks = masks_in(scene); !masks.empty()) {
    buffers.masks = uploaded_words(words_of(masks));
    buffers.mask_of = numbers_of(scene, &Mesh::alpha_mask, masks);
  }
  if (const auto transmissions = held_by(scene, &Mesh::transmission); !transmissions.empty()) {
    buffers.transmissions = uploaded_words(words_of(transmissions));
    buffers.transmission_of = numbers_of(scene, &Mesh::transmission, transmissions);
  }
  if (std::ranges::any_of(scene.meshes, &Mesh::needs_uv)) buffers.uv = place_buffer(scene);
  add_mask_attributes(buffers.vertex_array, buffers);
  for (const Buffer* one : {&buffers.masks, &buffers.mask_of, &buffers.transmissions, &buffers.transmission_of, &buffers.uv})
    buffers.bytes += one->bytes;
}

void add_mask_attributes(const VertexArray& vertex_array, const SceneBuffers& buffers) {
  const GLuint vao = vertex_array.name();
  const auto add = [&](GLuint attribute, const Buffer& buffer, GLsizei bytes) {
    if (!buffer) return;
    glVertexArrayVertexBuffer(vao, attribute, buffer.name(), 0, bytes);
    if (attribute == 2)
      glVertexArrayAttribFormat(vao, attribute, 2, GL_FLOAT, GL_FALSE, 0);
    else
      glVertexArrayAttribIFormat(vao, attribute, 1, GL_INT, 0);
    glVertexArrayAttribBinding(vao, attribute, attribute);
    glEnableVertexArrayAttrib(vao, attribute);
  };
  add(2, buffers.uv, sizeof(glm::vec2));
  add(3, buffers.mask_of, 4);
  add(4, buffers.transmission_of, 4);
}

void SceneBuffers::bind_masks(const HoleTest& test) const {
  if (masks) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, test.alpha != 0 ? test.alpha : masks.name());
}

void SceneBuffers::bind_transmissions() const {
  if (transmissions) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 6, transmissions.name());
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
