#include "kit/gl/gl_masks.h"

#include <gnomon/kit/gl/gl.h>

#include <cstring>
#include <map>

namespace gnomon {

const std::string_view mask_vertex_snippet = R"(
layout(location = 2) in vec2 uv;
layout(location = 3) in int mask;
out vec2 mask_uv;
flat out int mask_number;
void hand_on_mask() {
  mask_uv = uv;
  mask_number = mask;
}
)";

// A mask's eight words: width, height, wrap along both axes, words of a row, first word of its bits, two unused.
const std::string_view mask_fragment_snippet = R"(
in vec2 mask_uv;
flat in int mask_number;
layout(std430, binding = 7) readonly buffer AlphaMasks { uint mask_words[]; };
int wrapped_texel(int place, int size, uint wrap) {
  if (wrap == 2u) return clamp(place, 0, size - 1);
  int period = wrap == 1u ? 2 * size : size;
  int rest = place % period;
  if (rest < 0) rest += period;
  return rest < size ? rest : period - 1 - rest;
}
bool in_hole() {
  if (mask_number < 0) return false;
  uint facts = 8u * uint(mask_number);
  ivec2 size = ivec2(mask_words[facts], mask_words[facts + 1u]);
  ivec2 place = ivec2(floor(mask_uv * vec2(size)));
  uint column = uint(wrapped_texel(place.x, size.x, mask_words[facts + 2u]));
  uint row = uint(wrapped_texel(place.y, size.y, mask_words[facts + 3u]));
  uint word = mask_words[mask_words[facts + 5u] + row * mask_words[facts + 4u] + (column >> 5u)];
  return (word >> (column & 31u) & 1u) == 0u;
}
)";

const std::string depth_vertex = std::string(position_snippet) + R"(
void main() {
  gl_Position = place(vec4(position, 1));
#ifdef MASKED
  hand_on_mask();
#endif
}
)";
const std::string depth_fragment = R"(
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
}
)";

CasterPrograms::CasterPrograms(std::string_view title, std::string_view vertex, std::string_view fragment)
    : title_(title), vertex_(vertex), fragment_(fragment), solid_(title, vertex, fragment) {}

void CasterPrograms::fit(const Scene& scene) {
  if (masked_ || !scene.has_alpha_masks()) return;
  masked_ = Program(title_ + ", holes left out", fmt::format("#define MASKED\n{}{}", mask_vertex_snippet, vertex_),
                    fmt::format("#define MASKED\n{}{}", mask_fragment_snippet, fragment_));
}

namespace {

constexpr std::size_t facts_words = 8;

/// The masks of a scene, each once, in the order of their first meshes.
std::vector<const AlphaMask*> masks_in(const Scene& scene) {
  std::vector<const AlphaMask*> masks;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.alpha_mask && std::ranges::find(masks, mesh.alpha_mask.get()) == masks.end())
      masks.push_back(mesh.alpha_mask.get());
  return masks;
}

}  // namespace

std::size_t mask_bytes(const Scene& scene) {
  std::size_t words = 0;
  for (const AlphaMask* mask : masks_in(scene)) words += facts_words + mask->bits().size();
  return 4 * words;
}

void upload_masks(const Scene& scene, SceneBuffers& buffers) {
  if (!scene.has_alpha_masks()) return;
  const std::vector<const AlphaMask*> masks = masks_in(scene);
  require_storage_block(mask_bytes(scene));
  std::vector<std::uint32_t> words(facts_words * masks.size());
  std::map<const AlphaMask*, std::int32_t> number_of;
  for (std::size_t k = 0; k < masks.size(); ++k) {
    const AlphaMask& mask = *masks[k];
    number_of[&mask] = static_cast<std::int32_t>(k);
    const std::uint32_t facts[facts_words] = {std::uint32_t(mask.width()),  std::uint32_t(mask.height()),
                                              std::uint32_t(mask.wrap_u()), std::uint32_t(mask.wrap_v()),
                                              std::uint32_t(mask.words()),  std::uint32_t(words.size())};
    std::ranges::copy(facts, words.begin() + static_cast<std::ptrdiff_t>(facts_words * k));
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

void SceneBuffers::bind_masks() const {
  if (masks) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 7, masks.name());
}

void SceneBuffers::draw(const std::vector<std::uint32_t>& which, const CasterPrograms& programs) const {
  std::vector<std::uint32_t> solid, with_holes;
  for (const std::uint32_t m : which) (meshes[m].has_holes ? with_holes : solid).push_back(m);
  glUseProgram(programs.solid().name());
  draw(solid);
  if (with_holes.empty()) return;
  bind_masks();
  glUseProgram(programs.masked().name());
  draw(with_holes);
  glUseProgram(programs.solid().name());
}

}  // namespace gnomon
