#pragma once
#include <gnomon/kit/maps/glass_map.h>
#include <gnomon/kit/parallel.h>

#include "curve.h"

namespace gnomon::transmittance_map {

/// The curves of all texels of a light's images, one behind the other in a storage buffer.
///
/// Glass is drawn twice: the first pass counts the surfaces of each texel, the second writes each to its place in the list of
/// its texel. So lists are exactly as long as they have to be, at any depth complexity, where linked lists would need a pool
/// whose size is guessed, and a second draw when the guess was low. The order in a list is that of arrival, another one each
/// time; lists are therefore sorted before anything else. Sorting and reduction are done by the processor, on all threads, in
/// the very code that the tests check: under llvmpipe the memory is the same anyway, a graphics card pays for the way there and
/// back.
class TexelCurves {
 public:
  /// GLSL: GlassMap::Method::draw.
  static constexpr std::string_view draw_snippet = R"(
layout(std430, binding = 4) buffer SurfaceCounts { uint surface_counts[]; };
layout(std430, binding = 5) writeonly buffer Surfaces { vec2 surfaces[]; };
uniform int curve_layer, curve_side, curves_are_counted;
void draw_glass(float t, float transmission) {
  uint texel = (uint(curve_layer) * uint(curve_side) + uint(gl_FragCoord.y)) * uint(curve_side) + uint(gl_FragCoord.x);
  uint place = atomicAdd(surface_counts[texel], 1u);
  if (curves_are_counted != 0) surfaces[place] = vec2(t, transmission);
}
)";
  /// GLSL: GlassMap::Method::share, with the constant `float curve_has_lines`, 1 or 0.
  static constexpr std::string_view share_snippet = R"(
layout(std430, binding = 4) readonly buffer CurveEnds { uint curve_ends[]; };
layout(std430, binding = 5) readonly buffer CurveNodes { vec2 curve_nodes[]; };
float glass_at(ivec3 texel, float t) {
  uint side = uint(textureSize(light_map, 0).x);
  uint index = (uint(texel.z) * side + uint(texel.y)) * side + uint(texel.x);
  uint first = index > 0u ? curve_ends[index - 1u] : 0u, end = curve_ends[index], low = first, high = end;
  // The first node that is not nearer than t.
  while (low < high) {
    uint middle = (low + high) / 2u;
    if (curve_nodes[middle].x < t) {
      low = middle + 1u;
    } else {
      high = middle;
    }
  }
  if (low == first) return 1;
  vec2 last = curve_nodes[low - 1u];
  if (curve_has_lines < 0.5 || low == end) return last.y;
  vec2 next = curve_nodes[low];
  return last.y + (next.y - last.y) * ((t - last.x) / (next.x - last.x));
}
)";
  /// What the two snippets need: a list's place and end for each texel of so many images.
  static GlLimits needs() { return {.fragment_storage_blocks = 2, .storage_bindings = 6}; }

  /// Throws Error where more surfaces, or nodes, come than a storage block of the device holds. `who` is the technique, for the
  /// error.
  void draw(const GlassDrawing& glass, const Keep& keep, std::string_view who) {
    release();
    who_ = who;
    const std::size_t side = static_cast<std::size_t>(glass.resolution()), texels = side * side * glass.layer_count();
    require(texels * sizeof(std::uint32_t), texels, "texels");
    ends_ = Buffer(nullptr, texels * sizeof(std::uint32_t), GL_DYNAMIC_STORAGE_BIT);
    glClearNamedBufferData(ends_.name(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
    pass(glass, false);
    std::vector<std::uint32_t> firsts = read<std::uint32_t>(ends_, texels);
    std::uint64_t sum = 0;
    for (std::uint32_t& first : firsts) {
      const std::uint32_t count = first;
      first = static_cast<std::uint32_t>(sum);
      sum += count;
      longest_ = std::max(longest_, count);
    }
    surface_count_ = sum;
    require(sum * sizeof(Surface), sum, "surfaces of glass");
    write(ends_, firsts);
    const Buffer buffer(nullptr, sum * sizeof(Surface));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, buffer.name());
    pass(glass, true);
    std::vector<Surface> surfaces = read<Surface>(buffer, sum);
    reduce(keep, firsts, surfaces);
  }

  void bind() const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, ends_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, nodes_.name());
  }
  void release() { *this = {}; }

  std::size_t bytes() const { return ends_.bytes + nodes_.bytes; }
  std::uint64_t surface_count() const { return surface_count_; }  ///< on the rays of all texels
  std::uint64_t node_count() const { return nodes_.bytes / sizeof(Node); }
  std::uint32_t longest() const { return longest_; }  ///< surfaces on the ray of a texel
  /// The end of each texel's curve among all nodes, row after row, layer after layer; empty where nothing was drawn. Read back.
  std::vector<std::uint32_t> ends() const {
    return ends_ ? read<std::uint32_t>(ends_, ends_.bytes / 4) : std::vector<std::uint32_t>();
  }

 private:
  static constexpr std::size_t block = 4096;  ///< texels

  template <class T>
  static std::vector<T> read(const Buffer& buffer, std::size_t count) {
    std::vector<T> values(count);
    if (count > 0) glGetNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(count * sizeof(T)), values.data());
    return values;
  }
  static void write(const Buffer& buffer, std::span<const std::uint32_t> values) {
    glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size_bytes()), values.data());
  }
  void require(std::size_t bytes, std::uint64_t count, std::string_view what) const {
    const GlLimits* const limits = gl_limits();
    if (limits && bytes > static_cast<std::size_t>(limits->storage_block_bytes))
      throw Error("{}: {} {} take {} bytes; the OpenGL device has storage_block_bytes = {}; a lower resolution needs fewer",
                  who_, count, what, bytes, limits->storage_block_bytes);
  }

  /// Counts surfaces into ends_, or writes them to where that says, which then becomes the end of each list.
  void pass(const GlassDrawing& glass, bool are_counted) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, ends_.name());
    glass.set("curve_side", glass.resolution());
    glass.set("curves_are_counted", static_cast<int>(are_counted));
    glass.each_image([&](const LightImage& image) {
      glass.set("curve_layer", image.layer);
      glass.draw(image);
    });
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  }

  /// Makes the curves of the lists, block by block of texels, and uploads them one behind the other.
  void reduce(const Keep& keep, std::span<const std::uint32_t> firsts, std::span<Surface> surfaces) {
    const std::size_t texels = firsts.size(), blocks = (texels + block - 1) / block;
    std::vector<std::vector<Node>> parts(blocks);
    std::vector<std::uint32_t> ends(texels);
    for_blocks(texels, block, [&](std::size_t begin, std::size_t end) {
      std::vector<Node>& part = parts[begin / block];
      CurveMaker maker(keep);
      for (std::size_t i = begin; i < end; ++i) {
        const std::size_t list_end = i + 1 < texels ? firsts[i + 1] : surfaces.size();
        const std::span<const Node> nodes = maker.make(surfaces.subspan(firsts[i], list_end - firsts[i]));
        part.insert(part.end(), nodes.begin(), nodes.end());
        ends[i] = static_cast<std::uint32_t>(part.size());
      }
    });
    std::vector<Node> nodes;
    for (std::size_t b = 0; b < blocks; ++b) {
      const auto before = static_cast<std::uint32_t>(nodes.size());
      for (std::size_t i = b * block; i < std::min(texels, (b + 1) * block); ++i) ends[i] += before;
      nodes.insert(nodes.end(), parts[b].begin(), parts[b].end());
      parts[b] = {};
    }
    require(nodes.size() * sizeof(Node), nodes.size(), "nodes");
    write(ends_, ends);
    nodes_ = Buffer(nodes.data(), nodes.size() * sizeof(Node));
  }

  std::string who_;
  Buffer ends_, nodes_;
  std::uint64_t surface_count_ = 0;
  std::uint32_t longest_ = 0;
};

}  // namespace gnomon::transmittance_map
