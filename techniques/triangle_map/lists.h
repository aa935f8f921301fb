#pragma once
#include <gnomon/kit/maps/light_map.h>

#include <array>
#include <vector>

namespace gnomon::triangle_map {

/// Programs that make lists; one set serves all lights.
class ListPrograms {
 public:
  /// For lists of up to `length` triangles, at least one. Compiles; needs the context.
  void setup(int length);
  int length() const { return length_; }

 private:
  friend class TriangleLists;
  int length_ = 0;
  std::array<Program, 2> touch_;  // parallel rays, and rays from a center
  Program sort_;
  Framebuffer framebuffer_;
  Buffer totals_;
};

/// Of all texels together.
struct ListTotals {
  std::uint32_t entries = 0;      ///< of the lists that are whole
  std::uint32_t full_texels = 0;  ///< whose list is not whole
  std::uint32_t longest = 0;      ///< triangles that touch one texel, listed or not
};

/// For each texel of a light's images the triangles that touch it, at any depth and whichever way they face, by their numbers
/// in the scene. What touches is found generously, for look-ups and rasterizers round: a list may hold a triangle that passes
/// by at a hundredth of a texel, and lacks none that a segment to the light through the texel meets.
///
/// Where more triangles touch a texel than a list holds, and where one of them has holes or lets light through, the list is not
/// whole and means nothing. Whole lists are sorted: the order of atomics is no order.
class TriangleLists {
 public:
  /// Of the casters of the camera's images, none of which is warped.
  void draw(const LightCamera& camera, const SceneBuffers& buffers, const ListPrograms& programs);
  /// Counts to a texture unit and entries to the next one: R32UI, one layer an image, and `length` layers an image.
  void bind(GLuint unit) const;
  const ListTotals& totals() const { return totals_; }
  std::size_t bytes() const { return counts_.bytes + entries_.bytes; }  ///< 4 (length + 1) a texel
  void release() { *this = {}; }

  /// For tests, read back: counts of all texels, row after row, layer after layer, and the layers of entries. The highest bit
  /// of a count is set where one of the triangles has holes or lets light through.
  std::vector<std::uint32_t> counts() const { return read(counts_); }
  std::vector<std::uint32_t> entries() const { return read(entries_); }

 private:
  static std::vector<std::uint32_t> read(const Texture& texture);
  void touch(const LightCamera& camera, const SceneBuffers& buffers, const ListPrograms& programs) const;
  void sort(const ListPrograms& programs);

  Texture counts_, entries_;
  ListTotals totals_;
};

}  // namespace gnomon::triangle_map
