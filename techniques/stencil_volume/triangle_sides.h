#pragma once
#include <string_view>

namespace stencil_volume {

/// Side quads of every triangle: eighteen vertices each, nine where volumes are pointed. A side begins at the vertex with the
/// smaller number; where several vertices may be at one position, at the end with the smaller coordinates.
inline constexpr std::string_view triangle_sides_body = R"(
uniform bool by_position;
bool is_before(uint a, uint b) {
  if (!by_position) return a < b;
  vec3 p = fetch(a), q = fetch(b);
  if (p == q) return a < b;
  return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
}
void main() {
  int corners = pointed ? 3 : 6, side = gl_VertexID / corners, triangle = side / 3, k = side % 3;
  uint from = triangles[3 * triangle + k], to = triangles[3 * triangle + (k + 1) % 3];
  bool rises = is_before(from, to);
  gl_Position = place(quad_corner(rises ? from : to, rises ? to : from, rises, 0, gl_VertexID % corners));
}
)";

}  // namespace stencil_volume
