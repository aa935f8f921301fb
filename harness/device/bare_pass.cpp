#include "device/bare_pass.h"

#include <gnomon/error.h>
#include <gnomon/kit/gl/gl_pass.h>

#include <array>
#include <numeric>

namespace gnomon {

BarePass::BarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer)
    : floor_(floor), scene_(scene), gbuffer_(gbuffer), meshes_(scene.meshes.size()) {
  std::iota(meshes_.begin(), meshes_.end(), 0u);
  const bool is_depth = floor == Floor::depth_draw;
  target_ = Texture(is_depth ? GL_DEPTH_COMPONENT32F : GL_R32F, gbuffer.width, gbuffer.height);
  switch (floor) {
    case Floor::none:
      throw Error("a technique without a floor has no bare pass");
    case Floor::depth_draw:
      program_ =
          Program("bare pass: depth", std::string(position_snippet) + "void main() { gl_Position = place(vec4(position, 1)); }",
                  "void main() {}");
      program_.set("clip_from_world", glm::mat4(clip_from_world(gbuffer, scene)));
      break;
    case Floor::fetch:
      program_ = Program(
          "bare pass: fetch", full_screen_vertex,
          std::string(gbuffer_snippet) + "out float answer; void main() { answer = position_here().w * normal_here().w; }");
      break;
    case Floor::copy:
      from_ = Texture(GL_R32F, gbuffer.width, gbuffer.height);
      glClearTexImage(from_.name(), 0, GL_RED, GL_FLOAT, std::array{1.0f}.data());
      break;
  }
  framebuffer_ = make_framebuffer();
  glNamedFramebufferTexture(framebuffer_.name(), is_depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0, target_.name(), 0);
}

void BarePass::draw(int times) const {
  const StateGuard guard;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, target_.width, target_.height);
  if (program_) glUseProgram(program_.name());
  if (floor_ == Floor::depth_draw) {
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
  }
  if (floor_ == Floor::fetch) bind_gbuffer(gbuffer_textures(gbuffer_, scene_));
  for (int k = 0; k < times; ++k) switch (floor_) {
      case Floor::none:
        break;
      case Floor::depth_draw:
        glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, std::array{0.0f}.data());
        scene_buffers(scene_).draw(meshes_);
        break;
      case Floor::fetch:
        draw_full_screen();
        break;
      case Floor::copy:
        glCopyImageSubData(from_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, target_.name(), GL_TEXTURE_2D, 0, 0, 0, 0, target_.width,
                           target_.height, 1);
        break;
    }
}

std::vector<float> BarePass::read() const {
  return read_texels<float>(target_, floor_ == Floor::depth_draw ? GL_DEPTH_COMPONENT : GL_RED);
}

}  // namespace gnomon
