#pragma once
#include <gnomon/kit/gl.h>

namespace gnomon::shadow_map {

inline const std::string depth_vertex =
    std::string(gnomon::position_snippet) + "void main() { gl_Position = place(vec4(position, 1)); }";

inline constexpr std::string_view depth_fragment = "void main() {}";

/// The second layer: what is strictly behind the first. Equal depths are the same surface, or one glued to it.
inline constexpr std::string_view second_fragment = R"(
layout(binding = 0) uniform sampler2DArray first_depth;
uniform int layer;
void main() {
  if (gl_FragCoord.z >= texelFetch(first_depth, ivec3(gl_FragCoord.xy, layer), 0).r) discard;
}
)";

/// What the light is: one image with parallel rays, one with a center, or the six faces of a cube.
enum Projection { orthographic, perspective, cube };
inline constexpr int projection_count = 3;

/// Mirrors shadow_map::Face and shadow_map::explain; see there for the meaning of each quantity. The head defines PROJECTION,
/// BIAS and PCF: a branch on a uniform would be paid in full on llvmpipe, which executes both sides of every branch. With
/// EXPLAIN it writes the texel that it would look up instead of the visibility.
inline const std::string resolve_fragment = std::string(gnomon::faces_light_snippet) + R"(
layout(binding = 3) uniform sampler2DArray map;
uniform vec3 origin;
uniform vec4 window[6];  // scale and offset of each face
// Of each face: layer; the texel's larger width in window coordinates; near; far (orthographic), the texel's diagonal in window
// coordinates (slope bias) or the rounding error of the depth per squared axis distance (receiver plane).
uniform vec4 texel[6];
uniform float diagonal;  // of a texel in window coordinates, orthographic
uniform mat3 texel_from_light, texel_steps;  // of the one image; a cube has none, its faces only exchange axes
uniform int resolution, radius;
uniform float depth_bias, slope_bias, normal_offset, rounding;
#ifdef EXPLAIN
layout(location = 0) out vec2 looked_up;
#else
layout(location = 0) out float visibility;
#endif

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 surface = texelFetch(gbuffer_position, pixel, 0), facet = texelFetch(gbuffer_normal, pixel, 0);
  vec3 v = surface.xyz - origin, normal = facet.xyz;

  // What faces_light says, from the products that the look-up needs anyway.
#if PROJECTION == 0
  float height = -dot(normal, texel_steps[2]), squared = 1;
#else
  float height = -dot(normal, v), squared = dot(v, v);
#endif
  bool faces = surface.w * facet.w * height > 0 && height * height > squared * 2.2737368e-13;

#if PROJECTION == 2  // the face is the major axis; its neighbors in cyclic order span it
  float along = dot(v, spot.xyz);
  vec3 a = abs(v);
  bool is_x = a.x >= a.y && a.x >= a.z, is_y = !is_x && a.y >= a.z;
  int which = is_x ? int(v.x < 0) : is_y ? 2 + int(v.y < 0) : 4 + int(v.z < 0);
  vec4 w = window[which];
  vec4 t = texel[which];
#if BIAS == 2
  v += normal * (normal_offset * t.y * max(max(a.x, a.y), a.z));
#endif
  vec3 q = is_x ? v.yzx : is_y ? v.zxy : v;
  vec3 h = vec3(q.xy * w.xy, abs(q.z));
  h.xy += h.z * w.zw;
  vec2 step_height = (is_x ? normal.yz : is_y ? normal.zx : normal.xy) / w.xy;
#else
  vec4 w = window[0];
  vec4 t = texel[0];
#if BIAS == 2
  float along = (texel_from_light * v).z;
  v += normal * (normal_offset * t.y * (PROJECTION == 0 ? 1 : along));
  vec3 h = texel_from_light * v;
#else
  vec3 h = texel_from_light * v;
  float along = h.z;
#endif
  vec2 step_height = vec2(dot(normal, texel_steps[0]), dot(normal, texel_steps[1]));
#endif
#if PROJECTION != 0
  faces = faces && along >= 0 && along * along >= spot.w * squared;
#endif

  // Texel coordinates; the axis distance; how fast the light ray, per unit of the axis, sinks into the receiver's plane.
  float q_z = h.z, near = t.z, far = t.w;
#if PROJECTION == 0
  vec2 position = h.xy + w.zw;
  float texel_width = t.y, facing = height;
#else
  float per_z = 1 / q_z;
  vec2 position = h.xy * per_z;
  float texel_width = q_z * t.y, facing = height * per_z;
#endif

  // All comparisons are multiplied by `scale`: the facing where a quotient by it would be needed, else 1.
  float scale = 1, bias = depth_bias * texel_width, error = 0;
#if BIAS == 1
  // Half the diagonal times the tangent of the angle between normal and ray, times the facing: its sine over the axis.
#if PROJECTION == 0
  error = slope_bias * 0.5 * diagonal * sqrt(max(1 - height * height, 0));
#else
  error = slope_bias * 0.5 * far * q_z * sqrt(max(1 - height * height / squared, 0));
#endif
  scale = facing;
#elif BIAS == 3
  scale = facing;
  error = rounding + texel_width * 0.0078125;
#if PROJECTION != 0
  error += far * q_z * q_z;
#endif
#endif
  float depth = q_z * scale - error;
  vec2 center = floor(position);

#ifdef EXPLAIN
  looked_up = center;
#else
#if PCF
  float lit = 0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      vec2 tap = center + vec2(x, y);
#else
      vec2 tap = center;
#endif
      ivec2 at = ivec2(tap);
      bool inside = all(lessThan(uvec2(at), uvec2(resolution)));
      float d = inside ? texelFetch(map, ivec3(at, int(t.x)), 0).r : 0;
      // How much the receiver's plane rises toward the light between the point and the texel's center.
      float rise = BIAS == 3 ? dot(step_height, tap + 0.5 - position) : 0;
      // Dark: something is stored, and before the receiver by more than the bias. No quotient of depths is formed: with a
      // center, near / d < q_z / m - bias; where m <= 0 the texel's ray meets the receiver's plane at infinity.
#if PROJECTION == 0
      bool dark = d > 0 && d * (far - near) * scale > far * scale - depth - rise + bias * scale;
#else
      float m = max(scale - rise, 0);
      bool dark = near * m < (depth - bias * m) * d;
#endif
#if PCF
      lit += dark ? 0 : 1;
    }
  visibility = faces ? lit / float((2 * radius + 1) * (2 * radius + 1)) : 1;
#else
  visibility = faces && dark ? 0 : 1;
#endif
#endif
}
)";

}  // namespace gnomon::shadow_map
