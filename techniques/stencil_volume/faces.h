#pragma once
#include <gnomon/kit/edges.h>
#include <gnomon/kit/gl.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <vector>

namespace stencil_volume {
using namespace gnomon;

struct DrawArrays {
  std::uint32_t count = 0, instances = 1, first = 0, base_instance = 0;
};
struct DrawElements {
  std::uint32_t count = 0, instances = 1, first_index = 0, base_vertex = 0, base_instance = 0;
};
/// What is drawn, as the device reads it. Compute shaders count in a copy, which is read back: the bound on overlaps needs the
/// outline.
struct Commands {
  DrawArrays sides;            ///< side quads of the outline
  DrawArrays fan;              ///< dark caps over the outline
  DrawArrays triangle_sides;   ///< side quads triangle by triangle
  DrawArrays far_triangles;    ///< dark caps triangle by triangle
  DrawElements caps;           ///< light caps, counter-clockwise seen from the light
  DrawElements reversed_caps;  ///< clockwise
};

/// A buffer that is written anew by every light, and grows when it must.
class RewrittenBuffer {
 public:
  /// Makes room for `count` elements of T, and calls fill(span<T>) on the mapped memory, whose old contents are gone.
  template <class T, class Fill>
  void rewrite(std::size_t count, Fill&& fill) {
    reserve(count * sizeof(T));
    if (count == 0) return;
    auto* const data = static_cast<T*>(glMapNamedBufferRange(buffer_.name(), 0, static_cast<GLsizeiptr>(count * sizeof(T)),
                                                             GL_MAP_WRITE_BIT | GL_MAP_INVALIDATE_BUFFER_BIT));
    if (!data) throw Error("a buffer of {} bytes cannot be mapped", count * sizeof(T));
    fill(std::span<T>(data, count));
    glUnmapNamedBuffer(buffer_.name());
  }
  void reserve(std::size_t bytes) {
    if (buffer_ && buffer_.bytes >= bytes) return;
    buffer_ = {};
    buffer_ = Buffer(nullptr, bytes + bytes / 4, GL_MAP_WRITE_BIT | GL_MAP_READ_BIT | GL_DYNAMIC_STORAGE_BIT);
  }
  void drop() { buffer_ = {}; }
  GLuint name() const { return buffer_.name(); }
  std::size_t bytes() const { return buffer_.bytes; }

 private:
  Buffer buffer_;
};

/// The faces of all volumes under one light, on the device.
struct Faces {
  RewrittenBuffer sides, triangles, caps, hubs, commands;
  std::size_t bytes() const { return sides.bytes() + triangles.bytes() + caps.bytes() + hubs.bytes() + commands.bytes(); }
};

/// What relight is to make. A hub is the point that the fan of a part turns about.
struct Wanted {
  bool outline = true;     ///< side quads of the outline, else of every triangle
  bool light_caps = true;  ///< for z-fail, and for the near cap of ZP+
  bool dark_caps = true;   ///< for z-fail under a light at a finite point
};

/// Whether the dark cap of a part can be a fan about the middle of its bounds: only if the light lies outside, since then no
/// caster lies in the opposite direction, where fans and caps would disagree.
inline bool has_hub(const EdgeAdjacency::Part& part, const glm::dvec4& light) {
  const glm::dvec3 position = glm::dvec3(light) / light.w;
  return glm::any(glm::lessThan(position, glm::dvec3(part.bounds.min))) ||
         glm::any(glm::greaterThan(position, glm::dvec3(part.bounds.max)));
}

inline void write_hubs(const EdgeAdjacency& adjacency, const glm::dvec4& light, Faces& faces) {
  faces.hubs.rewrite<glm::vec4>(std::max<std::size_t>(adjacency.parts().size(), 1), [&](std::span<glm::vec4> hubs) {
    for (std::size_t i = 0; i < adjacency.parts().size(); ++i) {
      const EdgeAdjacency::Part& part = adjacency.parts()[i];
      const bool fan = light.w != 0 && has_hub(part, light);
      hubs[i] = fan ? glm::vec4((part.bounds.min + part.bounds.max) / 2.0f, 1) : glm::vec4(0);
    }
  });
}

/// Writes, in order and on all threads, the triangles t of 0 .. count that `wants`: write(t, place) with places from 0 up.
/// Returns how many. `made(n)` is called once before the first is written.
template <class Wants, class Made, class Write>
std::size_t compact(std::size_t count, const Wants& wants, const Made& made, const Write& write) {
  constexpr std::size_t block = std::size_t{1} << 15;
  std::vector<std::size_t> first((count + block - 1) / block + 1, 0);
  for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t t = begin; t < end; ++t) found += wants(t);
    first[begin / block + 1] = found;
  });
  for (std::size_t i = 1; i < first.size(); ++i) first[i] += first[i - 1];
  made(first.back(), [&] {
    for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
      std::size_t place = first[begin / block];
      for (std::size_t t = begin; t < end; ++t)
        if (wants(t)) write(t, place++);
    });
  });
  return first.back();
}

