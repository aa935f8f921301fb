#pragma once
#include <gnomon/kit/maps/light_map.h>

#include <bit>

#include "pages.h"

// GLSL of a virtual map. The head defines, beside PROJECTION: PAGE, texels along a page's side, and PAGE_BITS,
// its logarithm; TOP, the level of one page; FINEST, texels along a side of level 0.
namespace gnomon::virtual_map {

inline std::string page_head(int page_size) {
  const int bits = std::countr_zero(static_cast<unsigned>(page_size));
  return fmt::format("#define PAGE {}\n#define PAGE_BITS {}u\n#define TOP {}\n#define FINEST {}\n", page_size, bits,
                     top_level(page_size), finest_side);
}

/// Vertices of casters, into a page. All pages place a vertex at the same texel of level 0, and halving is exact: neighbors
/// disagree about it by no more than the rounding of one subtraction.
inline const std::string page_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 page;  // 2 over its side in texels of level 0; twice its column and row, plus one
uniform mat3 axes;                  // as light_axes
uniform vec3 origin;                // as light_origin
uniform vec4 image;                 // near, far; offset, under parallel rays
invariant gl_Position;
void main() {
  precise vec3 h = axes * (position - origin);
#ifdef PARALLEL
  precise vec2 place = (h.xy + image.zw) * page.x - page.yz;
  gl_Position = vec4(place.x, -place.y, (image.y - h.z) / (image.y - image.x), 1);
#else
  precise vec2 place = h.xy * page.x - page.yz * h.z;
  gl_Position = vec4(place.x, -place.y, image.x, h.z);
#endif
#ifdef MASKED
  hand_on_mask();
#endif
}
)";

/// Beside the camera's constants: one for the look-up.
inline constexpr std::string_view look_up_constants = "vec4 look_up;";

/// Which page each pixel requests, as a PageAddress. The pixel's footprint is exact: its sides are followed along the
/// tangent plane. What that takes comes as uniforms, for a cube leaves one of OpenGL's fifteen flat inputs. The head defines
/// MEASURE: 0 for the shorter side, 1 for the mean.
inline const std::string address_fragment = std::string(gbuffer_snippet) + std::string(light_map_snippet) + R"(
uniform vec4 eye;  // w: logarithm of texels_per_pixel, base 2
uniform vec3 axis, right_step, down_step;  // of the eye; how its ray, 1 along the axis, changes from pixel to pixel
layout(location = 0) out uint address;

/// How a way from v goes in `in_image`.
vec3 along_image(vec3 v, vec3 way) {
#if PROJECTION == 2
  vec3 q = light_is_x ? way.yzx : light_is_y ? way.zxy : way;
  float z = (light_is_x ? v.x : light_is_y ? v.y : v.z) < 0 ? -q.z : q.z;
  return vec3(q.xy * light_window.xy + z * light_window.zw, z);
#else
  return light_axes * way;
#endif
}

void main() {
  vec4 surface = position_here(), facet = normal_here();
  vec3 v = surface.xyz - light_origin, ray = surface.xyz - eye.xyz;
  choose_image(v);
  vec3 h = in_image(v);
  float distance = dot(ray, axis);
  // What the eye sees more edge-on than 2^-20 is taken for that.
  float slope = min(dot(facet.xyz, ray), -9.5367432e-7 * distance);
  vec3 right = along_image(v, distance * (right_step - ray * (dot(facet.xyz, right_step) / slope)));
  vec3 down = along_image(v, distance * (down_step - ray * (dot(facet.xyz, down_step) / slope)));
#if PROJECTION == 0
  vec2 position = h.xy, a = right.xy, b = down.xy;
#else
  float per_z = 1 / h.z;
  vec2 position = h.xy * per_z, a = (right.xy - position * right.z) * per_z, b = (down.xy - position * down.z) * per_z;
#endif
  // Texels of level 0 along a pixel: singular values of the matrix (a b).
  float sum = length(vec2(a.x + b.y, b.x - a.y)), difference = length(vec2(a.x - b.y, b.x + a.y));
  float longer = (sum + difference) / 2, shorter = abs(sum - difference) / 2;
  float texels = MEASURE == 0 ? max(shorter, longer / 8) : sqrt(longer * shorter);
  float level = clamp(floor(log2(max(texels, 1e-30)) - eye.w), 0, TOP);
  bool inside = all(greaterThanEqual(position, vec2(0))) && all(lessThan(position, vec2(FINEST)));
  uvec2 page = uvec2(position) >> (uint(level) + PAGE_BITS);
  uint face = 0;
#if PROJECTION == 2
  face = light_is_x ? v.x < 0 ? 1 : 0 : light_is_y ? v.y < 0 ? 3 : 2 : v.z < 0 ? 5 : 4;
#endif
  uint word = 0x80000000u | face << 26 | uint(level) << 22 | page.y << 11 | page.x;
  address = inside && faces_light_at(surface, facet, v) ? word : 0;
}
)";

