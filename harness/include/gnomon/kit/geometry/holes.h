#pragma once
#include <gnomon/kit/geometry/exact.h>

#include <optional>

namespace gnomon {

// Where a way meets a triangle with an alpha mask or of glass, whether that is solid there and what it lets through. Everybody
// looks up the same texel: the place is computed from the five float32 points (receiver, light, corners), never from a ray
// tracer's own coordinates, which are off by up to a twentieth of a texel.

/// A place in an alpha mask or a transmission, in texels from its corner: column floor(x), row floor(y) before wrapping.
struct TexelPlace {
  double x = 0, y = 0;
};

/// Columns and rows.
inline glm::ivec2 size_of(const AlphaMask& mask) { return {mask.width(), mask.height()}; }
inline glm::ivec2 size_of(const Transmission& glass) { return {glass.width(), glass.height()}; }

/// Where the line of a segment meets the plane of a triangle of a mesh with uv, in texels of a texture of that size. In double:
/// off by some 1e-13 of a texel where all coordinates are of the triangle's size.
TexelPlace texel_place(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& point, const glm::dvec4& light,
                       const glm::ivec2& size);
/// The same in its alpha mask.
inline TexelPlace texel_place(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& point, const glm::dvec4& light) {
  return texel_place(mesh, triangle, point, light, size_of(*mesh.alpha_mask));
}

/// Whether a triangle that a segment crosses is solid there: true of one without an alpha mask. Exact: where double cannot tell
/// two texels apart and their bits differ, rational numbers do.
bool is_solid_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment);

/// The same of the line from a point along a direction, in double alone: for rays that are rounded themselves. `scale` is what
/// the corners are multiplied by to be in the frame of the ray.
bool is_solid_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction,
                    double scale = 1);

/// What a triangle that a segment crosses lets through where it is solid: red, green, blue. Exact, as is_solid_at; 0 of a mesh
/// without transmission.
glm::vec3 transmission_at(const Mesh& mesh, std::uint32_t triangle, const Segment& segment);
/// The same of a line in double alone, as is_solid_along.
glm::vec3 transmission_along(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& origin, const glm::dvec3& direction,
                             double scale = 1);
/// What the texel of a place lets through where no texel within `reach` of it, along both axes, lets through more or less by
/// over `most`; else nothing.
std::optional<glm::vec3> transmission_around(const Transmission& glass, const TexelPlace& place, double reach, float most);

/// What the texels within `reach` of a place, along both axes, are: all solid, all holes, or both.
enum class Around { solid, hole, both };
Around around(const AlphaMask& mask, const TexelPlace& place, double reach);

/// How far rounding to float32 may move a look-up, in texels: 16 * 2^-24 * (2 * extent * stretch / cosine + most |u| * texels).
/// `extent` as of gnomon::extent(scene, light, view), meters; `direction` that of the way. Infinite where the way runs along
/// the triangle. `size` of the texture in texels.
double texel_rounding(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& direction, double extent,
                      const glm::ivec2& size);
/// The same in its alpha mask.
inline double texel_rounding(const Mesh& mesh, std::uint32_t triangle, const glm::dvec3& direction, double extent) {
  return texel_rounding(mesh, triangle, direction, extent, size_of(*mesh.alpha_mask));
}

}  // namespace gnomon
