#include <gnomon/kit/maps/glass_map.h>

namespace gnomon {

namespace {

/// `depth_row` and `glass_origin` make t linear in the point.
const std::string glass_vertex = std::string(position_snippet) + std::string(transmission_vertex_snippet) + R"(
uniform vec4 depth_row;
uniform vec3 glass_origin;
out float glass_depth;
void main() {
  gl_Position = place(vec4(position, 1));
  glass_depth = dot(depth_row.xyz, position - glass_origin) + depth_row.w;
  hand_on_transmission();
#ifdef MASKED
  hand_on_mask();
#endif
}
)";

constexpr std::string_view glass_body = R"(
in float glass_depth;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  float transmission = transmission_here();
  if (!(transmission > 0 && transmission < 1) || glass_depth > 1) discard;
  draw_glass(max(glass_depth, 0), transmission);
}
)";

const std::string opaque_vertex = std::string(position_snippet) + std::string(transmission_vertex_snippet) + R"(
void main() {
  gl_Position = place(vec4(position, 1));
  hand_on_transmission();
#ifdef MASKED
  hand_on_mask();
#endif
}
)";

constexpr std::string_view opaque_body = R"(
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  if (transmission_here() != 0) discard;
}
)";

/// Far of the images, for cubes of those along the axes of the world and against them.
constexpr std::string_view far_constants = "vec3 glass_along; vec3 glass_against;";
constexpr int far_constant_count = 2;
constexpr std::string_view far_snippet = R"(
float glass_far() {
#if PROJECTION == 2
  vec3 far = light_is_against ? glass_against : glass_along;
  return light_is_x ? far.x : light_is_y ? far.y : far.z;
#else
  return glass_along.x;
#endif
}
)";

constexpr std::string_view look_up_body = R"(
layout(location = 0) out vec4 answer;
void main() {
  ComparedPoint point = ask(position_here(), normal_here());
  float opaque = compared(point), share = 1;
#if HAS_GLASS
  float near = light_facts.z, z = point.depth / point.scale - point.bias;
  bool inside = all(greaterThanEqual(point.position, vec2(0))) &&
                all(lessThan(point.position, vec2(textureSize(light_map, 0).xy)));
  float t = clamp((z - near) / (glass_far() - near), 0, 1);
  share = inside && point.is_compared ? clamp(glass_share(point.position, light_facts.x, t), 0, 1) : 1;
#endif
#if EXPLAINS
  answer = vec4(point.position, share, 8 * light_facts.x + 7 * opaque);
#else
  answer = vec4(opaque * share, 0, 0, 0);
#endif
}
)";

/// A row of pixels is one place at depths 0 .. 1: column, row, layer, and how many steps.
constexpr std::string_view curve_body = R"(
uniform vec4 light_asked;
layout(location = 0) out vec4 answer;
void main() {
  float t = (gl_FragCoord.x - 0.5) / light_asked.w;
  answer = vec4(clamp(glass_share(light_asked.xy, light_asked.z, t), 0, 1), 0, 0, 0);
}
)";

bool has_opaque_texels(const Mesh& mesh) {
  const Transmission& one = *mesh.transmission;
  return std::ranges::find(one.values(), 0.0f) != one.values().end();
}

}  // namespace

const std::string_view filtered_shares = R"(
float glass_share(vec2 place, float layer, float t) {
#if GLASS_FILTER == 0
  return glass_at(ivec3(place, layer), t);
#else
  ivec2 last = textureSize(light_map, 0).xy - 1;
  vec2 low = floor(place - 0.5), weight = place - 0.5 - low;
  ivec2 a = clamp(ivec2(low), ivec2(0), last), b = clamp(ivec2(low) + 1, ivec2(0), last);
  int k = int(layer);
  float upper = mix(glass_at(ivec3(a, k), t), glass_at(ivec3(b.x, a.y, k), t), weight.x);
  float lower = mix(glass_at(ivec3(a.x, b.y, k), t), glass_at(ivec3(b, k), t), weight.x);
  return mix(upper, lower, weight.y);
#endif
}
)";

void GlassDrawing::draw(const LightImage& image) const {
  programs_.set("clip_from_world", glm::mat4(image.clip_from_world(camera.resolution)));
  programs_.set_if_used("glass_origin", glm::vec3(image.origin));
  const double range = image.far - image.near;
  programs_.set_if_used("depth_row", glm::vec4(image.axis(2) / range, -image.near / range));
  buffers_.bind_transmissions();
  std::vector<std::uint32_t> drawn;
  for (const std::uint32_t m : image.casters) {
    if (!is_glass_[m]) continue;
    drawn.push_back(m);
    drawn_triangles_ += buffers_.meshes[m].triangle_count;
  }
  buffers_.draw(drawn, programs_);
}

