#include <gnomon/kit/maps/filtered_map.h>
#include <gnomon/kit/maps/light_layers.h>

namespace gnomon {

namespace {

/// Depths of an image as what means are taken of. The head defines PROJECTION as 0 for parallel rays, and IS_TABLE.
constexpr std::string_view encode_body = R"(
layout(binding = 3) uniform sampler2DArray depths;
#if IS_TABLE
layout(location = 0) out uvec4 encoded;
#else
layout(location = 0) out vec4 encoded;
#endif
void main() {
  float d = texelFetch(depths, ivec3(gl_FragCoord.xy, int(image.x)), 0).r, near = image.y, far = image.z;
#if PROJECTION == 0
  float t = 1 - d;
#else
  float t = d > 0 ? min((near / d - near) / (far - near), 1) : 1;
#endif
#if IS_TABLE
  encoded = uvec4(clamp(encode(t) * to_one, 0, 1) * image.w + 0.5);
#else
  encoded = encode(t);
#endif
}
)";

constexpr std::string_view filter_body = R"(
layout(location = 0) out float visibility;
void main() {
  vec4 position = position_here(), normal = normal_here();
  vec3 v = position.xyz - light_origin;
  choose_image(v);
  vec3 place = in_image(v);
  float width = light_facts.y;  // of a texel, meters
#if PROJECTION != 0
  place.xy /= place.z, width *= place.z;
#endif
  vec2 size = vec2(image_side);
  bool inside = all(greaterThanEqual(place.xy, vec2(0))) && all(lessThan(place.xy, size));
  float bias = look_up.x, leak_reduction = look_up.y;
  float near = light_facts.z, far = light_facts.w, t = clamp((place.z - bias * width - near) / (far - near), 0, 1);
  float lit = answer(mean_at(place, position.xyz, normal.xyz), t);
  lit = clamp((lit - leak_reduction) / (1 - leak_reduction), 0, 1);
  visibility = inside && faces_light_at(position, normal, v) ? lit : 1;
}
)";

}  // namespace

Support FilteredMap::supports(const Scene& scene, const Light& light, const View&) const {
  const Prefilter filter = used_prefilter();
  // The constants of the look-up, and the method's.
  Support support = light_map_support(light, resolution, filter.margin(), 2 + prefilter_constant_count(filter.kind));
  if (support) support = filter.supports(light, resolution);
  if (support && has_table() && has_16_bits())
    support = Support::unsupported("sums of a table need 32 bits: prefilter=table takes bits=32");
  return glass.limit(scene, alpha.limit(scene, support ? method_support() : support));
}

GLenum FilteredMap::format() const {
  const Texel holds = texel();
  const int k = holds.channels == 1 ? 0 : holds.channels == 2 ? 1 : 2;
  if (has_table()) return std::array{GL_R32UI, GL_RG32UI, GL_RGBA32UI}[k];
  if (!has_16_bits()) return std::array{GL_R32F, GL_RG32F, GL_RGBA32F}[k];
  return holds.is_within_one ? std::array{GL_R16, GL_RG16, GL_RGBA16}[k] : std::array{GL_R16F, GL_RG16F, GL_RGBA16F}[k];
}

void FilteredMap::setup() {
  const Method how = method();
  const Prefilter filter = used_prefilter();
  made_->depth_images.setup();
  for (int k = 0; k < 2; ++k)
    made_->encode_programs[k] = pass_program(
        fmt::format("{} encode", id()), how.constants + "vec4 image; vec4 to_one;",
        fmt::format("#define PROJECTION {}\n#define IS_TABLE {:d}\n{}{}", k, has_table(), how.encode, encode_body));
  // The size of what is looked up: known sooner than the value of a uniform.
  const std::string side = fmt::format("#define image_side textureSize({}, 0).xy\n", has_table() ? "light_sums" : "light_map");
  for (int k = 0; k < light_projection_count; ++k) {
    const LightProjection projection = LightProjection(k);
    made_->resolve_programs[k] =
        pass_program(fmt::format("{} resolve", id()),
                     light_map_constants(projection) + prefilter_constants(filter.kind) + how.constants + "vec2 look_up;",
                     fmt::format("{}{}{}{}{}{}{}", light_map_head(projection), gbuffer_snippet, light_map_snippet,
                                 prefilter_snippet(filter.kind), how.answer, side, filter_body));
  }
  const ImageKind kind{.format = format(), .has_layers = true};
  if (is_blurred()) made_->blur.setup(kind, filter.weights, filter.radius);
  if (filter.kind == Prefilter::Kind::mips) made_->mips.setup(kind);
  if (has_table()) made_->table.setup(kind);
  made_->framebuffer = make_framebuffer();
  warm_up(*this);
}

void FilteredMap::build(const Scene& scene) {
  made_->scene = &scene;
  made_->unblurred = {};
  made_->depth_images.build(scene, alpha.rule(), glass.as());
  made_->glass_difference = {scene, glass.as()};
}

