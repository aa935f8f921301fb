#pragma once
#include <gnomon/kit/maps/light_layers.h>

#include <functional>

#include "pages.h"

// The debug layers of a virtual map.
namespace gnomon::virtual_map {

/// `pages`, and `map` and `texels` of light_layers.h as far as they make sense here.
std::vector<DebugLayer> debug_layers();

/// What pictures need of a resolve.
struct Resolved {
  const LightCamera& camera;  ///< of level 0
  const Scene& scene;
  const GBuffer& gbuffer;
  const Light& light;
  std::span<const PageAddress> pages;  ///< of each pixel; none where it looked nothing up
  std::span<const glm::ivec2> texels;  ///< of its level
  std::span<const float> mask;
};
std::vector<float> paint_pages(const Resolved& resolved);
std::vector<float> paint_texels(const Resolved& resolved);

/// What is stored, as one image a face: of each place the finest page. `depth_at` gives a texel of a slot.
std::vector<float> paint_map(const LightCamera& camera, const PageTable& table, int page_size, int width, int height,
                             const std::function<float(std::uint32_t slot, const glm::ivec2& texel)>& depth_at);

}  // namespace gnomon::virtual_map
