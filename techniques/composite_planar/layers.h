#pragma once
#include <gnomon/kit/pictures/layers.h>

namespace composite_planar {
using namespace gnomon;

/// How many tests of either kind put a pixel in shadow.
struct Holders {
  std::uint32_t discs = 0, polygons = 0;
};

inline const Swatch disc_swatch{"disc: ellipse, parabola, hyperbola", {0.03, 0.2, 0.6}};
inline const Swatch polygon_swatch{"triangle, rectangle", {0.8, 0.3, 0.02}};
inline const Swatch both_swatch{"both", {0.35, 0.03, 0.35}};

inline std::vector<DebugLayer> composite_layers() {
  return {
      {"parts",
       "What shadows are composed of: the image of a disc (of a sphere: of the circle where the light touches it; of a cone: "
       "of its base), and of polygons (of a cone: of the triangle between its peak and the points where tangents touch its "
       "base).",
       {disc_swatch, polygon_swatch, both_swatch}},
      {"overlaps", "How many parts' shadows hold each point: what blending them one after the other would darken as often.",
       heat_legend()}};
}

inline std::vector<float> paint_parts(const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                      std::span<const Holders> holders) {
  std::vector<float> picture = shaded_layer(scene, gbuffer, light, std::vector<float>(holders.size(), 1.0f));
  for (std::size_t i = 0; i < holders.size(); ++i) {
    const Holders& h = holders[i];
    if (h.discs + h.polygons == 0) continue;
    const Swatch& swatch = h.discs == 0 ? polygon_swatch : h.polygons == 0 ? disc_swatch : both_swatch;
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = 0.25f * picture[3 * i + c] + 0.75f * static_cast<float>(swatch.color[c]);
  }
  return picture;
}

inline std::vector<float> paint_overlaps(const GBuffer& gbuffer, std::span<const Holders> holders) {
  std::vector<float> counts;
  for (const Holders& h : holders) counts.push_back(static_cast<float>(h.discs + h.polygons));
  return heat_layer(gbuffer, counts);
}

}  // namespace composite_planar
