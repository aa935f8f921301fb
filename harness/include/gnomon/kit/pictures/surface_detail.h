#pragma once
#include <gnomon/technique.h>

namespace gnomon {

// Pictures of surface detail: width * height * 3 floats, linear RGB in 0 .. 1.

/// The debug layer `fragments`, which `paint_detail` draws.
std::vector<DebugLayer> detail_layers();
/// The same for a technique of lights with area, whose legend has the penumbra, too.
std::vector<DebugLayer> soft_detail_layers();

/// Throws Error when a polygon is lit and in the penumbra, names a mesh, triangle or corner that does not exist, has fewer than
/// three corners or one that is not finite, or comes before a polygon of an earlier triangle.
void check_detail(const Scene& scene, const SurfaceDetail& detail);

/// Every visible point that faces the light has the color of the polygon of its own triangle that it lies in: warm when that is
/// lit, cool when it is shadowed, green in the penumbra; a little brighter or darker by its triangle and its place among that
/// one's polygons, and darker along its border where that leaves at least half of it free. A point by the border of its
/// triangle that rounding leaves out has the nearest polygon's color. On an exact curved shape the polygon of the mesh that
/// lies nearest to the point along its ray counts. All other points, and those of triangles without detail, are as in
/// `shaded_layer`. The detail is checked; it may leave out triangles that are not seen.
std::vector<float> paint_detail(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail);

/// The debug layer `splits`, which `paint_splits` draws.
DebugLayer splits_layer();

/// Every visible point that faces the light as in `shaded_layer`, dark where its polygon is shadowed and half
/// dark where it is in the penumbra, in tones that differ a
/// little from one polygon to the next. Borders are colored by what they are: between two triangles, between a lit and a
/// shadowed part of one triangle, or else a split of it; but for those of shadows, they fade where they would leave less than
/// half of the polygon free. Which polygon a point lies in is said as in `paint_detail`. The detail is checked.
std::vector<float> paint_splits(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail);

/// The polygons of any division of the scene, like `paint_splits` but without shadows, and for all visible points.
std::vector<float> paint_division(const Scene& scene, const GBuffer& gbuffer, const Light& light, const SurfaceDetail& detail);

}  // namespace gnomon
