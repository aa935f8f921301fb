#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/maps/area_map.h>
#include <gnomon/kit/maps/light_layers.h>

#include "kit/maps/area_map_shader.h"

namespace gnomon {

namespace {

/// The figure of a flat light, half sides of length; of a sphere its radius.
struct Figure {
  glm::dvec3 half_u{0}, half_v{0}, axis{0};  // axis: unit, on the front's side
  double radius = 0;
  bool is_disc = true, is_one_sided = false;
};

Figure figure_of(const Light& light) {
  const LightShape shape(light);
  if (!shape.is_flat()) return {.radius = shape.radius};
  const glm::dvec3 axis = shape.front();
  if (shape.form == LightShape::Form::rectangle) return {shape.half_u, shape.half_v, axis, 0, false, shape.is_one_sided};
  const Across across(axis);
  return {shape.radius * across.u, shape.radius * across.v, axis, 0, true, shape.is_one_sided};
}

/// How far a light goes from its center.
double radius_of(const Light& light) {
  const Figure figure = figure_of(light);
  return figure.radius + std::hypot(glm::length(figure.half_u), glm::length(figure.half_v));
}

}  // namespace

glm::dvec2 AreaPoint::reach() const {
  const glm::dvec2 a = glm::abs(figure[0]), b = glm::abs(figure[1]);
  const double most_tilt = is_disc ? glm::length(tilt) : std::abs(tilt.x) + std::abs(tilt.y);
  return (is_disc ? glm::sqrt(a * a + b * b) : a + b) / std::max(1 - most_tilt, 0.25);
}

glm::dvec2 AreaPoint::offset(double spread, const glm::dvec2& place) const {
  return spread / std::max(1 - glm::dot(tilt, place), 0.25) * (figure * place);
}

bool AreaPoint::is_hidden_by(const glm::ivec2& texel, double stored) const {
  const double m = facing - glm::dot(step_height, glm::dvec2(texel) + 0.5 - position);
  return image->near * m < (depth - bias * std::abs(m)) * stored && image->near < seen.z * stored;
}

Support AreaMap::supports(const Scene& scene, const Light& light, const View&) const {
  if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see shadow_map");
  Light center = light;
  center.kind = PointLight{};
  return glass.limit(scene, alpha.limit(scene, light_map_support(center, resolution, margin(), 0)));
}

Program AreaMap::program(int which, std::string_view title, std::string_view first_line) const {
  const LightProjection cube = LightProjection::cube;
  return pass_program(fmt::format("{} {}", id(), title), light_map_constants(cube),
                      fmt::format("{}#define FIGURE {}\n{}{}{}{}{}{}", first_line, which, light_map_head(cube), gbuffer_snippet,
                                  light_map_snippet, area_map_snippet, body(), area_map_main));
}

void AreaMap::setup() {
  made_->depth_images.setup();
  made_->nearest_program = Program(fmt::format("{} nearest", id()), full_screen_vertex, nearest_fragment);
  for (int k = 0; k < 2; ++k) {
    made_->resolve_programs[k] = program(k, "resolve", "");
    made_->account_programs[k].reset();
  }
  made_->framebuffer = make_framebuffer();
  warm_up(*this);
}

void AreaMap::build(const Scene& scene) {
  made_->scene = &scene;
  made_->depth_images.build(scene, alpha.rule(), glass.as());
  made_->glass_difference = {scene, glass.as()};
}

void AreaMap::update(const Scene& scene, const Changes& changes) {
  if (!made_->depth_images.update(scene, changes)) return build(scene);
  made_->glass_difference = {scene, glass.as()};
}

void AreaMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  images_.still.start_relight(made_->depth_images.moving(), update_by);
  center_ = light;
  center_.kind = PointLight{glm::vec3(homogeneous_of_center(light))};
  made_->depth_images.use_alpha(alpha.rule());
  if (fit.is("scene")) draw_images(fit_to_scene(center_, made_->depth_images.boxes(), resolution, margin()));
  glFinish();
}

