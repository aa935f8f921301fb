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

/// Mirrors shadow_map::Face and ShadowMap::explain; see there for the meaning of each quantity.
inline const std::string resolve_fragment = std::string(gnomon::faces_light_snippet) + R"(
const int constant_bias = 0, slope = 1, normal_offset_bias = 2, receiver_plane = 3;  // order of the parameter's choices

struct Face {
  mat3 frame;
  vec2 scale, offset;
  float near, far;
  int layer;  // -1: nothing casts here
};
layout(binding = 3) uniform sampler2DArray map;
uniform Face faces[6];
uniform vec3 origin;
uniform int is_cube, is_perspective, resolution, bias_mode, radius;
uniform float depth_bias, slope_bias, normal_offset, rounding;
layout(location = 0) out float visibility;

const float infinity = uintBitsToFloat(0x7f800000u);

/// Axis distance of the stored surface; infinity when nothing is stored or the texel is off the image.
float stored(Face face, ivec2 texel) {
  if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(resolution)))) return infinity;
  float depth = texelFetch(map, ivec3(texel, face.layer), 0).r;
  if (depth == 0) return infinity;
  return is_perspective != 0 ? face.near / depth : face.far - depth * (face.far - face.near);
}

int face_of(vec3 from_light) {
  if (is_cube == 0) return 0;
  vec3 a = abs(from_light);
  if (a.x >= a.y && a.x >= a.z) return from_light.x < 0 ? 1 : 0;
  if (a.y >= a.z) return from_light.y < 0 ? 3 : 2;
  return from_light.z < 0 ? 5 : 4;
}

float lookup(vec3 point, vec3 normal) {
  Face face = faces[face_of(point - origin)];
  if (face.layer < 0) return 1;
  vec3 q = face.frame * (point - origin), n = face.frame * normal;
  bool perspective = is_perspective != 0;

  // The light ray at the point, its cosine to the axis and to the normal, and the texel's size.
  vec3 ray = perspective ? vec3(q.xy / q.z, 1) : vec3(0, 0, 1);
  float ray_cosine = inversesqrt(dot(ray, ray));
  float n_ray = dot(n, ray);
  float cosine = -n_ray * ray_cosine, tangent = sqrt(max(1 - cosine * cosine, 0)) / cosine;
  vec2 texel_width = (perspective ? q.z : 1) / face.scale;
  float width = max(texel_width.x, texel_width.y), half_diagonal = 0.5 * length(texel_width);

  float bias = depth_bias * width;
  vec2 gradient = vec2(0);  // of the relative depth of the receiver's plane, per texel
  if (bias_mode == slope) bias += slope_bias * half_diagonal * tangent;
  if (bias_mode == normal_offset_bias) q += n * (normal_offset * width);
  if (bias_mode == receiver_plane) {
    float error = rounding * (perspective ? 1 + q.z * q.z / (face.near * face.far) : 1);
    bias += error / cosine + half_diagonal * tangent / 128;
    gradient = n.xy / (n_ray * face.scale);
  }
  float axis_bias = bias * ray_cosine;

  vec2 position = (perspective ? q.xy / q.z : q.xy) * face.scale + face.offset;
  ivec2 center = ivec2(floor(position));
  float lit = 0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      ivec2 texel = center + ivec2(x, y);
      float k = dot(gradient, vec2(texel) + 0.5 - position);
      float expected = !perspective ? q.z - k : k > -1 ? q.z / (1 + k) : infinity;
      lit += stored(face, texel) < expected - axis_bias ? 0 : 1;
    }
  return lit / float((2 * radius + 1) * (2 * radius + 1));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 position = texelFetch(gbuffer_position, pixel, 0), normal = texelFetch(gbuffer_normal, pixel, 0);
  visibility = faces_light(position, normal) ? lookup(position.xyz, normal.xyz) : 1;
}
)";

}  // namespace shadow_map
