#pragma once
#include <gnomon/kit/gl.h>

namespace shadow_map {

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

/// Mirrors shadow_map::Face and ShadowMap::explain; see there for the meaning of each quantity. The head defines PROJECTION,
/// BIAS and PCF: a branch on a uniform would be paid in full on llvmpipe, which executes both sides of every branch.
inline const std::string resolve_fragment = std::string(gnomon::faces_light_snippet) + R"(
layout(binding = 3) uniform sampler2DArray map;
uniform vec3 origin;
uniform vec4 window[6];  // scale and offset of each face
// Of each face: near; far (orthographic) or rounding error of the depth per squared axis distance; layer; the texel's larger
// width in window coordinates.
uniform vec4 range[6];
uniform mat3 texel_from_light, texel_steps;  // of the one image; a cube has none, its faces only exchange axes
uniform int resolution, radius;
uniform float depth_bias, slope_bias, normal_offset, rounding;
layout(location = 0) out float visibility;

float lookup(vec3 point, vec3 normal) {
  vec3 v = point - origin;
#if PROJECTION == 2  // the face is the major axis; its neighbors in cyclic order span it
  vec3 a = abs(v);
  bool is_x = a.x >= a.y && a.x >= a.z, is_y = !is_x && a.y >= a.z;
  int which = is_x ? int(v.x < 0) : is_y ? 2 + int(v.y < 0) : 4 + int(v.z < 0);
  vec4 w = window[which], r = range[which];
#if BIAS == 2
  v += normal * (normal_offset * r.w * max(max(a.x, a.y), a.z));
#endif
  vec3 q = is_x ? v.yzx : is_y ? v.zxy : v;
  vec3 h = vec3(q.xy * w.xy, abs(q.z));
  h.xy += h.z * w.zw;
  vec2 step_height = (is_x ? normal.yz : is_y ? normal.zx : normal.xy) / w.xy;
#else
  vec4 w = window[0], r = range[0];
#if BIAS == 2
  v += normal * (normal_offset * r.w * (PROJECTION == 0 ? 1 : (texel_from_light * v).z));
#endif
  vec3 h = texel_from_light * v;
  vec2 step_height = vec2(dot(normal, texel_steps[0]), dot(normal, texel_steps[1]));
#endif
  float near = r.x;

  // Texel coordinates; the axis distance; how fast the light ray, per unit of the axis, sinks into the receiver's plane.
#if PROJECTION == 0
  vec2 position = h.xy + w.zw;
  float q_z = h.z, texel_width = r.w, facing = -dot(normal, texel_steps[2]);
#else
  float q_z = h.z, per_z = 1 / q_z;
  vec2 position = h.xy * per_z;
  float texel_width = q_z * r.w, facing = dot(normal, origin - point) * per_z;
#endif

  // Along the axis.
  float bias = depth_bias * texel_width;
  vec2 gradient = vec2(0);  // of the receiver plane's depth, per texel
#if BIAS == 1
  float ray_squared = PROJECTION == 0 ? 1 : dot(v, v) / (q_z * q_z);
  vec2 sides = (PROJECTION == 0 ? 1 : q_z) / w.xy;
  bias += slope_bias * 0.5 * length(sides) * sqrt(max(ray_squared - facing * facing, 0) / ray_squared) / facing;
#elif BIAS == 3
  float per_facing = 1 / facing;
  gradient = -step_height * per_facing;
  float error = rounding + texel_width * 0.0078125;
#if PROJECTION != 0
  error += r.y * q_z * q_z;
#endif
  bias += error * per_facing;
#endif
  vec2 center = floor(position);

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
      float d = inside ? texelFetch(map, ivec3(at, int(r.z)), 0).r : 0;
      float k = dot(gradient, tap + 0.5 - position);
      // Dark: something is stored, and before the receiver by more than the bias. No quotient of depths is formed: with a
      // center, near / d < q_z / m - bias; where m <= 0 the texel's ray meets the receiver's plane at infinity.
#if PROJECTION == 0
      bool dark = d > 0 && d * (r.y - near) > r.y - (q_z - k - bias);
#else
      float m = max(1 + k, 0);
      bool dark = near * m < (q_z - bias * m) * d;
#endif
#if PCF
      lit += dark ? 0 : 1;
    }
  return lit / float((2 * radius + 1) * (2 * radius + 1));
#else
  return dark ? 0 : 1;
#endif
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position = texelFetch(gbuffer_position, pixel, 0), normal = texelFetch(gbuffer_normal, pixel, 0);
  visibility = 1;
  if (faces_light(position, normal)) visibility = lookup(position.xyz, normal.xyz);
}
)";

}  // namespace shadow_map