/// The comparison of shadow_map with bias=receiver_plane, with one texel of the pixel's page. `look_up` is depth_bias,
/// rounding, and the levels that pages were raised by. The last of an image's facts is far (parallel rays), or the rounding
/// error of the depth per squared axis distance. With EXPLAIN it writes where it looked, in texels of the level, and what is
/// stored there.
inline const std::string look_up_fragment = std::string(gbuffer_snippet) + std::string(light_map_snippet) + R"(
layout(binding = 4) uniform usampler2D addresses;
layout(binding = 5) uniform usampler2D places;  // of pages in the pool: layer, row, column
#ifdef EXPLAIN
layout(location = 0) out vec4 looked_up;
#else
layout(location = 0) out float visibility;
#endif
void main() {
  vec4 surface = position_here(), facet = normal_here();
  uint address = textureLod(addresses, gbuffer_place(), 0).x, place = textureLod(places, gbuffer_place(), 0).x;
  vec3 v = surface.xyz - light_origin;
  choose_image(v);
  vec3 h = in_image(v);
  float q_z = h.z;
#if PROJECTION == 0
  vec2 position = h.xy;
  float facing = height_over_light(facet.xyz), width = light_facts.y;
#else
  float per_z = 1 / q_z;
  vec2 position = h.xy * per_z;
  float facing = -dot(facet.xyz, v) * per_z, width = q_z * light_facts.y;
#endif
  int asked = int(address >> 22 & 15u), level = min(asked + int(look_up.z), TOP);
  float grow = float(1 << level);
  position /= grow;
  width *= grow;
  // Its page is the one that was requested, whatever rounding says here.
  ivec2 page = ivec2(address & 2047u, address >> 11 & 2047u) >> (level - asked);
  ivec2 texel = clamp(ivec2(position) - page * PAGE, 0, PAGE - 1);
  ivec2 slot = ivec2(place & 255u, place >> 8 & 255u);
  float stored = texelFetch(light_map, ivec3(slot * PAGE + texel, int(place >> 16)), 0).r;

  float error = look_up.y + width * 0.0078125, bias = look_up.x * width, near = light_facts.z;
#if PROJECTION != 0
  error += light_facts.w * q_z * q_z;
#endif
  float depth = q_z * facing - error;
  vec2 aside = vec2(page * PAGE + texel) + 0.5 - position;
  float rise = dot(across_image(facet.xyz) * grow, aside);
#if PROJECTION == 0
  float far = light_facts.w;
  bool dark = stored > 0 && stored * (far - near) * facing > far * facing - depth - rise + bias * facing;
#else
  float m = max(facing - rise, 0);
  bool dark = near * m < (depth - bias * m) * stored;
#endif
#ifdef EXPLAIN
  looked_up = vec4(page * PAGE + texel, stored, 0);
#else
  visibility = address != 0 && dark ? 0 : 1;
#endif
}
)";

}  // namespace gnomon::virtual_map
