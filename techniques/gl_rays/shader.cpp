#include "shader.h"

#include <gnomon/kit/geometry/first_triangles.h>
#include <gnomon/kit/gl/gl_pass.h>

namespace gnomon::gl_rays {

const std::string triangle_snippet = R"(
int ray_axis(vec3 way) {
  vec3 a = abs(way);
  return a.x > a.y && a.x > a.z ? 0 : a.y > a.z ? 1 : 2;
}
vec3 turned(vec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
vec2 ray_shear(vec3 way) {
  precise vec2 shear = way.xy / way.z;
  return shear;
}
vec3 edge_functions(vec3 a, vec3 b, vec3 c, vec2 shear) {
  precise vec2 p = a.xy - shear * a.z;
  precise vec2 q = b.xy - shear * b.z;
  precise vec2 r = c.xy - shear * c.z;
  precise float u = r.x * q.y - r.y * q.x;
  precise float v = p.x * r.y - p.y * r.x;
  precise float w = q.x * p.y - q.y * p.x;
  return vec3(u, v, w);
}
bool is_inside(vec3 edges) {
  precise float sum = edges.x + edges.y + edges.z;
  return sum != 0.0 && !(any(lessThan(edges, vec3(0.0))) && any(greaterThan(edges, vec3(0.0))));
}
bool is_between(dvec3 a, dvec3 b, dvec3 c, dvec3 start, dvec4 light) {
  bool is_at_corner = light.w != 0.0 && (a == light.xyz || b == light.xyz || c == light.xyz);
  dvec3 normal = cross(b - a, c - a);
  return !is_at_corner && dot(normal, a - start) * dot(normal, light.xyz - light.w * a) > 0.0;
}
)";

namespace {

constexpr std::string_view inputs = R"(
layout(local_size_x = GROUP_SIDE, local_size_y = GROUP_SIDE) in;
layout(binding = 0) uniform sampler2D gbuffer_position;
layout(binding = 1) uniform sampler2D gbuffer_normal;
layout(binding = 2) uniform usampler2D gbuffer_ids;
layout(binding = 0, r32f) writeonly uniform image2D mask;
layout(binding = 1, r32f) writeonly uniform image2D box_counts;
layout(binding = 2, rgba32ui) readonly uniform uimageBuffer nodes;    // two a node: low, skip; high, leaf
layout(binding = 3, rgba32ui) readonly uniform uimageBuffer corners;  // place, tag
layout(std430, binding = 0) readonly buffer Meshes { uint firsts[]; };
uniform vec4 light, spot;
uniform float scale;
uniform int node_count;
uniform bool sees_shapes;
)";

// The texel where the line of a ray meets a triangle's plane, in double: weights of the corners are signed volumes of the line
// with the edges across from them (kit/geometry/holes.cpp). The place in a mask is looked up along the ray, that in glass along
// the line from the point to the light.
constexpr std::string_view textures_source = R"(
layout(std430, binding = 3) readonly buffer Triangles { uint vertices[]; };
layout(std430, binding = 4) readonly buffer Places { vec2 uv[]; };
layout(std430, binding = 6) readonly buffer Transmissions { uint transmission_words[]; };
layout(std430, binding = 7) readonly buffer AlphaMasks { uint mask_words[]; };

vec3 corner_at(int place) { return uintBitsToFloat(imageLoad(corners, place).xyz); }
dvec3 line_weights(int place, dvec3 start, dvec3 way) {
  dvec3 a = dvec3(corner_at(place)) - start, b = dvec3(corner_at(place + 1)) - start, c = dvec3(corner_at(place + 2)) - start;
  return dvec3(dot(way, cross(b, c)), dot(way, cross(c, a)), dot(way, cross(a, b)));
}
dvec2 texel_place(int place, dvec3 weights, ivec2 size) {
  uint first = 3u * imageLoad(corners, place).w;
  dvec2 sum = weights.x * dvec2(uv[vertices[first]]) + weights.y * dvec2(uv[vertices[first + 1u]]) +
              weights.z * dvec2(uv[vertices[first + 2u]]);
  return sum * dvec2(size) / (weights.x + weights.y + weights.z);
}
bool is_texel(dvec2 at) { return all(lessThan(abs(at), dvec2(1e9))); }
uint wrapped(int place, int size, uint wrap) {
  if (wrap == 2u) return uint(clamp(place, 0, size - 1));
  int period = wrap == 1u ? 2 * size : size;
  int rest = place < 0 ? period - 1 - (-1 - place) % period : place % period;
  return uint(rest < size ? rest : period - 1 - rest);
}
bool is_hole(int place, vec3 start, vec3 way) {
  int number = int(imageLoad(corners, place + 1).w);
  if (number < 0) return false;
  uint facts = 8u * uint(number);
  ivec2 size = ivec2(mask_words[facts], mask_words[facts + 1u]);
  dvec2 at = texel_place(place, line_weights(place, dvec3(start), dvec3(way)), size);
  if (!is_texel(at)) return false;
  ivec2 texel = ivec2(floor(at));
  uint column = wrapped(texel.x, size.x, mask_words[facts + 2u]), row = wrapped(texel.y, size.y, mask_words[facts + 3u]);
  uint word = mask_words[mask_words[facts + 5u] + row * mask_words[facts + 4u] + (column >> 5u)];
  return (word >> (column & 31u) & 1u) == 0u;
}
double let_through(int place, dvec3 point) {
  int number = int(imageLoad(corners, place + 2).w);
  if (number < 0) return 0.0;
  uint facts = 8u * uint(number), texel_number = 0u;
  ivec2 size = ivec2(transmission_words[facts], transmission_words[facts + 1u]);
  if (size != ivec2(1)) {
    dvec3 start = double(scale) * point, way = dvec3(light.xyz) - double(light.w) * point;
    dvec2 at = texel_place(place, line_weights(place, start, way), size);
    if (is_texel(at)) {
      ivec2 texel = ivec2(floor(at));
      uint column = wrapped(texel.x, size.x, transmission_words[facts + 2u]);
      texel_number = wrapped(texel.y, size.y, transmission_words[facts + 3u]) * uint(size.x) + column;
    }
  }
  uint word = transmission_words[facts + 5u] + texel_number * transmission_words[facts + 4u];
  return double(uintBitsToFloat(transmission_words[word]));
}
)";