GlassMap::GlassMap()
    : resolution(this, "resolution", 1024, {.unit = "texel", .min = 64, .max = 4096, .log = true}, Stage::relight,
                 "Side of a square image (of each cube face for point lights)."),
      depth_bias(this, "depth_bias", 0.25, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                 "Constant bias along the image's axis, in world widths of a texel at the point; before opaque casters and "
                 "glass alike."),
      slope_bias(this, "slope_bias", 1, {.unit = "half texel diagonal", .min = 0, .max = 16}, Stage::resolve,
                 "Slope-scaled bias, times the tangent of the angle between normal and light."),
      filter(
          this, "filter", "nearest", {"nearest", "bilinear"}, Stage::setup,
          "The texel at the point, or the four nearest with the weights of graphics cards; biases are twice as large then.") {}

MapComparison GlassMap::comparison() const {
  const MapFilter used{is_bilinear() ? MapFilter::Kind::bilinear : MapFilter::Kind::nearest, 0};
  const double reach = used.reach();
  return {MapComparison::Bias::slope, reach * depth_bias, reach * slope_bias, 0, used};
}

Support GlassMap::supports(const Scene& scene, const Light& light, const View&) const {
  const Support support = light_map_support(light, resolution, comparison().margin(), MapComparison::constant_count);
  if (!support || !scene.has_transmission()) return support;
  const Support enough = glass_support(light, scene.has_alpha_masks());
  return enough ? support : enough;
}

Support GlassMap::glass_support(const Light& light, bool has_masks) const {
  const int constants = MapComparison::constant_count + far_constant_count + method().constant_count;
  const Support support = light_map_support(light, resolution, comparison().margin(), constants);
  if (!support) return support;
  GlLimits needed = glass_needs();
  needed.fragment_storage_blocks += has_masks ? 2 : 1;
  needed.storage_bindings = std::max<std::int64_t>(needed.storage_bindings, has_masks ? 8 : 7);
  return within_limits(needed);
}

Program GlassMap::look_up_program(LightProjection projection, bool has_glass, Purpose purpose) const {
  constexpr std::string_view names[] = {"resolve", "explain", "curve"};
  const Method how = method();
  std::string constants = comparison_constants(projection);
  if (has_glass) constants += std::string(far_constants) + how.constants;
  return pass_program(
      fmt::format("{} {}", id(), names[static_cast<int>(purpose)]), constants,
      fmt::format("{}{}#define HAS_GLASS {:d}\n#define EXPLAINS {:d}\n#define GLASS_FILTER {:d}\n{}{}{}{}{}{}{}",
                  light_map_head(projection), comparison_head(comparison()), has_glass, purpose == Purpose::explain,
                  is_bilinear(), gbuffer_snippet, light_map_snippet, comparison_snippet, filter_snippet,
                  has_glass ? far_snippet : "", has_glass ? how.share : "",
                  purpose == Purpose::curve ? curve_body : look_up_body));
}

void GlassMap::setup() {
  made_->depth_images.setup();
  made_->framebuffer = make_framebuffer();
  made_->glass_framebuffer = make_framebuffer();
  for (int i = 0; i < light_projection_count; ++i) {
    for (auto& programs : made_->explain_programs) programs[i].reset();
    made_->curve_programs[i].reset();
    made_->resolve_programs[0][i] = look_up_program(LightProjection(i), false, Purpose::resolve);
  }
  warm_up(*this);
  // A device may be too small for glass, and large enough for scenes without it.
  if (!glass_support({.kind = DirectionalLight{}}, false)) return;
  made_->glass_programs = CasterPrograms(fmt::format("{} glass", id()), glass_vertex,
                                         fmt::format("{}{}{}", transmission_fragment_snippet, method().draw, glass_body));
  made_->opaque_programs =
      CasterPrograms("opaque texels of glass", opaque_vertex, fmt::format("{}{}", transmission_fragment_snippet, opaque_body));
  for (int i = 0; i < light_projection_count; ++i)
    made_->resolve_programs[1][i] = look_up_program(LightProjection(i), true, Purpose::resolve);
  setup_glass();
  warm_up(*this, true);
}