void FilteredMap::update(const Scene& scene, const Changes& changes) {
  if (!made_->depth_images.update(scene, changes)) return build(scene);
  made_->glass_difference = {scene, glass.as()};
}

void FilteredMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  images_.still.start_relight(made_->depth_images.moving(), update_by);
  if (!update_by.keeps_layers()) made_->unblurred = {};
  made_->depth_images.use_alpha(alpha.rule());
  if (fit.is("scene")) draw_images(fit_to_scene(light, made_->depth_images.boxes(), resolution, used_prefilter().margin()));
  glFinish();
}

void FilteredMap::draw_images(LightCamera&& camera) {
  if (made_->read_of == this) made_->read_of = nullptr;
  camera_ = std::move(camera);
  drawn_triangles_ = draw(images_, made_->depth_images.hole_test());
}

std::size_t FilteredMap::draw(Images& images, const HoleTest& test) const {
  const std::size_t triangles = made_->depth_images.draw(camera_, images.depths, images.still, DepthImages::Faces::lit, test);
  const Prefilter by = used_prefilter();
  const bool has_levels = by.kind == Prefilter::Kind::mips;
  Texture& means = images.means;
  means.fit(format(), resolution, resolution, std::max(camera_.layer_count, 1), has_levels ? by.last_level() + 1 : 1);
  if (!has_table()) {
    glTextureParameteri(means.name(), GL_TEXTURE_MIN_FILTER, has_levels ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
    glTextureParameteri(means.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  }
  filter(images);
  return triangles;
}

std::string FilteredMap::filter_settings() const {
  std::string all;
  for (const Parameter* const parameter : parameters())
    if (parameter->spoils() < Stage::resolve) all += parameter->text() + ",";
  return all;
}

void FilteredMap::filter(Images& images) const {
  Texture& means = images.means;
  const int radius = is_blurred() ? blur_radius.value() : 0;
  std::optional<std::vector<LayerRectangle>> only;
  if (has_table() || !images.still.is_used())
    images.moved = {};
  else
    only = images.moved.start(made_->depth_images, images.still, camera_, filter_settings(), radius);
  images.filtered_texels = only ? 0 : double(resolution) * resolution * camera_.layer_count;
  if (only)
    for (const auto& [layer, texels] : *only)
      images.filtered_texels += double(texels.right - texels.left) * (texels.bottom - texels.top);
  if (is_blurred() && images.still.is_used()) {
    Texture& unblurred = made_->unblurred;
    unblurred.fit(means.format, means.width, means.height, means.layers);
    encode(images.depths, unblurred, only ? &*only : nullptr, radius);
    if (only)
      made_->blur.run(unblurred, means, *only);
    else
      made_->blur.run(unblurred, means);
  } else {
    encode(images.depths, means, only ? &*only : nullptr, radius);
    if (is_blurred()) made_->blur.run(means, means);
  }
  if (used_prefilter().kind == Prefilter::Kind::mips) made_->mips.run(means);
  if (has_table()) made_->table.run(means, means);
  images.moved.end();
}

void FilteredMap::encode(const Texture& depths, const Texture& to, const std::vector<LayerRectangle>* only, int around) const {
  const Program& program = made_->encode_programs[camera_.space.is_parallel() ? 0 : 1];
  const GLuint framebuffer = made_->framebuffer.name();
  set_constants(program);
  program.set_if_used("to_one", texel().to_one);
  glBindTextureUnit(3, depths.name());
  glUseProgram(program.name());
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, resolution, resolution);
  if (only) glEnable(GL_SCISSOR_TEST);
  for (const LightImage& image : camera_.images) {
    if (image.layer < 0) continue;
    glNamedFramebufferTextureLayer(framebuffer, GL_COLOR_ATTACHMENT0, to.name(), 0, image.layer);
    program.set_if_used("image", glm::vec4(image.layer, image.near, image.far, used_prefilter().whole()));
    if (!only) {
      draw_full_screen();
      continue;
    }
    for (const auto& [layer, texels] : *only) {
      if (layer != image.layer) continue;
      const int left = std::max(texels.left - around, 0), top = std::max(texels.top - around, 0);
      glScissor(left, top, std::min(texels.right + around, resolution.value()) - left,
                std::min(texels.bottom + around, resolution.value()) - top);
      draw_full_screen();
    }
  }
  glDisable(GL_SCISSOR_TEST);
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, 0, 0);
}

void FilteredMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_of == this) made_->alpha_difference.reset();
  if (fit.is("view"))
    draw_images(fit_to_view(light_, made_->depth_images.boxes(), gbuffer, resolution, used_prefilter().margin()));
  look_up(images_, mask.texture());
  glFinish();
}