// The ray of the reference (docs/method.md): from the point, lifted, along `way` with its longest component at 1 to 2, up to
// `end`. Division by a power of two rounds nothing.
//
// Boxes until a leaf is met, then its triangles: where invocations run in step, all of them pay for a branch that one of them
// takes, but leave a loop together (Aila and Laine 2009).
constexpr std::string_view trace_body = R"(
void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(mask)))) return;
  vec4 position = texelFetch(gbuffer_position, pixel, 0), normal = texelFetch(gbuffer_normal, pixel, 0);
  vec3 size = abs(position.xyz);
  precise vec3 lifted = position.xyz + 4.76837158203125e-7 * max(size.x, max(size.y, size.z)) * normal.xyz;
  precise vec3 whole_way = light.xyz - light.w * lifted;
  vec3 start = scale * lifted, ways = abs(whole_way);
  float unit = uintBitsToFloat(floatBitsToUint(max(ways.x, max(ways.y, ways.z))) & 0x7f800000u);
  vec3 way = whole_way / unit;
  float end = light.w != 0.0 ? scale * unit : 3.402823466e38;
  bool has_ray = faces_light(position, normal) && unit > 0.0;

  uvec2 ids = texelFetch(gbuffer_ids, pixel, 0).xy;
  uint first_own = 0u, own_count = 0u;
  if (has_ray) {
    uint mesh = ids.x - 1u, first = firsts[mesh];
    bool is_on_shape = sees_shapes && (first & SHAPE_BIT) != 0u;
    first_own = (first & ~SHAPE_BIT) + (is_on_shape ? 0u : ids.y);
    own_count = is_on_shape ? (firsts[mesh + 1u] & ~SHAPE_BIT) - first_own : 1u;
  }

  int axis = ray_axis(way);
  vec2 shear = ray_shear(turned(way, axis));
  dvec3 from = dvec3(start);
  dvec4 to = dvec4(double(scale) * dvec3(light.xyz), light.w);
  // As Embree does: no component is below 1e-18.
  vec3 inverse = 1.0 / mix(way, vec3(way.x < 0.0 ? -1e-18 : 1e-18, way.y < 0.0 ? -1e-18 : 1e-18, way.z < 0.0 ? -1e-18 : 1e-18),
                           lessThan(abs(way), vec3(1e-18)));
  bvec3 turns = lessThan(inverse, vec3(0.0));
  int boxes = 0, i = has_ray ? 0 : node_count;
  SHARE share = SHARE(1.0);
  while (i < node_count) {
    int leaf = -1;
    while (i < node_count) {
      uvec4 low = imageLoad(nodes, 2 * i), high = imageLoad(nodes, 2 * i + 1);
      ++boxes;
      vec3 enter = (uintBitsToFloat(mix(low.xyz, high.xyz, turns)) - start) * inverse;
      vec3 leave = (uintBitsToFloat(mix(high.xyz, low.xyz, turns)) - start) * inverse;
      // A parameter errs by less than 4 * 2^-24 of itself.
      bool is_in = max(max(enter.x, enter.y), max(enter.z, 0.0)) <=
                   min(min(leave.x, leave.y), min(leave.z, end)) * (1.0 + 9.5367431640625e-7);
      int held = int(high.w);
      i = is_in && held < 0 ? i + 1 : int(low.w);
      if (is_in && held >= 0) {
        leaf = held;
        break;
      }
    }
    if (leaf < 0) break;
    for (int place = 3 * (leaf >> 4), last = place + 3 * (leaf & 15); place < last; place += 3) {
      uvec4 first = imageLoad(corners, place);
      vec3 first_corner = uintBitsToFloat(first.xyz);
      vec3 second_corner = uintBitsToFloat(imageLoad(corners, place + 1).xyz);
      vec3 third_corner = uintBitsToFloat(imageLoad(corners, place + 2).xyz);
      precise vec3 a = turned(first_corner - start, axis);
      precise vec3 b = turned(second_corner - start, axis);
      precise vec3 c = turned(third_corner - start, axis);
      if (first.w - first_own < own_count || !is_inside(edge_functions(a, b, c, shear))) continue;
      if (!is_between(dvec3(first_corner), dvec3(second_corner), dvec3(third_corner), from, to)) continue;
#if TEXTURES
      if (is_hole(place, start, way)) continue;
      share *= let_through(place, dvec3(position.xyz));
      if (share > 0.0) continue;
#else
      share = 0.0;
#endif
      i = node_count;
      break;
    }
  }
  imageStore(mask, pixel, vec4(float(share)));
  imageStore(box_counts, pixel, vec4(float(boxes)));
}
)";

}  // namespace

std::string trace_source(bool textures) {
  return fmt::format("#define GROUP_SIDE {}\n#define SHAPE_BIT {}u\n#define TEXTURES {}\n#define SHARE {}\n{}{}{}{}{}",
                     group_side, shape_bit, int{textures}, textures ? "double" : "float", inputs, faces_light_snippet,
                     triangle_snippet, textures ? textures_source : "", trace_body);
}

}  // namespace gnomon::gl_rays
