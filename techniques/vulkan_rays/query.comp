#version 460
#extension GL_EXT_ray_query : require
#extension GL_GOOGLE_include_directive : require

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform accelerationStructureEXT casters;

bool is_blocked(vec3 start, vec3 way, float end, uvec2 own) {
  rayQueryEXT query;
  rayQueryInitializeEXT(query, casters, gl_RayFlagsTerminateOnFirstHitEXT, 0xffu, start, 0.0, way, end);
  while (rayQueryProceedEXT(query))
    if (uint(rayQueryGetIntersectionPrimitiveIndexEXT(query, false)) - own.x >= own.y) rayQueryConfirmIntersectionEXT(query);
  return rayQueryGetIntersectionTypeEXT(query, true) != gl_RayQueryCommittedIntersectionNoneEXT;
}

#include "rays.glsl"

void main() { answer_pixel(gl_GlobalInvocationID.xy); }
