#pragma once
#include <string_view>

namespace gnomon::paraboloid_map {

// Coordinates of an image: `face_axes` has right, down and the axis of its half space as rows. A point q there lies at
// q.xy / (|q| + q.z), in the unit circle where q.z >= 0. Numerator and denominator are the clip position, so that a triangle
// that comes from behind is cut where it enters, and depth is that of the point that the rasterizer finds: edges stay straight
// lines, which is the error of the method.
inline constexpr std::string_view vertex = R"(
layout(location = 0) in vec3 position;
uniform vec3 map_light;
uniform mat3 face_axes;
uniform float circle;  // radius of the unit circle's image, in half images
out vec3 from_light;
void main() {
  vec3 q = transpose(face_axes) * (position - map_light);
  float w = length(q) + q.z;
  from_light = q;
  gl_ClipDistance[0] = q.z + 0.1 * length(q);  // some of what is behind, for texels on the circle
  gl_Position = vec4(circle * q.x, -circle * q.y, 0.5 * w, w);
#ifdef MASKED
  hand_on_mask();
#endif
}
)";
inline constexpr std::string_view fragment = R"(
in vec3 from_light;
uniform float nearest;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  gl_FragDepth = nearest / length(from_light);
}
)";

// Image 0 is in front of the axis, image 1 behind it. `image` has texels to the unit of a paraboloid's plane, half of a side,
// and the nearest distance; `biases` those of MapBias, in widths of a texel.
inline constexpr std::string_view constants = "vec3 map_light; mat3 axes; vec3 image; vec2 biases;";
inline constexpr std::string_view look_up = R"(
layout(binding = 3) uniform sampler2DArray distances;
layout(location = 0) out vec4 result;
void main() {
  vec4 surface = position_here(), facet = normal_here();
  vec3 v = surface.xyz - map_light, q = transpose(axes) * v;
  float r = length(q), facing = -dot(facet.xyz, v) / r;
  vec2 p = q.xy / (r + abs(q.z)), texel = floor(p * image.x + image.y);
  float stored = texelFetch(distances, ivec3(texel, q.z < 0 ? 1 : 0), 0).r;
  // All is multiplied by the facing, which a slope would be divided by.
  float width = 2 * r / ((1 + dot(p, p)) * image.x);
  float bias = width * (biases.x * facing + biases.y * sqrt(max(1 - facing * facing, 0)));
  bool is_dark = faces_light(surface, facet) && image.z * facing < (r * facing - bias) * stored;
#ifdef EXPLAINS
  result = vec4(texel, q.z < 0 ? 1 : 0, stored);
#else
  result = vec4(is_dark ? 0 : 1);
#endif
}
)";

}  // namespace gnomon::paraboloid_map
