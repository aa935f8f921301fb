#pragma once
#include "segment.h"

namespace gnomon::triangle_map {

/// GLSL: ComparedMap::decision, after `segment_snippet` and with LIST_LENGTH. Counts and entries of the lists are in units 4
/// and 5; buffers 0 and 1 hold positions and corners of all triangles of the scene, 2 for each mesh its first triangle, with
/// the highest bit where it is a curved shape, and one more number, that of all triangles.
///
/// A point is looked up where its own segment to the light is, not where a normal offset moves it to. Its segment is that of
/// the reference: it starts 8 * 2^-24 * max|P| above the point, and leaves out the triangle that the point is on, or all of a
/// curved shape. `list_scale` is a power of two, which rounds nothing, and keeps products of three lengths in float32.
inline constexpr std::string_view decision_snippet = R"(
layout(binding = 4) uniform usampler2DArray list_counts;
layout(binding = 5) uniform usampler2DArray list_entries;
layout(std430, binding = 0) readonly buffer ListPositions { float list_positions[]; };
layout(std430, binding = 1) readonly buffer ListCorners { uint list_corners[]; };
layout(std430, binding = 2) readonly buffer ListMeshes { uint list_meshes[]; };
uniform vec4 list_light;  // homogeneous
uniform float list_scale;
uniform int list_sees_shapes;

/// Column, row and layer of the texel at a point; the layer is below 0 beside the image, where nothing that casts is before it.
ivec3 list_place(vec4 surface) {
  vec3 v = surface.xyz - light_origin;
  choose_image(v);
  vec3 h = in_image(v);
#if PROJECTION == 0
  vec2 place = h.xy;
#else
  vec2 place = h.xy / h.z;
#endif
  bool is_inside = all(greaterThanEqual(place, vec2(0))) && all(lessThan(place, vec2(textureSize(light_map, 0).xy)));
  return is_inside ? ivec3(place, light_facts.x) : ivec3(0, 0, -1);
}

uint list_count(ivec3 place) {
  uint count = texelFetch(list_counts, max(place, ivec3(0)), 0).r;
  return place.z < 0 ? 0u : count;
}

vec3 list_position(uint vertex) {
  return vec3(list_positions[3u * vertex], list_positions[3u * vertex + 1u], list_positions[3u * vertex + 2u]);
}

float decided(vec4 surface, vec4 facet, ComparedPoint point) {
  float by_depth = compared(point);
  ivec3 place = list_place(surface);
  uint count = list_count(place);
  if (!point.is_compared || count > uint(LIST_LENGTH)) return by_depth;

  uvec2 ids = ids_here();
  uint mesh = max(ids.x, 1u) - 1u, first = list_meshes[mesh];
  bool is_shape = list_sees_shapes != 0 && first >= 0x80000000u;
  first &= 0x7fffffffu;
  uint own = is_shape ? first : first + ids.y, own_count = is_shape ? (list_meshes[mesh + 1u] & 0x7fffffffu) - first : 1u;

  vec3 size = abs(surface.xyz);
  precise float lift = 4.76837158203125e-7 * max(max(size.x, size.y), size.z);
  precise vec3 start = surface.xyz + lift * facet.xyz;
  precise vec3 way = list_light.xyz - list_light.w * start;
  bool has_end = list_light.w != 0;
  int axis = segment_axis(way);
  vec3 along = segment_turned(way, axis);
  vec3 shear = vec3(along.xy, 1) / along.z;
  if (has_end) shear.z /= list_scale;
  bool is_lit = true;
  for (int k = 0; k < int(count) && is_lit; ++k) {
    uint number = texelFetch(list_entries, ivec3(place.xy, place.z * LIST_LENGTH + k), 0).r;
    if (number - own < own_count) continue;
    vec3 corners[3];
    for (int c = 0; c < 3; ++c) {
      precise vec3 corner = (list_position(list_corners[3u * number + uint(c)]) - start) * list_scale;
      corners[c] = segment_turned(corner, axis);
    }
    is_lit = !segment_meets(corners[0], corners[1], corners[2], shear, has_end);
  }
  return is_lit ? 1 : 0;
}

/// How long the list is that decided; -1: it is not whole.
float noted(vec4 surface, vec4 facet, ComparedPoint point) {
  uint count = list_count(list_place(surface));
  return !point.is_compared ? 0 : count > uint(LIST_LENGTH) ? -1 : float(count);
}
)";

}  // namespace gnomon::triangle_map
