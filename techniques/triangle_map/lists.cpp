#include "lists.h"

#include <algorithm>

namespace gnomon::triangle_map {

namespace {

constexpr std::string_view touch_vertex = R"(
layout(location = 0) in vec3 position;
uniform vec3 list_origin;
uniform mat3 list_axes;
out vec3 list_seen;
void main() { list_seen = list_axes * (position - list_origin); }
)";

// Conservative rasterization: the box of texels around a triangle, and in it, for the fragments, the triangle's edges, moved
// out by half of what a texel's square is wide across them (Hasselgren, Akenine-Moeller and Ohlsson 2005). The box is whole
// texels, so that no rounding of the rasterizer matters. Edges are planes through the light (Olano and Greer 1997): a corner
// behind it needs no clipping. In double, for a small triangle far from the image's corner is a difference of large numbers.
constexpr std::string_view touch_geometry = R"(
layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;
in vec3 list_seen[];
uniform vec4 list_window;  // scale and offset
uniform vec2 list_slack;   // texels, and texels at distance 1
uniform int list_side, list_first;
flat out vec3 list_edge_0, list_edge_1, list_edge_2;
flat out vec2 list_corner;
flat out uint list_number;

vec3 edges[3];
dvec2 low, high;
void give(vec2 at) {
  list_edge_0 = edges[0];
  list_edge_1 = edges[1];
  list_edge_2 = edges[2];
  list_corner = vec2(low);
  list_number = uint(list_first + gl_PrimitiveIDIn);
  gl_Position = vec4(2 * at.x / float(list_side) - 1, 1 - 2 * at.y / float(list_side), 0.5, 1);
  EmitVertex();
}

void main() {
  dvec3 h[3];  // texel coordinates, times z where rays start at the light
  for (int k = 0; k < 3; ++k) {
    dvec3 q = dvec3(list_seen[k]);
#if IS_PARALLEL
    h[k] = dvec3(q.xy * dvec2(list_window.xy) + dvec2(list_window.zw), 1);
#else
    h[k] = dvec3(q.xy * dvec2(list_window.xy) + q.z * dvec2(list_window.zw), q.z);
#endif
  }
  double side = double(list_side);
  double nearest = min(h[0].z, min(h[1].z, h[2].z)), farthest = max(h[0].z, max(h[1].z, h[2].z));
  if (farthest <= 0) return;
  double slack = double(list_slack.x);
  if (nearest > 0) slack += double(list_slack.y) / nearest;
  slack = min(slack, side);

  // Beside the image on one side of it, wherever it is along the rays.
  bvec4 beside = bvec4(true);
  for (int k = 0; k < 3; ++k) {
    double less = slack * h[k].z, more = (side + slack) * h[k].z;
    beside = bvec4(beside.x && h[k].x < -less, beside.y && h[k].y < -less, beside.z && h[k].x > more,
                   beside.w && h[k].y > more);
  }
  if (any(beside)) return;

  low = dvec2(0);
  high = dvec2(side);
  if (nearest > 0) {
    dvec2 a = h[0].xy / h[0].z, b = h[1].xy / h[1].z, c = h[2].xy / h[2].z;
    low = max(low, floor(min(a, min(b, c)) - slack));
    high = min(high, floor(max(a, max(b, c)) + slack) + 1);
  }
  if (low.x >= high.x || low.y >= high.y) return;

  double turn = dot(h[0], cross(h[1], h[2])) < 0 ? -1 : 1;
  for (int k = 0; k < 3; ++k) {
    dvec3 e = turn * cross(h[k], h[(k + 1) % 3]);
    double size = abs(e.x) + abs(e.y);
    // Of a place relative to the box's corner. An edge without a direction bounds nothing.
    edges[k] = size > 0 ? vec3(e.xy / size, (e.z + dot(e.xy, low)) / size + 0.5 + slack) : vec3(0, 0, 1);
  }
  give(vec2(low));
  give(vec2(high.x, low.y));
  give(vec2(low.x, high.y));
  give(vec2(high));
  EndPrimitive();
}
)";

constexpr std::string_view touch_fragment = R"(
layout(binding = 0, r32ui) uniform uimage2DArray list_counts;
layout(binding = 1, r32ui) writeonly uniform uimage2DArray list_entries;
uniform int list_layer, list_is_open;
flat in vec3 list_edge_0, list_edge_1, list_edge_2;
flat in vec2 list_corner;
flat in uint list_number;
void main() {
  vec3 at = vec3(gl_FragCoord.xy - list_corner, 1);
  if (dot(list_edge_0, at) < 0 || dot(list_edge_1, at) < 0 || dot(list_edge_2, at) < 0) discard;
  ivec2 texel = ivec2(gl_FragCoord.xy);
  ivec3 count = ivec3(texel, list_layer);
  if (list_is_open != 0) imageAtomicOr(list_counts, count, 0x80000000u);
  uint place = imageAtomicAdd(list_counts, count, 1u);
  if (place >= uint(LIST_LENGTH)) return;
  imageStore(list_entries, ivec3(texel, list_layer * LIST_LENGTH + int(place)), uvec4(list_number));
}
)";