void AreaMap::draw_images(LightCamera&& camera) {
  if (made_->read_of == this) made_->read_of = nullptr;
  camera_ = std::move(camera);
  drawn_triangles_ = draw(images_, made_->depth_images.hole_test());
}

std::size_t AreaMap::draw(Images& images, const HoleTest& test) const {
  const std::size_t triangles = made_->depth_images.draw(camera_, images.depths, images.still, DepthImages::Faces::lit, test);
  const int side = (resolution + area_map_block - 1) / area_map_block;
  images.nearest.fit(GL_R32F, side, side, std::max(camera_.layer_count, 1));
  const Program& program = made_->nearest_program;
  const GLuint framebuffer = made_->framebuffer.name();
  glBindTextureUnit(3, images.depths.name());
  glUseProgram(program.name());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, side, side);
  for (int layer = 0; layer < camera_.layer_count; ++layer) {
    glNamedFramebufferTextureLayer(framebuffer, GL_COLOR_ATTACHMENT0, images.nearest.name(), 0, layer);
    program.set("layer", layer);
    draw_full_screen();
  }
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, 0, 0);
  return triangles;
}

void AreaMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_of == this) {
    made_->accounts.clear();
    made_->alpha_difference.reset();
  }
  if (fit.is("view"))
    draw_images(fit_to_view(center_, made_->depth_images.boxes(), gbuffer, resolution, margin(), radius_of(light_)));
  look_up(made_->resolve_programs[program_index()], images_, mask.texture());
  glFinish();
}

