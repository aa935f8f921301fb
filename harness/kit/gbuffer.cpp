#include <epoxy/gl.h>
#include <gnomon/gbuffer.h>
#include <gnomon/kit/area/light_figure.h>

namespace gnomon {

bool faces_light(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::size_t i) {
  if (gbuffer.is_background(i) || !scene.meshes[gbuffer.mesh[i]].receives) return false;
  const glm::dvec3 point = gbuffer.position(i);
  if (has_area(light)) return LightFigure(light, point, gbuffer.normal(i)).is_seen();
  return glm::dot(glm::dvec3(gbuffer.normal(i)), to_light(homogeneous(light), point)) > 0 && in_spot_cone(light, point);
}

VisibilityMask::VisibilityMask(int width, int height)
    : width_(width), height_(height), pixels_(static_cast<std::size_t>(width) * height, 1.0f) {}

VisibilityMask::~VisibilityMask() {
  if (texture_) glDeleteTextures(1, &texture_);
}

std::span<float> VisibilityMask::pixels() {
  in_texture_ = false;
  return pixels_;
}

unsigned VisibilityMask::texture() {
  if (!texture_) {
    glCreateTextures(GL_TEXTURE_2D, 1, &texture_);
    glTextureStorage2D(texture_, 1, GL_R32F, width_, height_);
  }
  in_texture_ = true;
  return texture_;
}

std::span<const float> VisibilityMask::read() {
  if (in_texture_)
    glGetTextureImage(texture_, 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(pixels_.size() * sizeof(float)), pixels_.data());
  return pixels_;
}

}  // namespace gnomon
