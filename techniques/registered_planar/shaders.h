#pragma once
#include <gnomon/kit/gl/gl_planes.h>

namespace registered_planar {

/// What a point of the light counts at a place of a sheet, as PointWeights has it: 1 of a flat light; `sphere` is its center
/// and one over its radius, 0 of a flat light. Nearer than its surface there are no places.
inline constexpr std::string_view weight_snippet = R"(
uniform vec3 corner, step_x, step_y, light_point;
uniform vec4 sphere;
float weight_here() {
  if (sphere.w == 0) return 1;
  vec3 place = corner + gl_FragCoord.x * step_x + gl_FragCoord.y * step_y;
  vec3 to_center = sphere.xyz - place, to = light_point - place;
  float square = dot(to_center, to_center), radius = 1 / sphere.w;
  float disc = (square - radius * radius) * inversesqrt(square);
  if (!(disc > 0)) return 0;
  float facing = -dot(light_point - sphere.xyz, to) * sphere.w / disc;
  float along = dot(to, to_center) * inversesqrt(square) / disc;
  return facing > 0 && along > 0 ? facing / (along * along * along) : 0;
}
)";

/// Adds what is hidden of a point of the light: red; and all of it, where `counts` is 1: green.
inline const std::string add_fragment = std::string(weight_snippet) + R"(
uniform vec2 adds;
layout(location = 0) out vec2 sums;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  sums = adds * weight_here();
}
)";

/// The same from a picture of what casters let through of that point, with opaque casters and glass.
inline const std::string add_shares_fragment = std::string(weight_snippet) + R"(
layout(binding = 0) uniform sampler2D shares;
uniform vec2 adds;
layout(location = 0) out vec2 sums;
void main() {
  float hidden = 1 - texelFetch(shares, ivec2(gl_FragCoord.xy), 0).r;
  sums = vec2(adds.x * hidden, adds.y) * weight_here();
}
)";

/// Of each sheet: its corner and how many points of the light are on its side, 0 where green has their sum; texels a meter
/// along its sides.
struct SheetData {
  glm::vec4 corner, to_x, to_y;
};
/// Of each plane: its two sheets, of the side that its normal shows and of the other; no_plane where no point of the light is
/// on that side.
struct PlaneData {
  glm::vec4 plane;
  glm::uvec4 sheets;
};

inline constexpr std::string_view look_up_constants = "vec4 front; vec4 round; float shows_texels;";
/// `front` is the plane of a one-sided light, else 0; `round` a sphere's center and radius, else a radius below 0. Where
/// `shows_texels` is not 0, a pixel on a sheet has the share of its nearest texel, and 2 more, or 4, in turn as on a
/// chessboard.
inline const std::string look_up_fragment =
    std::string(gnomon::gbuffer_snippet) + std::string(gnomon::plane_lookup_snippet) + R"(
struct Plane { vec4 plane; uvec4 sheets; };
struct Sheet { vec4 corner, to_x, to_y; };
layout(std430, binding = 2) readonly buffer Planes { Plane planes[]; };
layout(std430, binding = 3) readonly buffer Sheets { Sheet sheets[]; };
layout(binding = 4) uniform sampler2DArray sums;
layout(location = 0) out float visibility;
void main() {
  visibility = 1;
  vec4 position = position_here(), normal = normal_here();
  if (position.w * normal.w == 0) return;
  // Behind a one-sided light, or inside a sphere.
  if (dot(front.xyz, position.xyz) + front.w < 0 || distance(round.xyz, position.xyz) <= round.w) return;
  uint on = receiver_plane(ids_here());
  if (on == 0xffffffffu) return;
  Plane plane = planes[on];
  uint sheet = dot(plane.plane.xyz, normal.xyz) > 0 ? plane.sheets.x : plane.sheets.y;
  if (sheet == 0xffffffffu) return;
  Sheet s = sheets[sheet];
  ivec2 last = textureSize(sums, 0).xy - 1;
  vec3 off = position.xyz - s.corner.xyz;
  vec2 at = vec2(dot(s.to_x.xyz, off), dot(s.to_y.xyz, off)) - 0.5;
  ivec2 low = ivec2(floor(at));
  vec2 part = at - vec2(low);
  if (shows_texels != 0) part = step(vec2(0.5), part);
  ivec4 box = clamp(ivec4(low, low + 1), ivec4(0), last.xyxy);
  vec2 a = mix(texelFetch(sums, ivec3(box.xy, sheet), 0).xy, texelFetch(sums, ivec3(box.zy, sheet), 0).xy, part.x);
  vec2 b = mix(texelFetch(sums, ivec3(box.xw, sheet), 0).xy, texelFetch(sums, ivec3(box.zw, sheet), 0).xy, part.x);
  vec2 sum = mix(a, b, part.y);
  float all = s.corner.w > 0 ? s.corner.w : sum.y;
  visibility = all > 0 ? clamp(1 - sum.x / all, 0, 1) : 1;
  if (shows_texels != 0) visibility += ((low.x + low.y + int(part.x + part.y)) & 1) == 0 ? 2 : 4;
}
)";

}  // namespace registered_planar
