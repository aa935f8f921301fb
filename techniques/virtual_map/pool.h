#pragma once
#include <gnomon/kit/maps/light_map.h>
#include <gnomon/kit/volumes/volume_faces.h>

#include "draw_lists.h"

namespace gnomon::virtual_map {

/// Where pages lie: side by side in the layers of an array, sixteen in a row of 128.
struct PoolLayout {
  static constexpr int width = 2048, most_height = 8192;  ///< texels of a layer
  int page_size = 128, rows = 1, layers = 1;

  PoolLayout() = default;
  PoolLayout(std::size_t page_count, int page_size);
  int columns() const { return width / page_size; }
  glm::ivec3 place(std::uint32_t slot) const;  ///< column, row, layer
  /// The same as shaders read it.
  std::uint32_t word(std::uint32_t slot) const;
};

/// Draws pages. One serves all lights of a technique.
class PageDrawer {
 public:
  /// Compiles; needs the context.
  void setup();
  /// The pages of a table, by their lists, into `pool`, which becomes D32F of the layout's size.
  void draw(const SceneBuffers& buffers, const LightCamera& camera, const PageTable& table, const DrawLists& lists,
            const PoolLayout& layout, Texture& pool);
  std::size_t bytes() const { return corners_.bytes() + placements_.bytes(); }

 private:
  static void set_image(const Program& program, const LightImage& image);
  Program programs_[2];  // parallel rays, rays from a center
  Framebuffer framebuffer_;
  VertexArray vertex_array_;
  RewrittenBuffer corners_, placements_;
};

}  // namespace gnomon::virtual_map
