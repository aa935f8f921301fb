#pragma once
#include <string>

namespace gnomon::gl_rays {

/// Pixels along each side of a work group.
inline constexpr int group_side = 8;

/// Whether a ray meets a triangle, so that none slips through an edge that two triangles share (Woop, Benthin and Wald 2013):
///   int ray_axis(vec3 way)                 the axis along which the way is longest
///   vec3 turned(vec3 v, int axis)          components in cyclic order, that of the axis last
///   vec2 ray_shear(vec3 way)               of a turned way: what shears it along its last component
///   vec3 edge_functions(vec3 a, vec3 b, vec3 c, vec2 shear)   U, V, W of corners relative to the ray's start, turned
///   bool is_inside(vec3 edges)             whether the line of the ray meets the triangle
///   bool is_between(dvec3 a, dvec3 b, dvec3 c, dvec3 start, dvec4 light)   whether the plane of a triangle has the start and
///                                          the homogeneous light on its two sides: in double, for a coplanar triangle or
///                                          one at the light is a rounding away
///
/// Two triangles compute the function of their common edge from the same numbers, one with the sign changed. A fused product
/// would round the two otherwise: all of it is `precise`. What the paper adds for a function of exactly 0, to compute all
/// three in double, takes away false hits and no leaks, and is left out.
extern const std::string triangle_snippet;

/// The shader that traces. Storage buffers: 0 of each mesh its first triangle and whether it stands for a curved shape
/// (`first_triangles`), then how many triangles there are. Images: 0 the mask, 1 how many boxes each ray tested, 2 and 3 nodes
/// and corners as texels of four numbers. With `textures` rays go through holes and glass; then storage buffers 3 triangles, 4
/// uv, 6 transmissions and 7 alpha masks, as SceneBuffers has them.
std::string trace_source(bool textures);

}  // namespace gnomon::gl_rays
