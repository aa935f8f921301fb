#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/volumes/gl_volumes.h>

#include <cmath>

namespace gnomon {

namespace {

constexpr std::string_view own_mesh_head = R"(
layout(binding = 2) uniform usampler2D gbuffer_ids;
uniform int own_mesh;
bool is_own() { return int(texelFetch(gbuffer_ids, ivec2(gl_FragCoord.xy), 0).x) == own_mesh; }
)";
constexpr std::string_view no_own_mesh_head = "bool is_own() { return false; }\n";

/// A face that is turned to the eye is entered there. With z-fail the ways are counted from the far end, so entering takes one
/// away: `step` is +1 or -1 for the front faces.
constexpr std::string_view wide_body = R"(
uniform float step_in;
layout(location = 0) out vec2 count_and_faces;
void main() {
  if (is_own()) discard;
  count_and_faces = vec2(gl_FrontFacing ? step_in : -step_in, 1);
}
)";

constexpr std::string_view stencil_own_body = "void main() { if (is_own()) discard; }\n";

/// Channels: front sides, back sides, light caps, dark caps.
constexpr std::string_view layer_body = R"(
uniform int face;
uniform bool reversed;
layout(location = 0) out vec4 faces;
void main() {
  if (is_own()) discard;
  bool front = gl_FrontFacing != reversed;
  faces = face == 0 ? vec4(front, !front, 0, 0) : vec4(0, 0, face == 1, face == 2);
}
)";

const std::string mask_fragment = std::string(gbuffer_snippet) + std::string(faces_light_snippet) + R"(
layout(location = 0) out float visibility;
#ifdef WIDE
layout(binding = 3) uniform sampler2D counts;
#endif
void main() {
#ifdef WIDE
  bool in_shadow = texelFetch(counts, ivec2(gl_FragCoord.xy), 0).r != 0;
#else
  const bool in_shadow = true;  // the stencil test let this pixel through
#endif
  bool facing = faces_light(position_here(), normal_here());
  visibility = in_shadow && facing ? 0 : 1;
}
)";

/// Where the count is in the stencil, that is read as a texture: no pixel then depends on a stencil test of its own.
const std::string glass_fragment = std::string(gbuffer_snippet) + std::string(faces_light_snippet) + R"(
layout(location = 0) out float share;
layout(std430, binding = 0) readonly buffer Powers { float powers[]; };
#ifdef WIDE
layout(binding = 3) uniform sampler2D counts;
#else
layout(binding = 3) uniform usampler2D counts;
#endif
void main() {
  int count = int(texelFetch(counts, ivec2(gl_FragCoord.xy), 0).r);
  bool facing = faces_light(position_here(), normal_here());
  share = facing ? powers[clamp(count, 0, powers.length() - 1)] : 1;
}
)";

}  // namespace

std::vector<float> powers_of(float transmission, std::size_t most) {
  std::vector<float> powers{1};
  double power = 1;
  while (powers.size() <= most && powers.back() > 0) {
    power *= transmission;
    powers.push_back(static_cast<float>(power));
  }
  return powers;
}

VolumeProgram::VolumeProgram(std::string_view title, std::string_view vertex, bool own_mesh) {
  const auto make = [&](std::string_view what, std::string_view body) {
    return Program(fmt::format("{} {}", title, what), vertex,
                   std::string(own_mesh ? own_mesh_head : no_own_mesh_head) + std::string(body));
  };
  stencil = own_mesh ? make("stencil", stencil_own_body) : Program(fmt::format("{} stencil", title), vertex, "void main() {}");
  wide = make("wide", wide_body);
  layer = make("layer", layer_body);
}

void VolumeCounter::setup() {
  mask_program_ = pass_program("mask of a stencil count", faces_light_constants, mask_fragment);
  wide_mask_program_ = pass_program("mask of a wide count", faces_light_constants, "#define WIDE\n" + mask_fragment);
  glass_program_ = pass_program("glass of a stencil count", faces_light_constants, glass_fragment);
  wide_glass_program_ = pass_program("glass of a wide count", faces_light_constants, "#define WIDE\n" + glass_fragment);
  framebuffer_ = make_framebuffer();
}