void GlassMap::build(const Scene& scene) {
  made_->scene = &scene;
  made_->read_of = nullptr;
  made_->lists.reset();
  made_->exact.reset();
  made_->depth_images.build(scene, AlphaRule::texel, GlassAs::none);
  made_->boxes = mesh_boxes(scene);
  made_->is_glass.clear();
  made_->has_opaque_texels.clear();
  for (const Mesh& mesh : scene.meshes) {
    made_->is_glass.push_back(mesh.casts && mesh.transmission);
    made_->has_opaque_texels.push_back(made_->is_glass.back() && has_opaque_texels(mesh));
  }
  made_->has_glass = std::ranges::find(made_->is_glass, true) != made_->is_glass.end();
  if (!made_->has_glass) return;
  made_->glass_programs.fit(scene);
  made_->opaque_programs.fit(scene);
}

void GlassMap::update(const Scene& scene, const Changes& changes) {
  if (!made_->depth_images.update(scene, changes)) return build(scene);
  made_->read_of = nullptr;
  made_->lists.reset();
  made_->exact.reset();
}

void GlassMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  still_.start_relight(made_->depth_images.moving(), update_by);
  still_.is_drawn_over = made_->has_glass;
  if (made_->read_of == this) made_->read_of = nullptr;
  camera_ = fit_to_scene(light, made_->boxes, resolution, comparison().margin());
  LightCamera opaque = camera_;
  for (LightImage& image : opaque.images) std::erase_if(image.casters, [&](std::uint32_t m) { return made_->is_glass[m]; });
  drawn_triangles_ = made_->depth_images.draw(opaque, depths_, still_, DepthImages::Faces::lit, {});
  if (made_->has_glass) {
    draw_opaque_texels();
    draw_all_glass();
  } else {
    release_glass();
  }
  glFinish();
}

void GlassMap::draw_all_glass() {
  const GLuint framebuffer = made_->glass_framebuffer.name();
  glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_WIDTH, camera_.resolution);
  glNamedFramebufferParameteri(framebuffer, GL_FRAMEBUFFER_DEFAULT_HEIGHT, camera_.resolution);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, camera_.resolution, camera_.resolution);
  glEnable(GL_DEPTH_CLAMP);
  const GlassDrawing glass(camera_, made_->glass_framebuffer, scene_buffers(*made_->scene), made_->glass_programs,
                           made_->is_glass);
  draw_glass(glass);
  drawn_triangles_ += glass.drawn_triangles();
  for (GLenum k = 0; k < 8; ++k) glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0 + k, 0, 0);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, 0, 0);
}

/// Into the depth map that is there.
void GlassMap::draw_opaque_texels() {
  const std::vector<bool>& has_some = made_->has_opaque_texels;
  if (std::ranges::find(has_some, true) == has_some.end()) return;
  const GLuint framebuffer = made_->glass_framebuffer.name();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, camera_.resolution, camera_.resolution);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_DEPTH_CLAMP);
  glDepthFunc(GL_GREATER);
  const GlassDrawing glass(camera_, made_->glass_framebuffer, scene_buffers(*made_->scene), made_->opaque_programs, has_some);
  glass.each_image([&](const LightImage& image) {
    glNamedFramebufferTextureLayer(framebuffer, GL_DEPTH_ATTACHMENT, depths_.name(), 0, image.layer);
    glass.draw(image);
  });
  drawn_triangles_ += glass.drawn_triangles();
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, 0, 0);
  glDisable(GL_DEPTH_TEST);
}

void GlassMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_of == this) made_->read_look_ups.clear();
  look_up(made_->resolve_programs[made_->has_glass][int(projection())], mask.texture());
  glFinish();
}

void GlassMap::look_up(const Program& program, unsigned target) const {
  set_comparison(program, light_, camera_, comparison());
  if (made_->has_glass) {
    glm::vec3 along(1), against(1);
    for (std::size_t i = 0; i < camera_.images.size(); ++i)
      (i % 2 == 0 ? along : against)[static_cast<int>(i / 2)] = static_cast<float>(camera_.images[i].far);
    program.set_if_used("glass_along", along);
    program.set_if_used("glass_against", against);
    bind_glass(program);
  }
  glBindTextureUnit(3, depths_.name());
  draw_mask(program, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
}

Counts GlassMap::counts() const {
  const double bytes = double(depths_.bytes + still_.bytes() + glass_bytes()) + made_.own(double(made_->depth_images.bytes()));
  Counts counts{{"texels", double(resolution) * resolution * camera_.layer_count, "texel"},
                {"faces", double(camera_.layer_count), ""},
                {"triangles", double(drawn_triangles_), ""},
                {"bytes", bytes, "byte"}};
  for (Count& more : more_counts()) counts.push_back(std::move(more));
  return counts;
}

}  // namespace gnomon
