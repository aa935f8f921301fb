#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/pictures/painter.h>
#include <gnomon/technique.h>

#include <functional>
#include <span>
#include <vector>

#include "bsp.h"

namespace gnomon::svbsp {

// Pictures by the regular BSP tree: width * height * 3 floats, linear RGB in 0 .. 1.

/// The debug layer `bsp`, which `paint_bsp` draws: all visible points and the polygons of the tree that they lie in, like
/// `paint_splits`.
DebugLayer bsp_layer();
std::vector<float> paint_bsp(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp);

/// The debug layer `painter`, which `paint_back_to_front` draws.
DebugLayer painter_layer();

/// Paints the parts of one polygon over what is there.
class DetailBrush {
 public:
  /// Twice the triangle, counted over the scene, plus one where it is lit; or `nothing`.
  using Paint = std::uint32_t;
  static constexpr Paint nothing = 0xffffffffu;

  DetailBrush(const Camera& camera, std::size_t size) : pixels(size, nothing), painter_(camera) {}
  /// Corners of a convex part in world space, wound either way.
  template <class Point>
  void paint(std::span<const Point> corners, bool is_lit) {
    for_covered_pixels(painter_, corners, [this, is_lit](std::size_t i) { pixels[i] = 2 * triangle + is_lit; });
  }
  std::vector<Paint> pixels;
  std::uint32_t triangle = 0;  ///< that is painted now

 private:
  Painter painter_;
};

/// Gives the lit and shadowed parts of a polygon of the tree to the brush.
using DetailOf = std::function<void(const BspPolygon& polygon, DetailBrush& brush)>;

/// The second pass of object precision: the polygons of the tree with their surface detail, back to front from the eye, each
/// painted over what it hides; no depth is compared. Each polygon is painted whole first, as lit. Then detail_of is asked about
/// it, if it is of a mesh that receives and the eye sees the side that is turned to the light. Away from edges the picture is
/// `shaded_layer` of that shadow on the meshes, to rounding in float32. Of the G-buffer only view and size are used.
std::vector<float> paint_back_to_front(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp,
                                       const DetailOf& detail_of);

}  // namespace gnomon::svbsp
