#include "measure/conformance/gl_state.h"

#include <gnomon/kit/gl/gl.h>

namespace gnomon {

namespace {

// The tables below, with the checks of state_differences, define the house state.

/// A number of the state and its value in the house state.
struct Setting {
  GLenum query;
  const char* name;
  GLint wanted = 0;
};

constexpr Setting switches[] = {{GL_BLEND, "blend"},
                                {GL_COLOR_LOGIC_OP, "color logic op"},
                                {GL_CULL_FACE, "cull face"},
                                {GL_DEPTH_CLAMP, "depth clamp"},
                                {GL_DEPTH_TEST, "depth test"},
                                {GL_DITHER, "dither", true},
                                {GL_FRAMEBUFFER_SRGB, "framebuffer sRGB"},
                                {GL_MULTISAMPLE, "multisample", true},
                                {GL_POLYGON_OFFSET_FILL, "polygon offset fill"},
                                {GL_PRIMITIVE_RESTART, "primitive restart"},
                                {GL_PROGRAM_POINT_SIZE, "program point size"},
                                {GL_RASTERIZER_DISCARD, "rasterizer discard"},
                                {GL_SAMPLE_ALPHA_TO_COVERAGE, "sample alpha to coverage"},
                                {GL_SAMPLE_MASK, "sample mask"},
                                {GL_SCISSOR_TEST, "scissor test"},
                                {GL_STENCIL_TEST, "stencil test"}};

constexpr Setting integers[] = {{GL_CURRENT_PROGRAM, "current program"},
                                {GL_VERTEX_ARRAY_BINDING, "vertex array"},
                                {GL_DRAW_FRAMEBUFFER_BINDING, "draw framebuffer"},
                                {GL_READ_FRAMEBUFFER_BINDING, "read framebuffer"},
                                {GL_RENDERBUFFER_BINDING, "renderbuffer"},
                                {GL_ARRAY_BUFFER_BINDING, "array buffer"},
                                {GL_UNIFORM_BUFFER_BINDING, "uniform buffer"},
                                {GL_SHADER_STORAGE_BUFFER_BINDING, "shader storage buffer"},
                                {GL_ATOMIC_COUNTER_BUFFER_BINDING, "atomic counter buffer"},
                                {GL_DRAW_INDIRECT_BUFFER_BINDING, "draw indirect buffer"},
                                {GL_PIXEL_PACK_BUFFER_BINDING, "pixel pack buffer"},
                                {GL_PIXEL_UNPACK_BUFFER_BINDING, "pixel unpack buffer"},
                                {GL_ACTIVE_TEXTURE, "active texture", GL_TEXTURE0},
                                {GL_PACK_ALIGNMENT, "pack alignment", 4},
                                {GL_UNPACK_ALIGNMENT, "unpack alignment", 4},
                                {GL_DEPTH_FUNC, "depth function", GL_LESS},
                                {GL_DEPTH_WRITEMASK, "depth mask", GL_TRUE},
                                {GL_STENCIL_FUNC, "stencil function, front", GL_ALWAYS},
                                {GL_STENCIL_BACK_FUNC, "stencil function, back", GL_ALWAYS},
                                {GL_STENCIL_REF, "stencil reference, front"},
                                {GL_STENCIL_BACK_REF, "stencil reference, back"},
                                {GL_STENCIL_FAIL, "stencil fail, front", GL_KEEP},
                                {GL_STENCIL_BACK_FAIL, "stencil fail, back", GL_KEEP},
                                {GL_STENCIL_PASS_DEPTH_FAIL, "stencil depth fail, front", GL_KEEP},
                                {GL_STENCIL_BACK_PASS_DEPTH_FAIL, "stencil depth fail, back", GL_KEEP},
                                {GL_STENCIL_PASS_DEPTH_PASS, "stencil pass, front", GL_KEEP},
                                {GL_STENCIL_BACK_PASS_DEPTH_PASS, "stencil pass, back", GL_KEEP},
                                {GL_BLEND_SRC_RGB, "blend source", GL_ONE},
                                {GL_BLEND_DST_RGB, "blend destination", GL_ZERO},
                                {GL_BLEND_SRC_ALPHA, "blend source alpha", GL_ONE},
                                {GL_BLEND_DST_ALPHA, "blend destination alpha", GL_ZERO},
                                {GL_BLEND_EQUATION_RGB, "blend equation", GL_FUNC_ADD},
                                {GL_BLEND_EQUATION_ALPHA, "blend equation alpha", GL_FUNC_ADD},
                                {GL_CULL_FACE_MODE, "cull face mode", GL_BACK},
                                {GL_FRONT_FACE, "front face", GL_CCW},
                                {GL_POLYGON_MODE, "polygon mode", GL_FILL},
                                {GL_CLIP_ORIGIN, "clip origin", GL_UPPER_LEFT},
                                {GL_CLIP_DEPTH_MODE, "clip depth mode", GL_ZERO_TO_ONE}};

constexpr Setting stencil_masks[] = {{GL_STENCIL_WRITEMASK, "stencil write mask, front", 0xff},
                                     {GL_STENCIL_BACK_WRITEMASK, "stencil write mask, back", 0xff},
                                     {GL_STENCIL_VALUE_MASK, "stencil value mask, front", 0xff},
                                     {GL_STENCIL_BACK_VALUE_MASK, "stencil value mask, back", 0xff}};

/// Of each texture unit.
constexpr Setting textures[] = {{GL_TEXTURE_BINDING_1D, "1D texture"},
                                {GL_TEXTURE_BINDING_2D, "2D texture"},
                                {GL_TEXTURE_BINDING_3D, "3D texture"},
                                {GL_TEXTURE_BINDING_2D_ARRAY, "2D array texture"},
                                {GL_TEXTURE_BINDING_CUBE_MAP, "cube texture"},
                                {GL_TEXTURE_BINDING_BUFFER, "buffer texture"},
                                {GL_TEXTURE_BINDING_2D_MULTISAMPLE, "multisample texture"},
                                {GL_SAMPLER_BINDING, "sampler"}};

GLint integer(GLenum query) {
  GLint value[4] = {};  // the polygon mode writes two
  glGetIntegerv(query, value);
  return value[0];
}

constexpr int clip_distance_count = 8, texture_unit_count = 16, image_unit_count = 8, buffer_unit_count = 8;

}  // namespace

std::vector<std::string> state_differences() {
  std::vector<std::string> differences;
  const auto compare = [&](const std::string& name, GLint value, GLint wanted) {
    if (value != wanted) differences.push_back(fmt::format("{} is {:#x}, not {:#x}", name, value, wanted));
  };
  for (const auto& s : switches)
    if (bool(glIsEnabled(s.query)) != s.wanted) differences.push_back(fmt::format("{} is {}", s.name, s.wanted ? "off" : "on"));
  for (int i = 0; i < clip_distance_count; ++i)
    if (glIsEnabled(GL_CLIP_DISTANCE0 + i)) differences.push_back(fmt::format("clip distance {} is on", i));
  for (const auto& [query, name, wanted] : integers) compare(name, integer(query), wanted);
  for (const auto& [query, name, wanted] : stencil_masks)
    compare(name, integer(query) & 0xff, wanted);  // implementations return 8 or 32 bits of the default
  GLboolean color[4];
  glGetBooleanv(GL_COLOR_WRITEMASK, color);
  for (int i = 0; i < 4; ++i) compare(fmt::format("color mask {}", "rgba"[i]), color[i], GL_TRUE);
  GLfloat range[2];
  glGetFloatv(GL_DEPTH_RANGE, range);
  if (range[0] != 0 || range[1] != 1) differences.push_back(fmt::format("depth range is {} .. {}", range[0], range[1]));

  const GLint active = integer(GL_ACTIVE_TEXTURE);
  for (int unit = 0; unit < texture_unit_count; ++unit) {
    glActiveTexture(GL_TEXTURE0 + unit);
    for (const auto& [query, name, wanted] : textures)
      compare(fmt::format("{} of unit {}", name, unit), integer(query), wanted);
  }
  glActiveTexture(active);
  const auto compare_indexed = [&](GLenum query, const char* name, int count) {
    for (int i = 0; i < count; ++i) {
      GLint value = 0;
      glGetIntegeri_v(query, i, &value);
      compare(fmt::format("{} {}", name, i), value, 0);
    }
  };
  compare_indexed(GL_IMAGE_BINDING_NAME, "image unit", image_unit_count);
  compare_indexed(GL_SHADER_STORAGE_BUFFER_BINDING, "shader storage binding", buffer_unit_count);
  compare_indexed(GL_UNIFORM_BUFFER_BINDING, "uniform buffer binding", buffer_unit_count);
  while (const GLenum error = glGetError()) differences.push_back(fmt::format("pending GL error {:#x}", error));
  return differences;
}

}  // namespace gnomon
