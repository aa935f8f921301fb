#include <gnomon/kit/maps/compared_map.h>

namespace gnomon {

namespace {

/// The decision of who has none.
constexpr std::string_view depths_decide = R"(
float decided(vec4 surface, vec4 facet, ComparedPoint point) { return compared(point); }
float noted(vec4 surface, vec4 facet, ComparedPoint point) { return 0; }
)";

constexpr std::string_view compare_body = R"(
float visibility_here() {
  vec4 surface = position_here(), facet = normal_here();
  return decided(surface, facet, ask(surface, facet));
}
)";

/// Writes where that looks, in texels, or the place of the texel beside whose answer it takes; the layer of the image, by
/// DECIDED_EARLY more where five texels decide; and what the decision notes.
constexpr std::string_view explain_body = R"(
layout(location = 0) out vec4 looked_up;
void main() {
  vec4 surface = position_here(), facet = normal_here();
#ifdef AGAIN
  ComparedPoint point = asked_again(surface, facet);
#else
  ComparedPoint point = ask(surface, facet);
#endif
  vec4 facts = light_facts;
  vec2 place = point.position;
#if FILTER == 7
  compared(point);
  place = decided_at;
#elif defined(BAILS_EARLY)
  compared(point);
  facts.x += is_decided_early ? DECIDED_EARLY : 0;
#endif
  looked_up = vec4(place, facts.x, noted(surface, facet, point));
}
)";

std::vector<std::string_view> bias_choices() {
  std::vector<std::string_view> choices = {"constant", "slope", "normal_offset", "receiver_plane", "adaptive"};
  for (const BiasPreset& preset : bias_presets()) choices.push_back(preset.name);
  return choices;
}

}  // namespace

ComparedMap::ComparedMap(const Defaults& defaults)
    : resolution(this, "resolution", 1024, {.unit = "texel", .min = 64, .max = 8192, .log = true}, Stage::relight,
                 "Side of a square depth image (of each cube face for point lights)."),
      bias(
          this, "bias", defaults.bias, bias_choices(), Stage::setup,
          "What is added to depth_bias: nothing, a slope-scaled bias, a normal offset, or the receiver's own plane. Or a rule "
          "without a setting: that plane with an epsilon by the scene's size (adaptive), a length toward the light (oriented), "
          "or the defaults of an engine."),
      depth_bias(this, "depth_bias", defaults.depth_bias, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                 "Constant depth bias along the image's axis, in world widths of a texel at the point; for "
                 "bias=constant, slope, normal_offset and receiver_plane."),
      slope_bias(this, "slope_bias", defaults.slope_bias, {.unit = "half texel diagonal", .min = 0, .max = 16}, Stage::resolve,
                 "Slope-scaled bias, times the tangent of the angle between normal and light; for bias=slope."),
      normal_offset(this, "normal_offset", 1.5, {.unit = "texel", .min = 0, .max = 16}, Stage::relight,
                    "How far the look-up point is moved along the normal; for bias=normal_offset."),
      pass(this, "pass", name(default_mask_pass), {name(MaskPass::fragment), name(MaskPass::compute)}, Stage::setup,
           "Points are looked up by fragments of a triangle over the picture, or by invocations of a compute shader. The mask "
           "is the same."),
      faces(this, "faces", "front", {"front", "back", "both"}, Stage::relight,
            "Which faces of closed casters images show: those turned to the light, those turned away, or both; of open ones "
            "all. For what stores the first surface."),
      depth_bits(this, "depth_bits", "32", {"16", "24", "32"}, Stage::relight,
                 "What a texel stores depth in: 16 or 24 bits of fixed point, or a float of 32 bits. For what stores the first "
                 "surface."),
      depth_order(this, "depth_order", "reversed", {"reversed", "forward"}, Stage::setup,
                  "Whether depth falls from 1 next to the light, or rises to 1 far from it, where a float has the steps of 24 "
                  "bits. For what stores the first surface.") {}

const BiasPreset* ComparedMap::preset() const {
  constexpr int first = static_cast<int>(MapComparison::Bias::preset);
  return bias.index() < first ? nullptr : &bias_presets()[bias.index() - first];
}

