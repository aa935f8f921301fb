#pragma once
#include <string_view>

// GLSL of stencil_volume beside that of kit/volume_faces. Every vertex goes through the place() of position_snippet.

namespace stencil_volume {

/// Eighteen vertices a triangle, nine under a directional light.
inline constexpr std::string_view triangle_sides_body = R"(
void main() {
  int corners = directional ? 3 : 6, side = gl_VertexID / corners, triangle = side / 3, k = side % 3;
  uint from = triangles[3 * triangle + k], to = triangles[3 * triangle + (k + 1) % 3];
  gl_Position = place(quad_corner(min(from, to), max(from, to), from < to, gl_VertexID % corners));
}
)";

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