void FilteredMap::look_up(const Images& images, unsigned target) const {
  const Program& program = made_->resolve_programs[static_cast<int>(projection_of(camera_))];
  set_light_camera(program, light_, camera_);
  set_constants(program);
  program.set("look_up", glm::vec2(bias.value(), leak_reduction.value()));
  set_prefilter(program, used_prefilter(), gbuffer_->view, gbuffer_->width, gbuffer_->height, texel().to_one);
  glBindTextureUnit(has_table() ? 4 : 3, images.means.name());
  draw_mask(program, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
}

Counts FilteredMap::counts() const {
  const double texels = double(resolution) * resolution * camera_.layer_count;
  // The blur's own image is as large as that which it blurs, and so is the one that it takes where there are layers.
  const std::size_t blurred_bytes = is_blurred() ? images_.means.bytes * (images_.still.is_used() ? 2 : 1) : 0;
  const double bytes = double(images_.depths.bytes + images_.still.bytes() + images_.means.bytes + images_.moved.bytes());
  Counts counts = {{"texels", texels, "texel"},
                   {"faces", double(camera_.layer_count), ""},
                   {"triangles", double(drawn_triangles_), ""},
                   {"bytes", bytes + made_.own(double(made_->depth_images.bytes() + blurred_bytes)), "byte"}};
  if (images_.still.is_used()) counts.push_back({"filtered", images_.filtered_texels, "texel"});
  return counts;
}

void FilteredMap::start_questions() const {
  if (made_->read_of == this) return;
  made_->read_of = this;
  made_->read_depths.clear();
  made_->alpha_difference.reset();
}

const std::vector<float>& FilteredMap::depths() const {
  start_questions();
  if (made_->read_depths.empty()) made_->read_depths = read_texels<float>(images_.depths, GL_DEPTH_COMPONENT);
  return made_->read_depths;
}

/// The mask of the last resolve, once more, of these images of its camera.
std::vector<float> FilteredMap::answer(const Images& images) const {
  return read_mask(*gbuffer_, [&](unsigned target) { look_up(images, target); });
}

std::string_view FilteredMap::alpha_cause(std::size_t index) const {
  const AlphaRule rule = made_->depth_images.hole_test().rule;
  if (rule == AlphaRule::texel) return "";
  start_questions();
  const auto draw_by_texel = [&](Images& by_texel) { draw(by_texel, {}); };
  return AlphaDifference::cause(made_->alpha_difference, rule, made_->glass_difference.has_glass(), index, images_,
                                draw_by_texel, [&](const Images& one) { return answer(one); });
}

/// The taps are the texels whose means were looked up, each with its weight.
Explanation FilteredMap::explain_look_up(std::size_t index, const LightImage& image) const {
  const glm::dvec3 point = gbuffer_->position(index);
  const glm::dvec2 place = image.texel_of(image.place_of(point));
  const Camera camera(gbuffer_->view, gbuffer_->width, gbuffer_->height);
  const glm::dmat2 pixel = pixel_on_image(image, camera, point, gbuffer_->normal(index));
  Explanation why;
  why.texel_width = image.largest_texel(image.seen(point));
  why.bias = bias * why.texel_width * image.stretch(point);
  why.covered = camera_.holds(glm::ivec2(glm::floor(place)));
  for (const auto& [texel, weight] : used_prefilter().texels(place, pixel, resolution))
    why.taps.push_back(camera_.tap(image, depths(), texel, weight));
  why.cause = alpha_cause(index);
  return why;
}

std::optional<Explanation> FilteredMap::explain(std::size_t index) const {
  Explanation why;
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
  const LightImage& image = camera_.images[camera_.space.face_of(gbuffer_->position(index))];
  if (image.layer >= 0) why = explain_look_up(index, image);  // else nothing casts there
  made_->glass_difference.explain(why, *gbuffer_, light_, index);
  return why;
}

std::vector<std::uint32_t> FilteredMap::image_parts() const { return parts_of(camera_, *made_->scene, *gbuffer_, light_); }

std::vector<DebugLayer> FilteredMap::debug_layers() const { return map_layers(); }

std::vector<float> FilteredMap::draw_debug(std::string_view layer) const {
  if (layer == "map")
    return paint_map(camera_, gbuffer_->width, gbuffer_->height,
                     [&](std::size_t face) { return camera_.texels_of(camera_.images[face], depths()); });
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<LookUp> look_ups(gbuffer_->size());
  for (std::size_t i = 0; i < look_ups.size(); ++i) {
    if (!faces_light(*made_->scene, *gbuffer_, light_, i)) continue;
    const int face = camera_.space.face_of(gbuffer_->position(i));
    const LightImage& image = camera_.images[face];
    const glm::dvec2 place = image.texel_of(image.place_of(gbuffer_->position(i)));
    look_ups[i] = {face, image.layer < 0 ? glm::ivec2(-1) : glm::ivec2(glm::floor(place))};
  }
  return paint_texels(camera_, *made_->scene, *gbuffer_, light_, look_ups, answer(images_));
}

}  // namespace gnomon
