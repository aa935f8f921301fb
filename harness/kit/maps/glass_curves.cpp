// The curve that a glass map holds in a texel, beside the exact one on the same ray.
#include <gnomon/kit/maps/glass_map.h>

namespace gnomon {

namespace {

constexpr int curve_points = 1025;  ///< of what is held: 1024 steps from near to far

}  // namespace

/// By the very look-up, filter included: at `count` depths, evenly from near to far.
std::vector<float> GlassMap::held_shares(const Place& place, int count) const {
  const StateGuard guard;
  auto& program = made_->curve_programs[static_cast<int>(projection())];
  if (!program) program = look_up_program(projection(), true, Purpose::curve);
  const Texture row(GL_R32F, count, 1);
  const GLuint framebuffer = made_->framebuffer.name();
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, row.name(), 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, count, 1);
  bind_glass(*program);
  glBindTextureUnit(3, depths_.name());
  program->set("light_asked", glm::vec4(place.texel, place.image->layer, count - 1));
  glUseProgram(program->name());
  draw_full_screen();
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, 0, 0);
  return read_texels<float>(row, GL_RED);
}

/// The mean of the products on the rays through the centers of the texels that are read, over the depth along the ray of the
/// place: with the nearest texel, its own product. Depths of the rays are compared as shares of the way from near to far.
SharesAlong GlassMap::exact_shares(const Place& place) const {
  const LightImage& image = *place.image;
  std::vector<GlassTexel> texels = texels_of(place);
  struct Step {
    double t;
    std::size_t texel;
    double transmission;
  };
  std::vector<Step> steps;
  for (std::size_t k = 0; k < texels.size(); ++k) {
    const glm::dvec2 center = glm::dvec2(texels[k].texel) + 0.5;
    const Tap ray = image.tap(center, image.near, 1);
    const double far = image.tap(center, image.far, 1).stored;
    for (const GlassCrossing& one : glass_along(ray))
      if (one.distance <= far)
        steps.push_back({std::max((one.distance - ray.stored) / (far - ray.stored), 0.0), k, one.transmission});
  }
  std::ranges::stable_sort(steps, {}, &Step::t);
  const double near = image.tap(place.texel, image.near, 1).stored, far = image.tap(place.texel, image.far, 1).stored;
  SharesAlong shares;
  const auto corner = [&](double t) {
    double sum = 0;
    for (const GlassTexel& texel : texels) sum += texel.weight * texel.share;
    shares.depth.push_back(near + t * (far - near));
    shares.share.push_back(sum);
  };
  corner(0);
  for (const Step& step : steps) {
    corner(step.t);
    texels[step.texel].share *= step.transmission;
    corner(step.t);
  }
  corner(1);
  return shares;
}

std::optional<DepthCurve> GlassMap::depth_curve(std::size_t index) const {
  if (!made_->has_glass || !faces_light(*made_->scene, *gbuffer_, light_, index)) return std::nullopt;
  Place place = looked_up(index);
  if (!place.image || !camera_.holds(glm::ivec2(glm::floor(place.texel)))) return std::nullopt;
  const Explanation why = why_at(place, index);
  if (!why.covered) return std::nullopt;
  prepare_lists();
  if (!is_bilinear()) place.texel = glm::floor(place.texel) + 0.5;
  const LightImage& image = *place.image;
  const double near = image.tap(place.texel, image.near, 1).stored, far = image.tap(place.texel, image.far, 1).stored;
  DepthCurve curve{.held = {},
                   .exact = exact_shares(place),
                   .receiver = image.tap(place.texel, depth_at(image, gbuffer_->position(index), why.bias), 1).stored};
  for (const float share : held_shares(place, curve_points)) {
    curve.held.depth.push_back(near + (far - near) * static_cast<double>(curve.held.depth.size()) / (curve_points - 1));
    curve.held.share.push_back(share);
  }
  return curve;
}

}  // namespace gnomon
