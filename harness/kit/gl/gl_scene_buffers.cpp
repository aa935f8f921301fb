#include "kit/gl/gl_scene_buffers.h"

#include <bit>
#include <cassert>
#include <cstring>

#include "kit/gl/gl_masks.h"

namespace gnomon {

namespace {

/// A hash of words, one after the other.
struct Mixed {
  std::uint64_t hash = 0xcbf29ce484222325u;
  void add(std::uint64_t value) { hash = (hash ^ value) * 0x100000001b3u ^ hash >> 29; }
  void add(const void* address) { add(std::bit_cast<std::uintptr_t>(address)); }
};

std::size_t vertex_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.positions.size();
  return count;
}

/// All vertices, mesh after mesh.
UnsetVector<glm::vec3> positions_of(const Scene& scene) {
  UnsetVector<glm::vec3> positions(vertex_count(scene));
  auto end = positions.begin();
  for (const Mesh& mesh : scene.meshes) end = std::ranges::copy(mesh.positions, end).out;
  return positions;
}

bool have_same_bits(const glm::vec3& a, const glm::vec3& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// Of vertices first .. end - 1.
struct VertexRange {
  std::size_t first = 0, end = 0;
};

/// The smallest range that holds all that differ; empty where none does.
VertexRange differing(std::span<const glm::vec3> before, std::span<const glm::vec3> now) {
  if (now.empty() || std::memcmp(before.data(), now.data(), now.size_bytes()) == 0) return {};
  VertexRange range{0, now.size()};
  while (have_same_bits(before[range.first], now[range.first])) ++range.first;
  while (have_same_bits(before[range.end - 1], now[range.end - 1])) --range.end;
  return range;
}

}  // namespace

SceneStamp::SceneStamp(const Scene& scene) : pose_number(scene.pose_number) {
  Mixed what, where;
  what.add(&scene);
  what.add(scene.meshes.size());
  what.add(scene.motion != nullptr);
  // At most 32 meshes: timed stages compute this, too.
  const std::size_t step = scene.meshes.size() / 32 + 1;
  for (std::size_t m = 0; m < scene.meshes.size(); m += step) {
    const Mesh& mesh = scene.meshes[m];
    what.add(mesh.positions.data());
    what.add(mesh.triangles.data());
    what.add(mesh.positions.size());
    what.add(mesh.triangles.size());
    what.add(mesh.casts * 4 + mesh.receives * 2 + mesh.seen);
    what.add(mesh.alpha_mask.get());
    what.add(mesh.transmission.get());
    what.add(mesh.uv.data());
    if (!mesh.triangles.empty()) {
      const glm::uvec3& t = mesh.triangles[mesh.triangles.size() / 2];
      for (int k = 0; k < 3; ++k) what.add(t[k]);
    }
    where.add(mesh.has_curved_shape());
    if (mesh.positions.empty()) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const glm::vec3& p = mesh.positions[(mesh.positions.size() - 1) * k / 3];
      for (int i = 0; i < 3; ++i) where.add(std::bit_cast<std::uint32_t>(p[i]));
    }
  }
  identity = what.hash;
  sample = where.hash;
}

SceneBuffers upload_scene(const Scene& scene, UploadedPositions& uploaded) {
  SceneBuffers buffers;
  std::size_t vertices = 0, triangles = 0;
  for (const Mesh& mesh : scene.meshes) {
    buffers.meshes.push_back({static_cast<std::uint32_t>(vertices), static_cast<std::uint32_t>(triangles),
                              static_cast<std::uint32_t>(mesh.triangles.size()), mesh.casts, mesh.receives,
                              mesh.alpha_mask != nullptr, mesh.transmission != nullptr});
    vertices += mesh.positions.size();
    triangles += mesh.triangles.size();
  }
  UnsetVector<glm::vec3> positions = positions_of(scene);
  UnsetVector<glm::uvec3> corners(triangles);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const MeshRange& range = buffers.meshes[m];
    std::ranges::transform(scene.meshes[m].triangles, corners.begin() + range.first_triangle,
                           [&](const glm::uvec3& t) { return t + range.first_vertex; });
  }
  // Drivers may keep what can be written again in slower memory.
  const GLbitfield flags = scene.motion ? GL_DYNAMIC_STORAGE_BIT : 0;
  buffers.positions = Buffer(positions.data(), positions.size() * sizeof(glm::vec3), flags);
  uploaded = scene.motion ? std::move(positions) : UploadedPositions();
  buffers.triangles = Buffer(corners.data(), corners.size() * sizeof(glm::uvec3));
  buffers.vertex_array = make_vertex_array();
  const GLuint vao = buffers.vertex_array.name();
  glVertexArrayVertexBuffer(vao, 0, buffers.positions.name(), 0, sizeof(glm::vec3));
  glVertexArrayAttribFormat(vao, 0, 3, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vao, 0, 0);
  glEnableVertexArrayAttrib(vao, 0);
  glVertexArrayElementBuffer(vao, buffers.triangles.name());
  buffers.bytes = buffers.positions.bytes + buffers.triangles.bytes;
  upload_masks(scene, buffers);
  return buffers;
}

bool can_take_positions(const Scene& scene, const UploadedPositions& uploaded) {
  return scene.motion && uploaded.size() == vertex_count(scene);
}

std::size_t upload_positions(const Scene& scene, const SceneBuffers& buffers, UploadedPositions& uploaded) {
  assert(can_take_positions(scene, uploaded));
  std::size_t bytes = 0;
  VertexRange waiting;  // of all vertices: ranges that touch go up by one call
  const auto upload = [&] {
    const std::size_t size = (waiting.end - waiting.first) * sizeof(glm::vec3);
    if (size == 0) return;
    glNamedBufferSubData(buffers.positions.name(), static_cast<GLintptr>(waiting.first * sizeof(glm::vec3)),
                         static_cast<GLsizeiptr>(size), uploaded.data() + waiting.first);
    bytes += size;
  };
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const std::span<const glm::vec3> now = scene.meshes[m].positions;
    const std::size_t first = buffers.meshes[m].first_vertex;
    const VertexRange range = differing(std::span(uploaded).subspan(first, now.size()), now);
    if (range.first == range.end) continue;
    std::ranges::copy(now.subspan(range.first, range.end - range.first), uploaded.begin() + first + range.first);
    if (waiting.end != first + range.first) {
      upload();
      waiting.first = first + range.first;
    }
    waiting.end = first + range.end;
  }
  upload();
  return bytes;
}

void SceneBuffers::draw(const std::vector<std::uint32_t>& which) const {
  std::vector<GLsizei> counts;
  std::vector<const void*> offsets;
  for (std::size_t i = 0, j; i < which.size(); i = j) {
    const std::uint32_t first = meshes[which[i]].first_triangle;
    std::uint32_t end = first;
    for (j = i; j < which.size() && meshes[which[j]].first_triangle == end; ++j) end += meshes[which[j]].triangle_count;
    counts.push_back(static_cast<GLsizei>(3 * (end - first)));
    offsets.push_back(reinterpret_cast<const void*>(std::uintptr_t(first) * sizeof(glm::uvec3)));
  }
  if (counts.empty()) return;
  glBindVertexArray(vertex_array.name());
  glMultiDrawElements(GL_TRIANGLES, counts.data(), GL_UNSIGNED_INT, offsets.data(), static_cast<GLsizei>(counts.size()));
  glBindVertexArray(0);
}

}  // namespace gnomon
