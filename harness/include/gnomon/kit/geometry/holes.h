#pragma once
#include <gnomon/kit/geometry/exact.h>

namespace gnomon {

// Where a way meets a triangle with an alpha mask, and whether that is solid there. Everybody looks up the same texel: the
// place is computed from the five float32 points (receiver, light, corners), never from a ray tracer's own coordinates, which
// are off by up to a twentieth of a texel.

/// A place in an alpha mask, in texels from its corner: column floor(x), row floor(y) before wrapping.
struct TexelPlace {
  double x = 0, y = 0;
};

/// Where the line of a segment meets the plane of a triangle of a mesh with an alpha mask. In double: off by some 1e-13 of a
/// texel where all coordinates are of the triangle's size.
TexelPlace texel_place(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& point, const glm::dvec4& light);

/// Whether a triangle that a segment crosses is solid there: true of one without an alpha mask. Exact: where double cannot tell
/// two texels apart and their bits differ, rational numbers do.
bool is_solid_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment);

/// The same of the line from a point along a direction, in double alone: for rays that are rounded themselves. `scale` is what
/// the corners are multiplied by to be in the frame of the ray.
bool is_solid_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction,
                    double scale = 1);

/// What the texels within `reach` of a place, along both axes, are: all solid, all holes, or both.
enum class Around { solid, hole, both };
Around around(const AlphaMask& mask, const TexelPlace& place, double reach);

/// How far rounding to float32 may move a look-up, in texels: 16 * 2^-24 * (2 * extent * stretch / cosine + most |u| * texels).
/// `extent` as of gnomon::extent(scene, light, view), meters; `direction` that of the way. Infinite where the way runs along
/// the triangle.
double texel_rounding(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& direction, double extent);

}  // namespace gnomon