/// Triangles of the light caps, in the vertex order of their meshes: the counter-clockwise ones, then the clockwise ones.
inline void write_caps(const EdgeAdjacency& adjacency, const Silhouette& silhouette, Faces& faces, Commands& commands) {
  constexpr std::size_t block = std::size_t{1} << 15;
  const std::span<const std::int8_t> facing = silhouette.facing;
  struct Places {
    std::size_t up = 0, down = 0;
  };
  std::vector<Places> first(facing.size() / block + 2);
  for_blocks(facing.size(), block, [&](std::size_t begin, std::size_t end) {
    Places found;
    for (std::size_t t = begin; t < end; ++t) found.up += facing[t] > 0, found.down += facing[t] < 0;
    first[begin / block + 1] = found;
  });
  for (std::size_t i = 1; i < first.size(); ++i) first[i].up += first[i - 1].up, first[i].down += first[i - 1].down;
  const std::size_t up = first.back().up, down = first.back().down;
  faces.caps.rewrite<glm::uvec3>(up + down, [&](std::span<glm::uvec3> caps) {
    const std::span<const glm::uvec3> triangles = adjacency.triangles();
    for_blocks(facing.size(), block, [&](std::size_t begin, std::size_t end) {
      Places place = first[begin / block];
      place.down += up;
      for (std::size_t t = begin; t < end; ++t)
        if (facing[t] != 0) caps[facing[t] > 0 ? place.up++ : place.down++] = triangles[t];
    });
  });
  commands.caps.count = static_cast<std::uint32_t>(3 * up);
  commands.reversed_caps.first_index = commands.caps.count;
  commands.reversed_caps.count = static_cast<std::uint32_t>(3 * down);
}

/// Fills all buffers from a silhouette found by the processor.
inline Commands write_faces(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const Wanted& wanted, Faces& faces) {
  Commands commands;
  const glm::dvec4& light = silhouette.light;
  const std::uint32_t side_corners = light.w != 0 ? 6 : 3;
  const auto& facing = silhouette.facing;
  write_hubs(adjacency, light, faces);

  if (wanted.outline) {
    std::size_t copies = 0;
    for (const SilhouetteEdge& edge : silhouette.edges) copies += std::abs(edge.count);
    faces.sides.rewrite<glm::uvec4>(copies, [&](std::span<glm::uvec4> sides) {
      std::size_t place = 0;
      for (const SilhouetteEdge& edge : silhouette.edges)
        for (int i = 0; i < std::abs(edge.count); ++i) sides[place++] = {edge.low, edge.high, edge.part, edge.count > 0};
    });
    commands.sides.count = static_cast<std::uint32_t>(copies * side_corners);
    if (wanted.dark_caps) commands.fan.count = static_cast<std::uint32_t>(copies * 3);
  }

  // Triangles turned to the light: every one that takes part, or those whose part has no fan.
  std::vector<std::uint8_t> without_fan;
  for (const EdgeAdjacency::Part& part : adjacency.parts()) without_fan.push_back(light.w != 0 && !has_hub(part, light));
  const bool some = !wanted.outline || (wanted.dark_caps && std::ranges::find(without_fan, 1) != without_fan.end());
  if (some) {
    const auto wants = [&](std::size_t t) {
      return facing[t] != 0 && (!wanted.outline || without_fan[adjacency.part_of()[t]]);
    };
    std::span<glm::uvec3> out;
    const auto first = adjacency.first_at_position();
    const std::size_t count = compact(
        facing.size(), wants,
        [&](std::size_t n, auto&& go) {
          faces.triangles.rewrite<glm::uvec3>(n, [&](std::span<glm::uvec3> mapped) { out = mapped, go(); });
        },
        [&](std::size_t t, std::size_t place) {
          glm::uvec3 v = adjacency.triangles()[t];
          if (facing[t] < 0) std::swap(v.y, v.z);
          out[place] = {first[v.x], first[v.y], first[v.z]};
        });
    if (!wanted.outline) commands.triangle_sides.count = static_cast<std::uint32_t>(3 * side_corners * count);
    if (wanted.dark_caps) commands.far_triangles.count = static_cast<std::uint32_t>(3 * count);
  }

  if (wanted.light_caps) write_caps(adjacency, silhouette, faces, commands);
  faces.commands.rewrite<Commands>(1, [&](std::span<Commands> mapped) { mapped[0] = commands; });
  return commands;
}

}  // namespace stencil_volume
