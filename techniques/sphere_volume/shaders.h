#pragma once
#include <gnomon/kit/gl/gl_pass.h>

namespace sphere_volume {

/// Homogeneous vertices of volumes.
inline const std::string volume_vertex = std::string(gnomon::position_snippet) + R"(
layout(location = 1) in vec4 vertex;
void main() { gl_Position = place(vertex); }
)";

inline constexpr int kind_count = 3;  // sphere, cone, disc

/// Mirrors Body in the shader below.
struct alignas(16) BodyData {
  glm::vec4 place;  ///< center or base, radius
  glm::vec4 along;  ///< unit axis or normal, height
  std::uint32_t own_mesh;
};
inline gnomon::GlLimits bodies_need(std::size_t count) {
  return {.fragment_storage_blocks = 1,
          .storage_bindings = 1,
          .storage_block_bytes = static_cast<std::int64_t>(count * sizeof(BodyData))};
}

inline const gnomon::PassConstants exact_constants("vec4 light;");

/// The same, and the body that the volume bounds.
inline const std::string bounding_vertex = std::string(gnomon::position_snippet) + exact_constants.vertex + R"(
layout(location = 1) in vec4 vertex;
layout(location = 2) in uint body_of;
struct Body { vec4 place, along; uint own_mesh; };
layout(std430, binding = 0) readonly buffer Bodies { Body bodies[]; };
flat out vec4 body_place, body_along;
flat out uint own_mesh;
void main() {
  hand_on();
  body_place = bodies[body_of].place, body_along = bodies[body_of].along, own_mesh = bodies[body_of].own_mesh;
  gl_Position = place(vertex);
}
)";

/// Keeps the pixels in a body's shadow: the way from the pixel's point to the light meets the solid. All lengths are taken from
/// the points where it comes closest, so that nothing large cancels: the error is a few roundings of the distance to the body.
/// The head defines KIND.
inline const std::string exact_fragment = exact_constants.fragment + std::string(gnomon::gbuffer_snippet) + R"(
struct Body { vec4 place, along; };
flat in vec4 body_place, body_along;
flat in uint own_mesh;
layout(location = 0) out vec2 count_and_faces;

bool is_blocked(Body b, vec3 from, vec3 to_light, float end) {
  vec3 p = from - b.place.xyz;
  float radius = b.place.w;
#if KIND == 0
  vec3 closest = p + clamp(-dot(p, to_light) / dot(to_light, to_light), 0, end) * to_light;
  return dot(closest, closest) <= radius * radius;
#elif KIND == 1
  // Between base and peak plane, start .. stop; there the solid is where the distance from the axis, less the radius at that
  // height, is not positive. Its square less the other's is a quadratic: least at -b/a, or, where a <= 0, at an end.
  float height = b.along.w, slope = radius / height;
  float z = dot(p, b.along.xyz), rise = dot(to_light, b.along.xyz);
  float start = 0, stop = end;
  if (rise != 0) {
    float at_base = -z / rise, at_peak = (height - z) / rise;
    start = max(start, min(at_base, at_peak));
    stop = min(stop, max(at_base, at_peak));
  } else if (z < 0 || z > height) {
    return false;
  }
  if (start > stop) return false;
  vec3 across = p - z * b.along.xyz, drift = to_light - rise * b.along.xyz;
  float above = height - z;
  float a2 = dot(drift, drift) - slope * slope * rise * rise, b1 = dot(across, drift) + slope * slope * above * rise;
  float t = a2 > 0 ? clamp(-b1 / a2, start, stop) : start;
  bool inside = length(across + t * drift) <= slope * (above - t * rise);
  return inside || (a2 <= 0 && length(across + stop * drift) <= slope * (above - stop * rise));
#else
  float rise = dot(to_light, b.along.xyz), t = -dot(p, b.along.xyz) / rise;
  vec3 cut = p + t * to_light;
  return rise != 0 && t > 0 && t <= end && dot(cut, cut) <= radius * radius;
#endif
}

void main() {
  vec3 point = position_here().xyz;
  if (ids_here().x == own_mesh) discard;
  if (!is_blocked(Body(body_place, body_along), point, light.xyz - light.w * point, light.w != 0 ? 1 : 3e38)) discard;
  count_and_faces = vec2(1);
}
)";

}  // namespace sphere_volume
