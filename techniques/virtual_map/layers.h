#pragma once
#include <gnomon/kit/maps/light_layers.h>

#include <functional>

#include "pages.h"

// The debug layers of a virtual map.
namespace gnomon::virtual_map {

/// Linear colors; neighbors differ in hue. The coarsest page of 64 texels is level 11.
inline constexpr glm::dvec3 level_colors[] = {{0.55, 0.02, 0.03}, {0.90, 0.25, 0.02}, {0.93, 0.70, 0.08}, {0.35, 0.65, 0.06},
                                              {0.03, 0.32, 0.09}, {0.05, 0.55, 0.50}, {0.15, 0.50, 0.90}, {0.06, 0.10, 0.60},
                                              {0.30, 0.07, 0.58}, {0.72, 0.20, 0.72}, {0.80, 0.45, 0.45}, {0.60, 0.60, 0.60}};
inline const Swatch nothing_asked{"nothing requested", {0.045, 0.05, 0.06}};

/// Texels along a side of the image that `paint_map` puts pages into.
inline constexpr int sheet_level = 7, sheet_side = finest_side >> sheet_level;

/// `pages`, and `map` and `texels` of light_layers.h with a sentence that fits a virtual map.
inline std::vector<DebugLayer> debug_layers() {
  DebugLayer pages{
      .name = "pages",
      .sentence =
          "The page table from the eye: the color is the level of a pixel's page, named by the texels along a side of the whole "
          "virtual image, neighboring pages are lighter and darker in turn, and what the map answers dark is dimmed."};
  for (std::size_t level = 0; level < std::size(level_colors); ++level)
    pages.legend.push_back({fmt::format("{}", finest_side >> level), level_colors[level]});
  pages.legend.push_back(nothing_asked);
  std::vector<DebugLayer> layers = map_layers();
  for (DebugLayer& layer : layers)
    if (layer.name == "map")
      layer.sentence =
          "What the pages store, the finest of each place, as one image a face: upright, from the nearest stored depth (dark) "
          "to the farthest (light), with lines where depth jumps; around a point light six, framed by the way they look.";
  layers.insert(layers.begin(), std::move(pages));
  return layers;
}

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

inline std::vector<float> paint_pages(const Resolved& r) {
  std::vector<float> picture = shaded_layer(r.scene, r.gbuffer, r.light, r.mask);
  for (std::size_t i = 0; i < r.pages.size(); ++i) {
    if (r.gbuffer.is_background(i)) continue;
    glm::dvec3 color = nothing_asked.color;
    if (const PageAddress page = r.pages[i]; page != PageAddress()) {
      const bool is_odd = (page.page().x + page.page().y + page.face()) % 2 != 0;
      color = level_colors[page.level()] * (is_odd ? 0.6 : 1.0) * (0.35 + 0.65 * r.mask[i]);
    }
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(color[c]);
  }
  return picture;
}

/// Level by level, as if each were a map of its own.
inline std::vector<float> paint_texels(const Resolved& r) {
  std::vector<float> picture = shaded_layer(r.scene, r.gbuffer, r.light, r.mask);
  for (int level = 0; level < std::ssize(level_colors); ++level) {
    std::vector<LookUp> look_ups(r.pages.size());
    for (std::size_t i = 0; i < r.pages.size(); ++i)
      if (r.pages[i] != PageAddress() && r.pages[i].level() == level) look_ups[i] = {r.pages[i].face(), r.texels[i]};
    if (std::ranges::all_of(look_ups, [](const LookUp& look_up) { return look_up.image < 0; })) continue;
    LightCamera camera = r.camera;
    camera.resolution = finest_side >> level;
    for (LightImage& image : camera.images) image = at_level(image, level);
    const std::vector<float> of_level = paint_texels(camera, r.scene, r.gbuffer, r.light, look_ups, r.mask);
    for (std::size_t i = 0; i < r.pages.size(); ++i)
      if (look_ups[i].image >= 0) std::copy_n(&of_level[3 * i], 3, &picture[3 * i]);
  }
  return picture;
}

/// What is stored, as one image a face: of each place the finest page. `depth_at` gives a texel of a slot.
inline std::vector<float> paint_map(const LightCamera& camera, const PageTable& table, int page_size, int width, int height,
                                    const std::function<float(std::uint32_t slot, const glm::ivec2& texel)>& depth_at) {
  LightCamera sheet = camera;
  sheet.resolution = sheet_side;
  for (LightImage& image : sheet.images) image = at_level(image, sheet_level);
  std::array<std::vector<float>, 6> depths;
  for (std::size_t face = 0; face < sheet.images.size(); ++face)
    if (sheet.images[face].layer >= 0) depths[face].assign(std::size_t(sheet_side) * sheet_side, 0);
  // From the coarsest to the finest.
  for (std::size_t k = table.pages.size(); k-- > 0;) {
    const PageAddress page = table.pages[k];
    const double texels = std::ldexp(1.0, sheet_level - page.level());  // of the page, along one of the sheet
    const glm::ivec2 corner = page.page() * page_size;
    const glm::ivec2 low(glm::floor(glm::dvec2(corner) / texels)), high(glm::ceil(glm::dvec2(corner + page_size) / texels));
    for (int y = low.y; y < high.y; ++y)
      for (int x = low.x; x < high.x; ++x) {
        const glm::ivec2 texel = glm::ivec2(glm::floor((glm::dvec2(x, y) + 0.5) * texels)) - corner;
        depths[page.face()][std::size_t(y) * sheet_side + x] =
            depth_at(static_cast<std::uint32_t>(k), glm::clamp(texel, glm::ivec2(0), glm::ivec2(page_size - 1)));
      }
  }
  return gnomon::paint_map(sheet, width, height, [&](std::size_t face) { return std::span<const float>(depths[face]); });
}

}  // namespace gnomon::virtual_map