// By insertion: lists are short.
constexpr std::string_view sort_source = R"(
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, r32ui) readonly uniform uimage2DArray list_counts;
layout(binding = 1, r32ui) uniform uimage2DArray list_entries;
layout(std430, binding = 0) buffer Totals { uint entries; uint full_texels; uint longest; };
void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (any(greaterThanEqual(texel.xy, imageSize(list_counts).xy))) return;
  uint count = imageLoad(list_counts, texel).r;
  if (count == 0u) return;
  atomicMax(longest, count & 0x7fffffffu);
  if (count > uint(LIST_LENGTH)) {
    atomicAdd(full_texels, 1u);
    return;
  }
  atomicAdd(entries, count);
  int first = texel.z * LIST_LENGTH;
  for (int i = 1; i < int(count); ++i) {
    uint number = imageLoad(list_entries, ivec3(texel.xy, first + i)).r;
    int place = i;
    for (; place > 0; --place) {
      uint before = imageLoad(list_entries, ivec3(texel.xy, first + place - 1)).r;
      if (before <= number) break;
      imageStore(list_entries, ivec3(texel.xy, first + place), uvec4(before));
    }
    imageStore(list_entries, ivec3(texel.xy, first + place), uvec4(number));
  }
}
)";

/// How generous lists are, in texels, and in texels at axis distance 1. A place is off by float32 rounding of its two products,
/// for the triangle and for the point, and by that of the point, of the corners, of their difference to the light and of the
/// offset that a segment starts with; edges of boxes of up to 8192 texels round by less than 2^-8.
glm::vec2 slack_of(const LightCamera& camera, const LightImage& image) {
  const double far_off = camera.resolution + std::max(std::abs(image.offset.x), std::abs(image.offset.y));
  const double fixed = 0x1p-7 + 0x1p-21 * far_off, moved = 4 * camera.rounding * std::max(image.scale.x, image.scale.y);
  return image.is_perspective ? glm::vec2(fixed, moved) : glm::vec2(fixed + moved, 0);
}

constexpr GLuint sort_group = 8;  ///< texels along each side of a work group

}  // namespace

void ListPrograms::setup(int length) {
  length_ = length;
  const std::string head = fmt::format("#define LIST_LENGTH {}\n", length);
  for (int k = 0; k < 2; ++k)
    touch_[k] =
        Program("triangles to lists", {{GL_VERTEX_SHADER, touch_vertex},
                                       {GL_GEOMETRY_SHADER, fmt::format("#define IS_PARALLEL {}\n{}", 1 - k, touch_geometry)},
                                       {GL_FRAGMENT_SHADER, fmt::format("{}{}", head, touch_fragment)}});
  sort_ = Program::compute("lists in order", fmt::format("{}{}", head, sort_source));
  framebuffer_ = make_framebuffer();
  totals_ = Buffer(nullptr, 3 * sizeof(std::uint32_t), GL_DYNAMIC_STORAGE_BIT);
}

void TriangleLists::draw(const LightCamera& camera, const SceneBuffers& buffers, const ListPrograms& programs) {
  const int side = camera.resolution, layers = std::max(camera.layer_count, 1);
  counts_.fit(GL_R32UI, side, side, layers);
  entries_.fit(GL_R32UI, side, side, layers * programs.length());
  glClearTexImage(counts_.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  glBindImageTexture(0, counts_.name(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
  glBindImageTexture(1, entries_.name(), 0, GL_TRUE, 0, GL_READ_WRITE, GL_R32UI);
  touch(camera, buffers, programs);
  sort(programs);
}

void TriangleLists::touch(const LightCamera& camera, const SceneBuffers& buffers, const ListPrograms& programs) const {
  const GLuint framebuffer = programs.framebuffer_.name();
  glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, camera.resolution);
  glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, camera.resolution);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, camera.resolution, camera.resolution);
  const Program& program = programs.touch_[camera.space.is_parallel() ? 0 : 1];
  glUseProgram(program.name());
  glBindVertexArray(buffers.vertex_array.name());
  program.set("list_side", camera.resolution);
  for (const LightImage& image : camera.images) {
    if (image.layer < 0) continue;
    program.set("list_origin", glm::vec3(image.origin));
    program.set("list_axes", glm::mat3(image.light_from_world));
    program.set("list_window", glm::vec4(image.scale, image.offset));
    program.set("list_slack", slack_of(camera, image));
    program.set("list_layer", image.layer);
    for (const std::uint32_t m : image.casters) {
      const MeshRange& mesh = buffers.meshes[m];
      if (mesh.triangle_count == 0) continue;
      program.set("list_first", static_cast<int>(mesh.first_triangle));
      program.set("list_is_open", static_cast<int>(mesh.has_holes || mesh.lets_through));
      const std::size_t first = std::size_t{mesh.first_triangle} * 3 * sizeof(std::uint32_t);
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(3 * mesh.triangle_count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(first));
    }
  }
  glBindVertexArray(0);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void TriangleLists::sort(const ListPrograms& programs) {
  const GLuint totals = programs.totals_.name();
  glClearNamedBufferData(totals, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, totals);
  glUseProgram(programs.sort_.name());
  const auto groups = (static_cast<GLuint>(counts_.width) + sort_group - 1) / sort_group;
  glDispatchCompute(groups, groups, static_cast<GLuint>(counts_.layers));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  std::array<std::uint32_t, 3> found{};
  glGetNamedBufferSubData(totals, 0, sizeof found, found.data());
  totals_ = {found[0], found[1], found[2]};
}

void TriangleLists::bind(GLuint unit) const {
  glBindTextureUnit(unit, counts_.name());
  glBindTextureUnit(unit + 1, entries_.name());
}

std::vector<std::uint32_t> TriangleLists::read(const Texture& texture) {
  std::vector<std::uint32_t> values(texture.bytes / sizeof(std::uint32_t));
  glGetTextureImage(texture.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(texture.bytes), values.data());
  return values;
}

}  // namespace gnomon::triangle_map
