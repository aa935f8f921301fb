#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/bsp.h>
#include <gnomon/technique.h>

#include <functional>
#include <span>
#include <vector>

namespace gnomon {

// Pictures of surface detail: width * height * 3 floats, linear RGB in 0 .. 1.

/// The debug layer `fragments`, which `paint_detail` draws.
std::vector<DebugLayer> detail_layers();

/// Throws Error when a polygon names a mesh, triangle or corner that does not exist, has fewer than three corners or one that
/// is not finite, or comes before a polygon of an earlier triangle.
void check_detail(const Scene& scene, const SurfaceDetail& detail);

/// Every visible point that faces the light has the color of the polygon of its own triangle that it lies in: warm when that is
/// lit, cool when it is shadowed; a little brighter or darker by its triangle and its place among that one's polygons, and
/// darker along its border where that leaves at least half of it free. A point by the border of its triangle that rounding
/// leaves out has the nearest polygon's color. On an exact curved shape the polygon of the mesh that lies nearest to the point
/// along its ray counts. All other points, and those of triangles without detail, are as in `shaded_layer`. The detail is
/// checked; it may leave out triangles that are not seen.
std::vector<float> paint_detail(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail);

/// The debug layer `splits`, which `paint_splits` draws.
DebugLayer splits_layer();

/// Every visible point that faces the light as in `shaded_layer`, dark where its polygon is shadowed, in tones that differ a
/// little from one polygon to the next. Borders are colored by what they are: between two triangles, between a lit and a
/// shadowed part of one triangle, or else a split of it; but for those of shadows, they fade where they would leave less than
/// half of the polygon free. Which polygon a point lies in is said as in `paint_detail`. The detail is checked.
std::vector<float> paint_splits(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail);

/// The debug layer `bsp`, which `paint_bsp` draws: all visible points and the polygons of the tree that they lie in, like
/// `paint_splits`.
DebugLayer bsp_layer();
std::vector<float> paint_bsp(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp);

/// The debug layer `painter`, which `paint_back_to_front` draws.
DebugLayer painter_layer();

/// Paints the parts of one polygon over what is there.
class DetailBrush {
 public:
  virtual ~DetailBrush() = default;
  /// Corners of a convex part in world space, wound either way.
  virtual void paint(std::span<const glm::dvec3> corners, bool is_lit) = 0;
  virtual void paint(std::span<const Corner> corners, bool is_lit) = 0;
};

/// Gives the lit and shadowed parts of a polygon of the tree to the brush.
using DetailOf = std::function<void(const BspPolygon& polygon, DetailBrush& brush)>;

/// The second pass of object precision: the polygons of the tree with their surface detail, back to front from the eye, each
/// painted over what it hides; no depth is compared. Each polygon is painted whole first, as lit. Then detail_of is asked about
/// it, if it is of a mesh that receives and the eye sees the side that is turned to the light. Away from edges the picture is
/// `shaded_layer` of that shadow on the meshes, to rounding in float32. Of the G-buffer only view and size are used.
std::vector<float> paint_back_to_front(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp,
                                       const DetailOf& detail_of);

}  // namespace gnomon
