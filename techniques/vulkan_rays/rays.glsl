// What both ways of tracing share: the pixel, the ray of the reference (docs/method.md), and the places of a light with area.
// The file that includes this has `bool is_blocked(vec3 start, vec3 way, float end, uvec2 own)` before it.

const uint sees_shapes = 1u, is_area_light = 2u, is_one_sided = 4u;
const int rectangle = 0, disc = 1, sphere = 2;
const float half_ulp = 5.9604644775390625e-8;  // 2^-24

layout(set = 0, binding = 1, std430) readonly buffer Positions { vec4 positions[]; };
layout(set = 0, binding = 2, std430) readonly buffer Normals { vec4 normals[]; };
layout(set = 0, binding = 3, std430) readonly buffer Ids { uvec2 ids[]; };
// Of each mesh its first triangle that casts, how many do, and 1 where it is curved.
layout(set = 0, binding = 4, std430) readonly buffer Meshes { uvec4 meshes[]; };
layout(set = 0, binding = 5, std430) writeonly buffer Mask { float mask[]; };
layout(set = 0, binding = 6, std430) writeonly buffer RayCounts { uint ray_counts[]; };
// Of the square -1 .. 1 or of the unit disc, set after set.
layout(set = 0, binding = 7, std430) readonly buffer Places { vec2 places[]; };
layout(push_constant) uniform Frame {
  vec4 light, spot;
  vec4 center;  // of a light with area; its radius
  vec4 half_u;  // of a rectangle; the front of a disc
  vec4 half_v;
  float scale;
  uint width, height;
  int samples;
  uint facts;
  int form;
};

// Means what gnomon::faces_light means; a pixel that faces the light less than float32 tells is no pixel to decide.
bool faces_light(vec4 position, vec4 normal) {
  vec3 to_light = light.xyz - light.w * position.xyz;
  float squared = dot(to_light, to_light), height = dot(normal.xyz, to_light), along = -dot(to_light, spot.xyz);
  return position.w * normal.w * height > 0.0 && height * height > squared * 2.2737368e-13 && along >= 0.0 &&
         along * along >= spot.w * squared;
}

// The triangles that no ray from this pixel meets: the first one, and how many.
uvec2 own_triangles(uint pixel) {
  uvec2 id = ids[pixel];
  uvec4 mesh = meshes[id.x - 1u];
  bool is_on_shape = (facts & sees_shapes) != 0u && mesh.z != 0u;
  return mesh.y == 0u ? uvec2(0u) : is_on_shape ? mesh.xy : uvec2(mesh.x + id.y, 1u);
}

// Division by a power of two rounds nothing; a way of no length is none.
bool is_way_blocked(vec3 lifted, vec3 whole_way, bool ends, uvec2 own) {
  vec3 ways = abs(whole_way);
  float unit = uintBitsToFloat(floatBitsToUint(max(ways.x, max(ways.y, ways.z))) & 0x7f800000u);
  if (!(unit > 0.0)) return false;
  return is_blocked(scale * lifted, whole_way / unit, ends ? min(scale * unit, 3.402823466e38) : 3.402823466e38, own);
}

float longest(vec3 point) {
  vec3 size = abs(point);
  return max(size.x, max(size.y, size.z));
}

// What the light turns to a point: gnomon::LightFigure.
struct Figure {
  vec3 center, half_u, half_v;
  bool is_disc, is_seen;
};

Figure figure_from(vec3 point, vec3 normal) {
  Figure f = Figure(center.xyz - point, half_u.xyz, half_v.xyz, form != rectangle, false);
  vec3 front = half_u.xyz;
  if (f.is_disc) {
    float radius = center.w;
    vec3 axis = half_u.xyz;
    if (form == sphere) {
      // Tangents from the distance d touch a sphere of radius r in a circle at d - r^2 / d, of radius r sqrt(1 - r^2 / d^2).
      float square = dot(f.center, f.center), share = radius * radius / square;
      if (!(share < 1.0)) return f;
      axis = f.center / sqrt(square);
      f.center *= 1.0 - share;
      radius *= sqrt(1.0 - share);
    }
    vec3 a = abs(axis), level = cross(normal, axis);
    if (!(dot(level, level) > 1e-12))
      level = cross(a.x <= a.y && a.x <= a.z ? vec3(1, 0, 0) : a.y <= a.z ? vec3(0, 1, 0) : vec3(0, 0, 1), axis);
    vec3 side = normalize(level);
    f.half_u = radius * cross(axis, side);
    f.half_v = radius * side;
    if (dot(f.half_u, normal) < 0.0) f.half_u = -f.half_u;
  } else {
    front = cross(f.half_u, f.half_v);
  }
  float before = form == sphere ? 1.0 : -dot(front, f.center);
  f.is_seen = (facts & is_one_sided) != 0u ? before > 0.0 : before != 0.0;
  return f;
}

// The share of the light's area that is seen. Places below the horizon are none of it.
void answer_area(uint pixel, uvec2 at) {
  vec4 position = positions[pixel], normal = normals[pixel];
  float share = 1.0;
  uint asked = 0u, hidden = 0u;
  if (position.w * normal.w > 0.0) {
    Figure f = figure_from(position.xyz, normal.xyz);
    precise vec3 lift = 2.0 * half_ulp * longest(position.xyz) * normal.xyz;
    precise vec3 lifted = position.xyz + lift;
    vec3 horizon = vec3(dot(normal.xyz, f.center), dot(normal.xyz, f.half_u), dot(normal.xyz, f.half_v));
    if (f.is_disc) horizon.yz = vec2(length(horizon.yz), 0.0);
    uvec2 own = own_triangles(pixel);
    uint first = (at.y % 4u * 4u + at.x % 4u) * uint(samples);  // of sixteen sets: gnomon::interleaved_set
    for (uint k = first; f.is_seen && k < first + uint(samples); ++k) {
      vec2 place = places[k];
      if (!(horizon.x + horizon.y * place.x + horizon.z * place.y > 0.0)) continue;
      ++asked;
      if (is_way_blocked(lifted, f.center + place.x * f.half_u + place.y * f.half_v - lift, true, own)) ++hidden;
    }
  }
  if (asked > 0u) share = 1.0 - float(hidden) / float(asked);
  mask[pixel] = share;
  ray_counts[pixel] = asked;
}

void answer_point(uint pixel) {
  vec4 position = positions[pixel], normal = normals[pixel];
  bool has_ray = faces_light(position, normal), blocked = false;
  if (has_ray) {
    precise vec3 lifted = position.xyz + 8.0 * half_ulp * longest(position.xyz) * normal.xyz;
    precise vec3 whole_way = light.xyz - light.w * lifted;
    blocked = is_way_blocked(lifted, whole_way, light.w != 0.0, own_triangles(pixel));
  }
  mask[pixel] = blocked ? 0.0 : 1.0;
  ray_counts[pixel] = has_ray ? 1u : 0u;
}

void answer_pixel(uvec2 at) {
  if (at.x >= width || at.y >= height) return;
  uint pixel = at.y * width + at.x;
  if ((facts & is_area_light) != 0u)
    answer_area(pixel, at);
  else
    answer_point(pixel);
}
