// What is drawn of shadow volumes, written to buffers.
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/volumes/volume_faces.h>

#include <algorithm>
#include <tuple>

namespace gnomon {

namespace {

constexpr std::size_t face_block = std::size_t{1} << 15;

/// How many triangles have key 1, and how many have key 2.
struct KeyCounts {
  std::size_t ones = 0, twos = 0;
};

/// Writes corners(t) of triangles 0 .. count - 1 to a buffer, in order and on all threads: first those with key(t) = 1, behind
/// them those with key(t) = 2; those with key(t) = 0 are left out.
template <class Key, class Corners>
KeyCounts write_in_order(RewrittenBuffer& buffer, std::size_t count, const Key& key, const Corners& corners) {
  std::vector<KeyCounts> before((count + face_block - 1) / face_block + 1);  // each block
  for_blocks(count, face_block, [&](std::size_t begin, std::size_t end) {
    KeyCounts found;
    for (std::size_t t = begin; t < end; ++t) {
      found.ones += key(t) == 1;
      found.twos += key(t) == 2;
    }
    before[begin / face_block + 1] = found;
  });
  for (std::size_t i = 1; i < before.size(); ++i) {
    before[i].ones += before[i - 1].ones;
    before[i].twos += before[i - 1].twos;
  }
  const KeyCounts all = before.back();
  buffer.rewrite<glm::uvec3>(all.ones + all.twos, [&](std::span<glm::uvec3> out) {
    for_blocks(count, face_block, [&](std::size_t begin, std::size_t end) {
      auto [one, two] = before[begin / face_block];
      two += all.ones;
      for (std::size_t t = begin; t < end; ++t)
        if (const int k = key(t)) out[k == 1 ? one++ : two++] = corners(t);
    });
  });
  return all;
}

/// Whether sides at an edge begin at its higher end. Two volumes that share a side must begin it at one place, so that they
/// cover the same pixels: at the same vertex, or where several vertices may be at one position, at the same position.
bool begins_high(const EdgeAdjacency& adjacency, const SilhouetteEdge& edge) {
  if (!adjacency.has_meeting_vertices()) return false;
  const glm::vec3 &low = adjacency.positions()[edge.low], &high = adjacency.positions()[edge.high];
  return std::tie(high.x, high.y, high.z) < std::tie(low.x, low.y, low.z);
}

/// A side for every volume that starts at an edge.
void write_sides(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted, FaceBuffers& faces,
                 FaceCommands& commands) {
  std::size_t copies = 0;
  for (const SilhouetteEdge& edge : silhouette.edges) copies += std::abs(edge.count);
  faces.sides.rewrite<glm::uvec4>(copies, [&](std::span<glm::uvec4> sides) {
    std::size_t place = 0;
    for (const SilhouetteEdge& edge : silhouette.edges) {
      const bool is_turned = begins_high(adjacency, edge);
      const glm::uvec4 side(is_turned ? edge.high : edge.low, is_turned ? edge.low : edge.high, edge.part,
                            (edge.count > 0) != is_turned);
      for (int i = 0; i < std::abs(edge.count); ++i) sides[place++] = side;
    }
  });
  commands.sides.count = static_cast<std::uint32_t>(copies * (wanted.are_pointed(silhouette.light) ? 3 : 6));
  if (wanted.dark_caps) commands.fan.count = static_cast<std::uint32_t>(copies * 3);
}

/// Triangles turned to the light: every one that takes part, or with an outline those of parts without a fan.
void write_turned_triangles(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted,
                            FaceBuffers& faces, FaceCommands& commands) {
  const glm::dvec4& light = silhouette.light;
  std::vector<std::uint8_t> without_fan;
  for (const EdgeAdjacency::Part& part : adjacency.parts()) without_fan.push_back(!has_hub(part, light));
  if (wanted.outline && !(wanted.dark_caps && std::ranges::find(without_fan, 1) != without_fan.end())) return;
  const auto& facing = silhouette.facing;
  const auto first = adjacency.first_at_position();
  const auto key = [&](std::size_t t) {
    return facing[t] != 0 && (!wanted.outline || without_fan[adjacency.part_of()[t]]) ? 1 : 0;
  };
  const KeyCounts written = write_in_order(faces.triangles, facing.size(), key, [&](std::size_t t) {
    glm::uvec3 v = adjacency.triangles()[t];
    if (facing[t] < 0) std::swap(v.y, v.z);
    return glm::uvec3(first[v.x], first[v.y], first[v.z]);
  });
  const auto count = static_cast<std::uint32_t>(written.ones);
  if (!wanted.outline) commands.triangle_sides.count = (wanted.are_pointed(light) ? 9 : 18) * count;
  if (wanted.dark_caps) commands.far_triangles.count = 3 * count;
}

/// The counter-clockwise triangles, then the clockwise ones.
void write_light_caps(const EdgeAdjacency& adjacency, const Silhouette& silhouette, FaceBuffers& faces,
                      FaceCommands& commands) {
  const std::span<const std::int8_t> facing = silhouette.facing;
  const auto key = [&](std::size_t t) { return facing[t] < 0 ? 2 : int(facing[t]); };
  const auto [up, down] =
      write_in_order(faces.caps, facing.size(), key, [&](std::size_t t) { return adjacency.triangles()[t]; });
  commands.caps.count = static_cast<std::uint32_t>(3 * up);
  commands.reversed_caps.first_index = commands.caps.count;
  commands.reversed_caps.count = static_cast<std::uint32_t>(3 * down);
}

/// Triangles begin <= t < end that face the light one way, and their places.
struct CapRun {
  int turn = 1;
  std::size_t begin = 0, end = 0, place = 0, count = 0;
};

void write_run(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const CapRun& run, RewrittenBuffer& caps) {
  caps.rewrite_part<glm::uvec3>(run.place, run.count, [&](std::span<glm::uvec3> out) {
    std::size_t at = 0;
    for (std::size_t t = run.begin; t < run.end; ++t)
      if (silhouette.facing[t] == run.turn) out[at++] = adjacency.triangles()[t];
  });
}

/// The same as write_light_caps over what that wrote before. A triangle before the first that changed its facing keeps its
/// place, and one behind the last where as many face the light as before.
void rewrite_light_caps(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const Refaced& refaced,
                        FaceBuffers& faces, FaceCommands& commands) {
  if (refaced.empty()) return;
  const std::span<const std::int8_t> facing = silhouette.facing;
  const auto count = [&](int turn, std::size_t begin, std::size_t end) {
    return static_cast<std::size_t>(std::ranges::count(facing.subspan(begin, end - begin), static_cast<std::int8_t>(turn)));
  };
  const std::size_t up = count(1, 0, facing.size()), down = count(-1, 0, facing.size());
  const std::size_t up_before = commands.caps.count / 3, down_before = commands.reversed_caps.count / 3;
  if (!faces.caps.resize((up + down) * sizeof(glm::uvec3))) return write_light_caps(adjacency, silhouette, faces, commands);
  const auto run_of = [&](int turn, std::size_t first_place, bool keeps_first, bool keeps_last) {
    const std::size_t begin = keeps_first ? refaced.first : 0, end = keeps_first && keeps_last ? refaced.end : facing.size();
    return CapRun{turn, begin, end, first_place + count(turn, 0, begin), count(turn, begin, end)};
  };
  write_run(adjacency, silhouette, run_of(1, 0, true, up == up_before), faces.caps);
  write_run(adjacency, silhouette, run_of(-1, up, up == up_before, down == down_before), faces.caps);
  commands.caps.count = static_cast<std::uint32_t>(3 * up);
  commands.reversed_caps.first_index = commands.caps.count;
  commands.reversed_caps.count = static_cast<std::uint32_t>(3 * down);
}

}  // namespace

void RewrittenBuffer::reserve(std::size_t bytes) {
  bytes_ = bytes;
  if (buffer_ && buffer_.bytes >= bytes) return;
  buffer_ = {};
  buffer_ = Buffer(nullptr, bytes + bytes / 4, GL_MAP_WRITE_BIT | GL_MAP_READ_BIT | GL_DYNAMIC_STORAGE_BIT);
}

bool RewrittenBuffer::resize(std::size_t bytes) {
  if (!buffer_ || buffer_.bytes < bytes) return false;
  bytes_ = bytes;
  return true;
}

void* RewrittenBuffer::map(std::size_t first, std::size_t bytes, GLbitfield loses) {
  void* const data = glMapNamedBufferRange(buffer_.name(), static_cast<GLintptr>(first), static_cast<GLsizeiptr>(bytes),
                                           GL_MAP_WRITE_BIT | loses);
  if (!data) throw Error("a buffer of {} bytes cannot be mapped", bytes);
  return data;
}

void RewrittenBuffer::unmap() { glUnmapNamedBuffer(buffer_.name()); }

void write_hubs(const EdgeAdjacency& adjacency, const glm::dvec4& light, const FarPlanes* ends, FaceBuffers& faces) {
  faces.hubs.rewrite<glm::vec4>(std::max<std::size_t>(adjacency.parts().size(), 1), [&](std::span<glm::vec4> hubs) {
    for (std::size_t i = 0; i < adjacency.parts().size(); ++i) {
      const EdgeAdjacency::Part& part = adjacency.parts()[i];
      const std::optional<int> plane = ends ? ends->end_of(part, light) : std::nullopt;
      const int end = !has_hub(part, light) ? 0 : plane ? 2 + *plane : 1;
      hubs[i] = end == 0 ? glm::vec4(0) : glm::vec4((part.bounds.min + part.bounds.max) / 2.0f, end);
    }
  });
}

FaceCommands write_faces(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted,
                         FaceBuffers& faces) {
  FaceCommands commands;
  faces.clear();
  write_hubs(adjacency, silhouette.light, wanted.ends, faces);
  if (wanted.outline) write_sides(adjacency, silhouette, wanted, faces, commands);
  write_turned_triangles(adjacency, silhouette, wanted, faces, commands);
  if (wanted.light_caps) write_light_caps(adjacency, silhouette, faces, commands);
  faces.commands.rewrite<FaceCommands>(1, [&](std::span<FaceCommands> mapped) { mapped[0] = commands; });
  return commands;
}

FaceCommands rewrite_faces(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const WantedFaces& wanted,
                           const Refaced& refaced, const FaceCommands& before, FaceBuffers& faces) {
  FaceCommands commands;
  commands.caps = before.caps;
  commands.reversed_caps = before.reversed_caps;
  faces.sides.clear();
  faces.triangles.clear();
  write_hubs(adjacency, silhouette.light, wanted.ends, faces);
  if (wanted.outline) write_sides(adjacency, silhouette, wanted, faces, commands);
  write_turned_triangles(adjacency, silhouette, wanted, faces, commands);
  if (wanted.light_caps) rewrite_light_caps(adjacency, silhouette, refaced, faces, commands);
  faces.commands.rewrite<FaceCommands>(1, [&](std::span<FaceCommands> mapped) { mapped[0] = commands; });
  return commands;
}

}  // namespace gnomon
