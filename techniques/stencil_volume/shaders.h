#pragma once
#include <string_view>

// GLSL of stencil_volume. Every vertex goes through the place() of position_snippet. Vertices are fetched by number, so that
// one list of edges or triangles is all that a light changes.

namespace stencil_volume {

/// Bindings of shader storage buffers, the same in every shader.
inline constexpr std::string_view fetch_head = R"(
layout(std430, binding = 0) readonly buffer Positions { float positions[]; };
layout(std430, binding = 1) readonly buffer Sides { uvec4 sides[]; };          // low, high, part, 1 when high comes first
layout(std430, binding = 2) readonly buffer Triangles { uint triangles[]; };  // three a triangle, turned to the light
layout(std430, binding = 3) readonly buffer Hubs { vec4 hubs[]; };        // of each part; w = 0: it has none
uniform vec4 light;  // homogeneous
vec3 fetch(uint v) { return vec3(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]); }
vec4 extruded(vec3 p) { return vec4(light.w * p - light.xyz, 0); }
)";

/// Corner `corner` of the side quad of an edge. Both copies of a quad that two volumes share are cut along the same diagonal
/// and begin at the same vertex: they differ in their turn only, and so cover the very same pixels. A directional light's quad
/// is a triangle. A quad for `high_first` runs high, low, low at infinity, high at infinity.
inline constexpr std::string_view quad_head = R"(
uniform bool directional;
vec4 quad_corner(uint low, uint high, bool high_first, int corner) {
  if (directional) {
    const int places[6] = int[](0, 2, 1, 0, 1, 2);
    int which = places[corner + (high_first ? 0 : 3)];
    return which == 0 ? vec4(fetch(low), 1) : which == 1 ? vec4(fetch(high), 1) : vec4(-light.xyz, 0);
  }
  const int places[12] = int[](0, 2, 3, 0, 3, 1, 0, 3, 2, 0, 1, 3);
  int which = places[corner + (high_first ? 0 : 6)];
  vec3 p = fetch((which & 1) == 0 ? low : high);
  return which < 2 ? vec4(p, 1) : extruded(p);
}
)";

/// Six vertices an edge, three under a directional light.
inline constexpr std::string_view sides_body = R"(
void main() {
  int corners = directional ? 3 : 6;
  uvec4 side = sides[gl_VertexID / corners];
  gl_Position = place(quad_corner(side.x, side.y, side.w != 0, gl_VertexID % corners));
}
)";

/// Eighteen vertices a triangle, nine under a directional light.
inline constexpr std::string_view triangle_sides_body = R"(
void main() {
  int corners = directional ? 3 : 6, side = gl_VertexID / corners, triangle = side / 3, k = side % 3;
  uint from = triangles[3 * triangle + k], to = triangles[3 * triangle + (k + 1) % 3];
  gl_Position = place(quad_corner(min(from, to), max(from, to), from < to, gl_VertexID % corners));
}
)";

/// The dark cap of a whole part as a fan at infinity over its outline: at infinity a cap is flat, so only its outline counts.
inline constexpr std::string_view fan_body = R"(
void main() {
  uvec4 side = sides[gl_VertexID / 3];
  vec4 hub = hubs[side.z];
  int corner = gl_VertexID % 3;
  uint v = (corner == 1) == (side.w != 0) ? side.y : side.x;
  gl_Position = place(hub.w == 0 ? vec4(0) : extruded(corner == 0 ? hub.xyz : fetch(v)));
}
)";

/// Dark caps triangle by triangle, turned away from the light.
inline constexpr std::string_view far_triangles_body = R"(
void main() {
  int corner = gl_VertexID % 3;
  gl_Position = place(extruded(fetch(triangles[gl_VertexID - corner + (3 - corner) % 3])));
}
)";

/// Light caps: the triangles of the scene as the depth of the view was drawn, so that they tie with it.
inline constexpr std::string_view caps_body = "void main() { gl_Position = place(vec4(position, 1)); }";

/// Casters between the light and the near plane, thrown onto that plane from the light. `clip_from_world` holds the projection.
inline constexpr std::string_view near_cap_body = R"(
uniform vec4 plane;            // near plane, turned to the light
uniform float light_height;    // of the homogeneous light over it
uniform float light_w;
out float gl_ClipDistance[2];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_ClipDistance[0] = height;
  gl_ClipDistance[1] = light_height - height * light_w;
  gl_Position = place(vec4(position, 1));
}
)";

}  // namespace stencil_volume