void AreaMap::look_up(const Program& program, const Images& images, unsigned target) const {
  set_light_camera(program, center_, camera_,
                   [&](const LightImage& image) { return camera_.rounding / (image.near * image.far); });
  const Figure figure = figure_of(light_);
  program.set_if_used("area_half_u", glm::vec3(figure.half_u));
  program.set_if_used("area_half_v", glm::vec3(figure.half_v));
  program.set_if_used("area_figure", glm::vec4(figure.axis, figure.radius));
  program.set_if_used("area_look_up",
                      glm::vec4(depth_bias.value(), camera_.rounding, most_radius.value(), figure.is_one_sided));
  set_uniforms(program);
  glBindTextureUnit(3, images.depths.name());
  glBindTextureUnit(4, images.nearest.name());
  draw_mask(program, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
}

Counts AreaMap::counts() const {
  const double texels = double(resolution) * resolution * camera_.layer_count;
  const double bytes = double(images_.depths.bytes + images_.still.bytes() + images_.nearest.bytes);
  return {{"texels", texels, "texel"},
          {"faces", double(camera_.layer_count), ""},
          {"triangles", double(drawn_triangles_), ""},
          {"bytes", bytes + made_.own(double(made_->depth_images.bytes())), "byte"}};
}

void AreaMap::start_questions() const {
  if (made_->read_of == this) return;
  made_->read_of = this;
  made_->depths.clear();
  made_->accounts.clear();
  made_->alpha_difference.reset();
}

const std::vector<float>& AreaMap::depths() const {
  start_questions();
  if (made_->depths.empty()) made_->depths = read_texels<float>(images_.depths, GL_DEPTH_COMPONENT);
  return made_->depths;
}

const std::vector<glm::vec4>& AreaMap::accounts() const {
  depths();
  if (!made_->accounts.empty()) return made_->accounts;
  const StateGuard guard;
  auto& program = made_->account_programs[program_index()];
  if (!program) program = this->program(program_index(), "account", "#define EXPLAIN\n");
  const Texture target(GL_RGBA32F, gbuffer_->width, gbuffer_->height);
  look_up(*program, images_, target.name());
  made_->accounts = read_texels<glm::vec4>(target, GL_RGBA);
  return made_->accounts;
}

/// The mask of the last resolve, once more, of these images of its camera.
std::vector<float> AreaMap::answer(const Images& images) const {
  return read_mask(*gbuffer_, [&](unsigned target) { look_up(made_->resolve_programs[program_index()], images, target); });
}

std::string_view AreaMap::alpha_cause(std::size_t index) const {
  const AlphaRule rule = made_->depth_images.hole_test().rule;
  if (rule == AlphaRule::texel) return "";
  start_questions();
  const auto draw_by_texel = [&](Images& by_texel) { draw(by_texel, {}); };
  return AlphaDifference::cause(made_->alpha_difference, rule, has_area(light_), index, images_, draw_by_texel,
                                [&](const Images& one) { return answer(one); });
}

std::optional<Explanation> AreaMap::explain(std::size_t index) const {
  if (!faces(index)) return std::nullopt;
  Explanation why;
  why.cause = alpha_cause(index);
  explain_glass(why, index);
  if (why.cause.empty()) return std::nullopt;
  return why;
}

AreaPoint AreaMap::point(std::size_t index) const {
  const glm::dvec3 world = gbuffer_->position(index);
  AreaPoint p;
  p.image = &camera_.images[camera_.space.face_of(world)];
  p.seen = p.image->seen(world);
  const glm::dvec3 n = p.image->turned(gbuffer_->normal(index)), ray = p.seen / p.seen.z;
  p.position = glm::dvec2(ray) * p.image->scale + p.image->offset;
  const double height = -glm::dot(n, p.seen), width = p.image->largest_texel(p.seen);
  p.facing = height / p.seen.z;
  p.step_height = glm::dvec2(n) / p.image->scale;
  p.depth = height - (camera_.rounding * (1 + p.seen.z * p.seen.z / (p.image->near * p.image->far)) + width / 128);
  p.bias = depth_bias * width;
  const Figure figure = figure_of(light_);
  glm::dvec3 u = p.image->turned(figure.half_u), v = p.image->turned(figure.half_v);
  if (figure.radius > 0) {
    const double share = figure.radius * figure.radius / glm::dot(p.seen, p.seen);
    const double around = figure.radius / std::sqrt(std::max(1 - share, 1e-6));
    u = around * glm::normalize(glm::dvec3(0, 1, -ray.y));
    v = around * glm::normalize(glm::cross(ray, u));
  }
  p.figure = {(glm::dvec2(u) - glm::dvec2(ray) * u.z) * p.image->scale,
              (glm::dvec2(v) - glm::dvec2(ray) * v.z) * p.image->scale};
  p.tilt = glm::dvec2(u.z, v.z) / p.seen.z;
  p.horizon = {height, glm::dot(n, u), glm::dot(n, v)};
  p.is_disc = figure.is_disc;
  return p;
}

std::vector<std::uint32_t> AreaMap::image_parts() const { return parts_of(camera_, *made_->scene, *gbuffer_, light_); }

std::vector<DebugLayer> AreaMap::debug_layers() const {
  std::vector<DebugLayer> layers = map_layers();
  layers.push_back({"radius",
                    "How far texels were read from a point's own, in texels along the longer way, over the dimmed picture.",
                    heat_legend()});
  return layers;
}

std::vector<float> AreaMap::draw_debug(std::string_view layer) const {
  if (layer == "map")
    return paint_map(camera_, gbuffer_->width, gbuffer_->height,
                     [&](std::size_t face) { return camera_.texels_of(camera_.images[face], depths()); });
  if (layer == "radius") {
    std::vector<float> radius(gbuffer_->size());
    for (std::size_t i = 0; i < radius.size(); ++i) {
      if (!faces(i)) continue;
      const glm::dvec2 reach = point(i).reach() * double(accounts()[i].z);
      radius[i] = static_cast<float>(std::max({reach.x, reach.y, 0.0}));
    }
    return heat_layer(*gbuffer_, radius);
  }
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<LookUp> look_ups(gbuffer_->size());
  for (std::size_t i = 0; i < look_ups.size(); ++i) {
    if (!faces(i)) continue;
    const AreaPoint p = point(i);
    look_ups[i] = {camera_.space.face_of(gbuffer_->position(i)),
                   p.image->layer < 0 ? glm::ivec2(-1) : glm::ivec2(glm::floor(p.position))};
  }
  return paint_texels(camera_, *made_->scene, *gbuffer_, light_, look_ups, answer(images_));
}

}  // namespace gnomon