void VolumeCounter::begin(const DepthStencil& depth, const GBufferTextures& gbuffer, Pass pass, CountWhere where, int start) {
  pass_ = pass;
  where_ = where;
  depth_stencil_ = depth.texture.name();
  const GLuint target = framebuffer_.name();
  glNamedFramebufferTexture(target, GL_DEPTH_STENCIL_ATTACHMENT, depth_stencil_, 0);
  Texture* const gathered = pass == Pass::wide ? &wide_ : pass == Pass::layer ? &layer_ : nullptr;
  if (gathered) gathered->fit(pass == Pass::wide ? GL_RG32F : GL_RGBA32F, depth.texture.width, depth.texture.height);
  glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, gathered ? gathered->name() : 0, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glViewport(0, 0, depth.texture.width, depth.texture.height);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_FALSE);
  if (pass == Pass::stencil) {
    const GLint first = start & 0xff;
    glClearNamedFramebufferiv(target, GL_STENCIL, 0, &first);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 0, ~0u);
    glDepthFunc(GL_GREATER);
  } else {
    const GLfloat first[] = {pass == Pass::wide ? static_cast<float>(start) : 0, 0, 0, 0};
    glDisable(GL_STENCIL_TEST);  // that a mask before this pass was written by
    glClearNamedFramebufferfv(target, GL_COLOR, 0, first);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    // What fails "nearer" is counted by z-fail. Volumes are looked at on the background too, where the depth is 0.
    glDepthFunc(pass == Pass::layer ? GL_GEQUAL : where == CountWhere::behind_surface ? GL_LEQUAL : GL_GREATER);
  }
  if (pass != Pass::layer) {
    const PixelRectangle within = around(gbuffer.receivers);
    glEnable(GL_SCISSOR_TEST);
    glScissor(within.left, within.top, within.right - within.left, within.bottom - within.top);
  }
  // Before the surface, a face nearer than the near plane counts as well: the way starts at the eye.
  if (pass == Pass::layer || where == CountWhere::before_surface) glEnable(GL_DEPTH_CLAMP);
}

void VolumeCounter::use(const VolumeProgram& program, VolumeFace face, bool reversed) const {
  const bool is_before = where_ == CountWhere::before_surface;
  if (pass_ == Pass::stencil) {
    const GLenum in = reversed ? GL_DECR_WRAP : GL_INCR_WRAP, out = reversed ? GL_INCR_WRAP : GL_DECR_WRAP;
    glStencilOpSeparate(GL_FRONT, GL_KEEP, is_before ? GL_KEEP : out, is_before ? in : GL_KEEP);
    glStencilOpSeparate(GL_BACK, GL_KEEP, is_before ? GL_KEEP : in, is_before ? out : GL_KEEP);
    glUseProgram(program.stencil.name());
  } else if (pass_ == Pass::wide) {
    program.wide.set("step_in", is_before != reversed ? 1.0f : -1.0f);
    glUseProgram(program.wide.name());
  } else {
    program.layer.set("face", static_cast<int>(face));
    program.layer.set("reversed", reversed ? 1 : 0);
    glUseProgram(program.layer.name());
  }
}

void VolumeCounter::write_mask(const GBufferTextures& gbuffer, const Light& light, VisibilityMask& mask) {
  const bool wide = pass_ == Pass::wide;
  glDisable(GL_SCISSOR_TEST);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  if (wide) {
    glBindTextureUnit(3, wide_.name());
  } else {
    const GLfloat lit[] = {1, 0, 0, 0};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, lit);
    glEnable(GL_SCISSOR_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, ~0u);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  }
  const Program& program = wide ? wide_mask_program_ : mask_program_;
  set_light(program, light);
  bind_gbuffer(gbuffer);
  glUseProgram(program.name());
  draw_full_screen();
  end();
}

void VolumeCounter::multiply_mask(const GBufferTextures& gbuffer, const Light& light, const Buffer& powers,
                                  VisibilityMask& mask) {
  const bool wide = pass_ == Pass::wide;
  const GLuint target = framebuffer_.name();
  // What is read is not attached.
  glNamedFramebufferTexture(target, GL_DEPTH_STENCIL_ATTACHMENT, 0, 0);
  glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, mask.texture(), 0);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_STENCIL_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ZERO, GL_SRC_COLOR);
  glBindTextureUnit(3, wide ? wide_.name() : depth_stencil_);
  if (!wide) glTextureParameteri(depth_stencil_, GL_DEPTH_STENCIL_TEXTURE_MODE, GL_STENCIL_INDEX);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, powers.name());
  const Program& program = wide ? wide_glass_program_ : glass_program_;
  set_light(program, light);
  bind_gbuffer(gbuffer);
  glUseProgram(program.name());
  draw_full_screen();
  if (!wide) glTextureParameteri(depth_stencil_, GL_DEPTH_STENCIL_TEXTURE_MODE, GL_DEPTH_COMPONENT);
  glBindTextureUnit(3, 0);
  glDisable(GL_BLEND);
  end();
}

/// Mask and depth are others': they may go before this framebuffer does.
void VolumeCounter::end() const {
  glDisable(GL_SCISSOR_TEST);
  glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, 0, 0);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_STENCIL_ATTACHMENT, 0, 0);
}

void VolumeCounter::drop_pictures() {
  wide_ = {};
  layer_ = {};
}

std::vector<VolumeCounter::WideCount> VolumeCounter::wide_counts() const { return read_texels<WideCount>(wide_, GL_RG); }

VolumeCounter::Work VolumeCounter::work() const {
  Work work;
  for (const WideCount& pixel : wide_counts()) {
    work.fill += pixel.faces;
    work.deepest = std::max<double>(work.deepest, std::abs(pixel.count));
  }
  return work;
}

std::vector<VolumeFaces> VolumeCounter::layer_faces() const { return read_texels<VolumeFaces>(layer_, GL_RGBA); }

}  // namespace gnomon
