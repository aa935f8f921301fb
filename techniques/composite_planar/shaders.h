#pragma once
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/gl/gl_pass.h>

namespace composite_planar {

/// Mirrors Test in the shader below: a ShadowTest in float32.
struct alignas(16) TestData {
  glm::vec4 anchor;  ///< w: 1 for a disc
  glm::vec4 beyond, rows[4];

  explicit TestData(const gnomon::ShadowTest& test)
      : anchor(glm::vec3(test.anchor), test.is_disc ? 1 : 0), beyond(test.beyond) {
    for (int k = 0; k < 4; ++k) rows[k] = test.rows[k];
  }
};

// A patch's tests go to its pixels as flat outputs of its corners: constants of a triangle are read in no time, where every
// pixel would gather buffers and textures anew. The head defines COUNT, the most tests of a patch.
constexpr std::int64_t varying_components(std::uint32_t count) { return 4 * (5 + 6 * std::int64_t{count}); }

inline const gnomon::PassConstants patch_constants(std::string(gnomon::faces_light_constants) + "float tolerance;");

inline const std::string patch_vertex = patch_constants.vertex + R"(
layout(location = 0) in uvec4 pixels;  // left, top, right, bottom
layout(location = 1) in uvec3 what;    // plane, first, count
struct Test { vec4 anchor, beyond, rows[4]; };
layout(std430, binding = 0) readonly buffer Tests { Test tests[]; };
layout(std430, binding = 1) readonly buffer Lists { uint lists[]; };
struct Plane { vec4 plane, turn; };
layout(std430, binding = 2) readonly buffer Planes { Plane planes[]; };
uniform vec2 size;
flat out vec4 plane;
flat out float turn;
#if COUNT > 0
flat out vec4 rows[6 * COUNT];
#endif
void main() {
  hand_on();
  plane = planes[what.x].plane, turn = planes[what.x].turn.x;
#if COUNT > 0
  for (int k = 0; k < COUNT; ++k) {
    // Beyond what the list holds: a test that nothing passes.
    Test test = Test(vec4(0), vec4(0), vec4[4](vec4(0), vec4(0), vec4(0), vec4(0)));
    if (k < int(what.z)) test = tests[lists[what.y + k]];
    rows[6 * k] = test.anchor, rows[6 * k + 1] = test.beyond;
    for (int i = 0; i < 4; ++i) rows[6 * k + 2 + i] = test.rows[i];
  }
#endif
  vec2 corner = vec2(gl_VertexID % 2 == 0 ? pixels.x : pixels.z, gl_VertexID / 2 == 0 ? pixels.y : pixels.w);
  gl_Position = vec4(2 * corner.x / size.x - 1, 1 - 2 * corner.y / size.y, 0.5, 1);
}
)";

/// Keeps the pixels that show the patch's plane, face the light and are in the shadow of some test.
inline const std::string patch_fragment =
    patch_constants.fragment + std::string(gnomon::gbuffer_snippet) + std::string(gnomon::faces_light_snippet) + R"(
flat in vec4 plane;
flat in float turn;
#if COUNT > 0
flat in vec4 rows[6 * COUNT];
#endif
layout(location = 0) out float visibility;

bool is_in_shadow(vec4 anchor, vec4 beyond, vec4 a, vec4 b, vec4 c, vec4 d, vec3 point) {
  vec4 x = vec4(point - anchor.xyz, 1);
  vec3 f = vec3(dot(a, x), dot(b, x), dot(c, x));
  bool of_disc = f.x * f.x + f.y * f.y <= f.z * f.z && f.z > 0;
  bool of_polygon = min(min(f.x, f.y), min(f.z, dot(d, x))) >= 0;
  return (anchor.w != 0 ? of_disc : of_polygon) && dot(beyond, x) > 0;
}

void main() {
  vec4 position = position_here(), normal = normal_here();
  vec3 off = normal.xyz - plane.xyz;
  bool is_dark = faces_light(position, normal) && abs(dot(plane, position)) <= tolerance && dot(off, off) <= turn * turn;
#if COUNT > 0
  bool is_behind = false;
  for (int k = 0; k < 6 * COUNT; k += 6)
    is_behind = is_behind || is_in_shadow(rows[k], rows[k + 1], rows[k + 2], rows[k + 3], rows[k + 4], rows[k + 5],
                                          position.xyz);
  is_dark = is_dark && is_behind;
#endif
  if (!is_dark) discard;
  visibility = 0;
}
)";

}  // namespace composite_planar