MapComparison ComparedMap::comparison(const Light& light) const {
  using Bias = MapComparison::Bias;
  const MapFilter used = filter.used();
  if (const BiasPreset* const chosen = preset()) {
    const BiasNumbers numbers = chosen->numbers(light).value_or(BiasNumbers{});
    return {Bias::preset, numbers.texels, numbers.slope, numbers.normal, used, numbers.meters, chosen->form};
  }
  const auto kind = Bias(bias.index());
  if (kind == Bias::adaptive) return {kind, 0, 0, 0, used, adaptive_share * made_->diagonal};
  const double reach = used.reach();
  const BiasForm form{.normal = kind == Bias::normal_offset ? BiasForm::Normal::whole : BiasForm::Normal::none};
  return {kind, reach * depth_bias, reach * slope_bias, reach * normal_offset, used, 0, form};
}

Support ComparedMap::supports(const Scene& scene, const Light& light, const View&) const {
  if (const Support filtered = filter.support(); !filtered) return filtered;
  if (filter.used().kind == MapFilter::Kind::revectorized && !bias.is("receiver_plane") && !bias.is("adaptive"))
    return Support::unsupported(
        "filter=revectorized follows edges over many texels, which bias=receiver_plane and adaptive alone compare with");
  if (const Support passes = within_limits(mask_pass_needs(mask_pass())); !passes) return passes;
  const Support support =
      light_map_support(light, resolution, comparison(light).margin(), MapComparison::constant_count, images());
  if (const BiasPreset* const chosen = preset(); chosen && support)
    if (const auto why = chosen->refusal(light, diagonal_of(scene))) return Support::unsupported(*why);
  return glass.limit(scene, alpha.limit(scene, coarse_depth(scene, light, support)));
}

Program ComparedMap::resolve_program(LightProjection projection, Purpose purpose) const {
  const std::string head = fmt::format("{}{}{}#define DECIDED_EARLY {}\n", light_map_head(projection, images()),
                                       order() == DepthOrder::forward ? "#define FORWARD_DEPTH\n" : "",
                                       comparison_head(comparison(light_)), decided_early);
  const std::string by_more = decision(), constants = comparison_constants(projection, images());
  const std::string text = fmt::format("{}{}{}{}{}", head, light_map_snippet, comparison_snippet, filter_snippet,
                                       by_more.empty() ? depths_decide : by_more);
  if (purpose == Purpose::resolve)
    return mask_program(fmt::format("{} resolve", id()), constants, text + std::string(compare_body), mask_pass());
  return pass_program(
      fmt::format("{} explain", id()), constants,
      fmt::format("{}{}{}{}", purpose == Purpose::explain_again ? "#define AGAIN\n" : "", gbuffer_snippet, text, explain_body));
}

void ComparedMap::setup() {
  made_->depth_images.setup();
  for (int i = 0; i < light_projection_count; ++i) {
    for (auto& programs : made_->explain_programs) programs[i].reset();
    // Slices and warps are of one image: a cube has none.
    if (images() == LightImages::faces || LightProjection(i) != LightProjection::cube)
      made_->resolve_programs[i] = resolve_program(LightProjection(i), Purpose::resolve);
  }
  if (stored_depth().is_combined()) made_->combination.setup(stored_depth().kind);
  made_->framebuffer = make_framebuffer();
  warm_up(*this);
}

void ComparedMap::build(const Scene& scene) {
  made_->scene = &scene;
  if (bias.is("adaptive")) made_->diagonal = diagonal_of(scene);
  made_->depth_images.build(scene, alpha.rule(), glass.as());
  made_->glass_difference = {scene, glass.as()};
}

void ComparedMap::update(const Scene& scene, const Changes& changes) {
  if (!made_->depth_images.update(scene, changes)) return build(scene);
  made_->glass_difference = {scene, glass.as()};
}

// Between 1/2 and 1, where nearly all of a range around a light lies, a float has steps of 2^-24. A vertex is rounded to one
// when it is subtracted from 1, the plane between vertices is, and what is stored is: together no more than four halves.
int ComparedMap::rounding_bits() const { return bits() == 32 && order() == DepthOrder::forward ? 22 : bits(); }

