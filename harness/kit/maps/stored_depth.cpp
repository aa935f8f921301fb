#include <gnomon/kit/maps/stored_depth.h>

namespace gnomon {

namespace {

// Depth is near / z where rays start at the light, linear where they are parallel, and 0 where there is nothing. Half way
// between z1 = n / d1 and z2 = n / d2 is n / d with d = 2 d1 d2 / (d1 + d2). A texel is as wide as z1 times a share: an offset
// of some widths behind z1 is d1 / (1 + share); in parallel light it takes a fixed length off.
constexpr std::string_view combine_body = R"(
layout(binding = 3) uniform sampler2DArray first_depth;
layout(binding = 4) uniform sampler2DArray second_depth;
void main() {
  ivec3 at = ivec3(gl_FragCoord.xy, int(image.x));
  float first = texelFetch(first_depth, at, 0).r, second = texelFetch(second_depth, at, 0).r;
#if IS_PARALLEL
  float middle = second > 0 ? 0.5 * (first + second) : 0, behind = first > 0 ? max(first - image.y, 0) : 0;
#else
  float middle = second > 0 ? 2 * second * (first / (first + second)) : 0, behind = first / (1 + image.y);
#endif
#if IS_DUAL
  gl_FragDepth = max(middle, behind);
#else
  gl_FragDepth = middle;
#endif
}
)";

}  // namespace

void DepthCombination::setup(StoredDepth::Kind kind) {
  for (int k = 0; k < 2; ++k)
    programs_[k] = pass_program("combined depth", "vec2 image;",
                                fmt::format("#define IS_PARALLEL {:d}\n#define IS_DUAL {:d}\n{}", k == 0,
                                            kind == StoredDepth::Kind::dual, combine_body));
  framebuffer_ = make_framebuffer();
}

void DepthCombination::run(const LightCamera& camera, const StoredDepth& stored, const Texture& first, const Texture& second,
                           Texture& target) const {
  target.fit(GL_DEPTH_COMPONENT32F, first.width, first.height, first.layers);
  const Program& program = programs_[camera.space.is_parallel() ? 0 : 1];
  glBindTextureUnit(3, first.name());
  glBindTextureUnit(4, second.name());
  glUseProgram(program.name());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, first.width, first.height);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  for (const LightImage& image : camera.images) {
    if (image.layer < 0) continue;
    const double width = 1 / std::min(image.scale.x, image.scale.y);  // at axis distance 1, or everywhere
    const double share = stored.offset * (image.is_perspective ? width : width / (image.far - image.near));
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, target.name(), 0, image.layer);
    program.set("image", glm::vec2(image.layer, share));
    draw_full_screen();
  }
  glDisable(GL_DEPTH_TEST);
  glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_ATTACHMENT, 0, 0);
}

}  // namespace gnomon
