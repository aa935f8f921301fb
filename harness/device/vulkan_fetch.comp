#version 460

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, std430) readonly buffer Positions { vec4 positions[]; };
layout(set = 0, binding = 1, std430) readonly buffer Normals { vec4 normals[]; };
layout(set = 0, binding = 2, std430) writeonly buffer Values { float values[]; };
layout(push_constant) uniform Size { uint width, height; };

void main() {
  uvec2 at = gl_GlobalInvocationID.xy;
  if (at.x >= width || at.y >= height) return;
  uint pixel = at.y * width + at.x;
  values[pixel] = positions[pixel].w * normals[pixel].w;
}
