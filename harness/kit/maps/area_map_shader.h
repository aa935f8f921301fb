#pragma once
#include <string_view>

namespace gnomon {

/// The nearest depth of each block of 8 x 8 texels.
inline constexpr std::string_view nearest_fragment = R"(
layout(binding = 3) uniform sampler2DArray light_map;
uniform int layer;
layout(location = 0) out float nearest;
void main() {
  ivec2 first = 8 * ivec2(gl_FragCoord.xy), last = textureSize(light_map, 0).xy - 1;
  nearest = 0;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      nearest = max(nearest, texelFetch(light_map, ivec3(min(first + ivec2(x, y), last), layer), 0).r);
}
)";

/// A point and functions of it; AreaPoint has the meaning of each quantity. FIGURE is 0 for a rectangle, 1 for a disc.
inline constexpr std::string_view area_map_snippet = R"(
layout(binding = 4) uniform sampler2DArray light_blocks;
uniform vec3 area_half_u, area_half_v;  // of a flat light
uniform vec4 area_figure;               // its unit axis; the radius of a sphere, else 0
uniform vec4 area_look_up;              // depth bias in texels, rounding, most radius, 1 where the light is of one side

struct Point {
  vec2 position;
  float z, facing;
  vec2 step_height;
  float depth, bias;
  mat2 figure;
  vec2 tilt;
  vec3 horizon;
  vec2 reach;
};

float spread_of(Point p, float stored) { return stored / light_facts.z - 1 / p.z; }
/// What the margin has room for.
float most_spread(Point p) { return area_look_up.z / max(p.reach.x, p.reach.y); }
vec2 offset_of(Point p, float spread, vec2 place) { return spread / max(1 - dot(p.tilt, place), 0.25) * (p.figure * place); }
float height_of(Point p, vec2 place) { return p.horizon.x + dot(p.horizon.yz, place); }

bool is_hidden_by(Point p, vec2 texel, float stored) {
  float near = light_facts.z, m = p.facing - dot(p.step_height, texel + 0.5 - p.position);
  return near * m < (p.depth - p.bias * abs(m)) * stored && near < p.z * stored;
}

/// The nearest depth of the blocks that hold texels up to `radius` away.
float nearest_in(Point p, vec2 radius) {
  ivec2 size = textureSize(light_blocks, 0).xy;
  vec2 first = clamp(floor((p.position - radius) / 8), vec2(0), vec2(size)), last = min(floor((p.position + radius) / 8), vec2(size) - 1);
  float nearest = 0;
  for (float y = first.y; y <= last.y; ++y)
    for (float x = first.x; x <= last.x; ++x)
      nearest = max(nearest, texelFetch(light_blocks, ivec3(x, y, light_facts.x), 0).r);
  return nearest;
}
void shrink(inout Point p, float spread) {
  float share = min(1, most_spread(p) / max(spread, 1e-30));
  p.figure *= share;
  p.tilt *= share;
  p.reach *= share;
  p.horizon.yz *= share;
}
/// The largest spread that matters at the point: that of the nearest caster in reach. 0 or less: there is none. Where it is
/// more than the margin has room for, the light counts as smaller.
float searched_spread(inout Point p) {
  float most = most_spread(p), spread = 1 / light_facts.z - 1 / p.z;
  for (int k = 0; k < 2; ++k)
    spread = min(spread, spread_of(p, nearest_in(p, p.reach * clamp(spread, 0, most))));
  shrink(p, spread);
  return spread;
}

vec3 in_frame(vec3 d, float along) {
  vec3 q = light_is_x ? d.yzx : light_is_y ? d.zxy : d;
  return vec3(q.xy, along * q.z);
}

Point point_here(out bool faces) {
  vec4 surface = position_here(), facet = normal_here();
  vec3 v = surface.xyz - light_origin, normal = facet.xyz;
  choose_image(v);
  float along = (light_is_x ? v.x : light_is_y ? v.y : v.z) < 0 ? -1 : 1;
  vec3 h = in_image(v), q = in_frame(v, along), n = in_frame(normal, along);
  Point p;
  p.z = h.z;
  float per_z = 1 / h.z, squared = dot(v, v), height = -dot(normal, v);
  p.position = h.xy * per_z;
  p.facing = height * per_z;
  p.step_height = across_image(normal);
  float width = p.z * light_facts.y;
  p.depth = height - (area_look_up.y + width * 0.0078125 + light_facts.w * p.z * p.z);
  p.bias = area_look_up.x * width;

  vec3 ray = q * per_z, u = in_frame(area_half_u, along), w = in_frame(area_half_v, along);
#if FIGURE == 1
  float radius = area_figure.w;
  if (radius > 0) {
    float around = radius * inversesqrt(max(1 - radius * radius / squared, 1e-6));
    u = normalize(vec3(0, 1, -ray.y));
    w = normalize(cross(ray, u)) * around;
    u *= around;
  }
#endif
  p.figure = mat2((u.xy - ray.xy * u.z) * light_window.xy, (w.xy - ray.xy * w.z) * light_window.xy);
  p.tilt = vec2(u.z, w.z) * per_z;
  p.horizon = vec3(height, dot(n, u), dot(n, w));
#if FIGURE == 1
  p.reach = sqrt(p.figure[0] * p.figure[0] + p.figure[1] * p.figure[1]);
  float tilt = length(p.tilt), rise = length(p.horizon.yz);
#else
  p.reach = abs(p.figure[0]) + abs(p.figure[1]);
  float tilt = abs(p.tilt.x) + abs(p.tilt.y), rise = abs(p.horizon.y) + abs(p.horizon.z);
#endif
  p.reach /= max(1 - tilt, 0.25);

  // What faces_light says; false within rounding of where it changes.
  float slack = 4.7683716e-7 * (sqrt(squared) + length(u) + length(w)), before = dot(area_figure.xyz, v);
  faces = surface.w * facet.w > 0 && height + rise > slack;
#if FIGURE == 1
  if (radius > 0)
    faces = faces && squared > radius * radius * 1.000001;
  else
#endif
    faces = faces && (area_look_up.w > 0 ? before : abs(before)) > slack;
  return p;
}
)";

inline constexpr std::string_view area_map_main = R"(
#ifdef EXPLAIN
layout(location = 0) out vec4 written;
#else
layout(location = 0) out float visibility;
#endif
void main() {
  bool faces;
  Point p = point_here(faces);
  vec4 account;
  float share = share_seen(p, account);
#ifdef EXPLAIN
  written = account;
#else
  visibility = faces && share < 1 ? max(share, 0) : 1;
#endif
}
)";

}  // namespace gnomon
