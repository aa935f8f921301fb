#pragma once
#include <gnomon/kit/gl/gl_planes.h>

namespace planar_projected {

/// Each pixel's receiver plane as a depth: depth_step times its number plus one; 0 where it lies on none or does not face the
/// light. A plane's shadows are then drawn at its depth and pass where it equals the pixel's, before any shader runs. Where all
/// of a plane faces the light or none of it does, pixels are not tested: the head defines PLANES_FACE as 1.
inline const std::string receivers_constants = std::string(gnomon::faces_light_constants) + "float depth_step;";
inline const std::string receivers_fragment = std::string(gnomon::gbuffer_snippet) + std::string(gnomon::faces_light_snippet) +
                                              std::string(gnomon::plane_lookup_snippet) + R"(
void main() {
  uvec2 ids = ids_here();
#if PLANES_FACE
  bool facing = ids.x != 0;
#else
  bool facing = faces_light(position_here(), normal_here());
#endif
  uint receiver = facing ? receiver_plane(ids) + 1 : 0;  // no_plane + 1 is 0
  gl_FragDepth = float(receiver) * depth_step;
}
)";

/// The textbook's formula: the image on the plane is divided by its w, which is that share, wherever the vertex is. A vertex at
/// the light's height, as far as float32 can tell, has w = least_share: its image is far away, where that of one a hair lower
/// would be. Triangles on the plane are the receiver itself, and are left out whole.
inline const std::string unclipped_vertex = std::string(gnomon::position_snippet) + R"(
uniform mat4 projected;
uniform vec4 plane;
uniform float tolerance, least_share;
out float gl_CullDistance[1];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_CullDistance[0] = abs(height) > tolerance ? 1 : -1;
  vec4 image = projected * vec4(position, 1);
  float w = abs(image.w) < least_share ? least_share : image.w;
  gl_Position = place(vec4(image.xyz / w, 1));
#if defined(MASKED) || defined(GLASS)
  gl_Position *= abs(w);  // the same place; the texture is seen in perspective
#endif
#ifdef MASKED
  hand_on_mask();
#endif
}
)";

}  // namespace planar_projected