Support ComparedMap::coarse_depth(const Scene& scene, const Light& light, const Support& support) const {
  if (!support || rounding_bits() == 32) return support;
  double step = 0;
  const bool is_float = bits() == 32;
  for (const LightImage& image : fit_to_scene(light, mesh_boxes(scene), resolution, comparison(light).margin()).images)
    if (!image.casters.empty()) step = std::max(step, 2 * half_depth_step(is_float ? 24 : bits(), image, image.far));
  if (step < 1) return support;
  const std::string what = is_float ? "floats of forward depth" : fmt::format("{} bits of depth", bits());
  return Support::approximate(fmt::format("{} leave steps of {:.2g} m where the scene ends", what, step));
}

void ComparedMap::relight(const Light& light) {
  const StateGuard guard;
  const GLenum format = bits() == 16 ? GL_DEPTH_COMPONENT16 : bits() == 24 ? GL_DEPTH_COMPONENT24 : GL_DEPTH_COMPONENT32F;
  made_->depth_images.use_format(format, order());
  light_ = light;
  depths_.still.start_relight(made_->depth_images.moving(), update_by);
  made_->depth_images.use_alpha(alpha.rule());
  std::optional<LightCamera> camera = fitted_to_scene(light, made_->depth_images.boxes(), comparison(light).margin());
  draws_in_resolve_ = !camera;
  if (camera) draw_images(std::move(*camera));
  glFinish();
}

void ComparedMap::draw_images(LightCamera&& camera) {
  if (made_->read_of == this) made_->read_of = nullptr;
  camera_ = std::move(camera);
  double step = 0;  // of any image: what shaders and texels round is one number of a camera, which grows with z^2 / (near far)
  for (const LightImage& image : camera_.images)
    if (image.layer >= 0)
      step = std::max(
          step, half_depth_step(rounding_bits(), image, image.is_perspective ? std::sqrt(image.near * image.far) : image.far));
  camera_.rounding += step;
  drawn_triangles_ = draw(depths_, made_->depth_images.hole_test());
  images_drawn(camera_);
}

std::size_t ComparedMap::draw(Depths& depths, const HoleTest& test) const {
  using enum DepthImages::Faces;
  DepthImages& depth_images = made_->depth_images;
  const StoredDepth stored = stored_depth();
  constexpr DepthImages::Faces shown[] = {lit, unlit, all};
  std::size_t triangles =
      depth_images.draw(camera_, depths.first, depths.still, stored.needs_second() ? all : shown[faces.index()], test);
  if (stored.needs_second()) triangles += depth_images.draw_second(camera_, depths.first, depths.second, test);
  if (stored.is_combined()) made_->combination.run(camera_, stored, depths.first, depths.second, depths.combined);
  return triangles;
}

void ComparedMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_of == this) {
    made_->read_look_ups = {};
    made_->alpha_difference.reset();
  }
  if (draws_in_resolve_) draw_images(fitted_to_view(light_, made_->depth_images.boxes(), gbuffer, comparison(light_).margin()));
  look_up(made_->resolve_programs[int(projection())], mask_pass(), depths_, mask.texture());
  glFinish();
}

void ComparedMap::look_up(const Program& program, MaskPass by, const Depths& depths, unsigned target) const {
  set_comparison(program, light_, camera_, comparison(light_));
  glBindTextureUnit(3, map(depths).name());
  bind_decision(program, light_, *gbuffer_);
  draw_mask(program, by, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
}

Counts ComparedMap::counts() const {
  const StoredDepth stored = stored_depth();
  const int images = 1 + stored.needs_second() + stored.is_combined();
  const double texels = double(resolution) * resolution * camera_.layer_count * images;
  const double bytes =
      double(images * depths_.first.bytes + depths_.still.bytes()) + made_.own(double(made_->depth_images.bytes()));
  return {{"texels", texels, "texel"},
          {"faces", double(camera_.layer_count), ""},
          {"triangles", double(drawn_triangles_), ""},
          {"bytes", bytes, "byte"}};
}

}  // namespace gnomon
