// Shadow map: one depth image from the light (six around a point light), compared once or a few times per visible point.
//
// The faces of a cube are layers of one array, drawn one by one: only faces with casters and receivers are allocated, each is
// fitted and culls meshes for itself, and a 3 x 2 atlas of the largest faces would exceed the largest texture (16384).
//
// Defaults: the bias with the lowest mean wrong rate in suite shadow_map_defaults; results/shadow_map_defaults has the sweep.
//
// The bias is a length along the axis of the image. Its parameters are in texels because acne is: a texel's world width at the
// point, times the parameter, gives meters.
#include <gnomon/kit/light_layers.h>
#include <gnomon/kit/light_map.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include "shadow_map/comparison.h"
#include "shadow_map/shaders.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Shadow map",
    .summary = "One depth image from the light, compared once per visible point.",
    .source = "Williams 1978; Reeves, Salesin and Cook 1987 (filter); Wang and Molnar 1994 (second_depth)",
    .error =
        "Stair steps of one texel diagonal along every shadow edge; acne where the bias is less than the depth spread of a "
        "texel, peter-panning where an occluder is nearer than the bias. bias=receiver_plane has no acne on flat "
        "receivers at depth_bias 0.",
    .fails = "A long shadow at a grazing angle, a fine mesh of wires, and every large scene: texels are spread over all of it.",
    .needs_gl = true,
    .is_default = true};

class ShadowMap final : public Technique {
  Number<int> resolution{this,           "resolution",
                         1024,           {.unit = "texel", .min = 64, .max = 8192, .log = true},
                         Stage::relight, "Side of the square depth image (of each cube face for point lights)."};
  Choice bias{
      this,         "bias",
      "slope",      {"constant", "slope", "normal_offset", "receiver_plane"},
      Stage::setup, "What is added to depth_bias: nothing, a slope-scaled bias, a normal offset, or the receiver's own plane."};
  Number<double> depth_bias{
      this,           "depth_bias",
      0.25,           {.unit = "texel", .min = 0, .max = 64},
      Stage::resolve, "Constant depth bias along the image's axis, in every mode, in world widths of a texel at the point."};
  Number<double> slope_bias{this,
                            "slope_bias",
                            1,
                            {.unit = "half texel diagonal", .min = 0, .max = 16},
                            Stage::resolve,
                            "Slope-scaled bias, times the tangent of the angle between normal and light; for bias=slope."};
  Number<double> normal_offset{this,
                               "normal_offset",
                               1.5,
                               {.unit = "texel", .min = 0, .max = 16},
                               Stage::relight,
                               "How far the look-up point is moved along the normal; for bias=normal_offset."};
  Choice filter{this,
                "filter",
                "nearest",
                {"nearest", "pcf", "disc", "bilinear"},
                Stage::setup,
                "One comparison, or the mean of several (percentage-closer filtering): of (2 filter_radius + 1)^2 texels, of a "
                "disc around the point, or of the four nearest with the weights of graphics cards."};
  Number<int> filter_radius{
      this,
      "filter_radius",
      1,
      {.unit = "texel", .min = 1, .max = 8},
      Stage::relight,
      "Half the side of the square beside its middle texel, less half a texel the disc's radius; for filter=pcf and disc."};
  Choice fit{this,
             "fit",
             "scene",
             {"scene", "view"},
             Stage::relight,
             "Images hold all that casters and receivers share, or what the picture shows of it: then each resolve "
             "fits and draws them anew, and pays for it."};
  Flag second_depth{this, "second_depth", false, Stage::relight,
                    "Stores the second surface seen from the light instead of the first; the far plane where there is none."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return light_map_support(light, resolution, margin(), 1);
  }
  void setup() override;
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ShadowMap::made_); }
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override { return map_layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  shadow_map::Filter used_filter() const { return {shadow_map::FilterKind(filter.index()), filter_radius}; }
  /// Biases are for one texel: a filter compares with texels farther away.
  shadow_map::Comparison comparison() const {
    const double reach = used_filter().reach();
    return {.bias = shadow_map::Bias(bias.index()),
            .depth_bias = reach * depth_bias,
            .slope_bias = reach * slope_bias,
            .normal_offset = reach * normal_offset,
            .filter = used_filter()};
  }
  /// Texels that a look-up may leave the fitted window by: the filter, the normal offset, and one for rounding.
  int margin() const {
    const int offset = bias.is("normal_offset") ? static_cast<int>(std::ceil(comparison().normal_offset)) : 0;
    return used_filter().margin() + offset + 1;
  }
  const Texture& map() const { return second_depth ? second_ : first_; }
  const std::vector<float>& depths() const;
  const std::vector<glm::vec2>& looked_up() const;
  std::vector<float> answer() const;
  void draw_images(LightCamera&& camera);
  /// Runs a program of resolve over all pixels, into a texture.
  void look_up(const Program& program, unsigned target) const;
  Program resolve_program(LightProjection projection, std::string_view title, std::string_view first_line) const;
  LightProjection projection() const { return projection_of(camera_); }

  /// What questions need, in memory: of one object at a time, for 64 lights' images fill a gigabyte.
  struct ReadBack {
    const ShadowMap* of = nullptr;
    std::vector<float> depths;         // of all layers, read at the first question after a relight
    std::vector<glm::vec2> looked_up;  // by pixel, asked for at the first question after a resolve
  };
  struct Made {
    ReadBack read_back;
    DepthImages depth_images;
    std::array<Program, light_projection_count> resolve_programs;  // of the present bias and filter
    std::array<std::optional<Program>, light_projection_count> explain_programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
  };
  Shared<Made> made_;
  ReadBack& read_back() const {
    if (made_->read_back.of != this) made_->read_back = {.of = this, .depths = {}, .looked_up = {}};
    return made_->read_back;
  }
  Light light_;
  LightCamera camera_;
  Texture first_, second_;  // arrays with one layer for each image that is drawn
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

Program ShadowMap::resolve_program(LightProjection projection, std::string_view title, std::string_view first_line) const {
  const std::string head = fmt::format("{}{}#define BIAS {}\n#define FILTER {}\n", first_line, light_map_head(projection),
                                       bias.index(), filter.index());
  return pass_program(title, shadow_map::resolve_constants(projection), head + shadow_map::resolve_fragment);
}

void ShadowMap::setup() {
  made_->depth_images.setup();
  for (int i = 0; i < light_projection_count; ++i) {
    made_->resolve_programs[i] = resolve_program(LightProjection(i), "shadow_map resolve", "");
    made_->explain_programs[i].reset();
  }
  made_->framebuffer = make_framebuffer();
  warm_up(*this);
}

void ShadowMap::build(const Scene& scene) {
  made_->scene = &scene;
  scene_buffers(scene);
  made_->depth_images.build(scene);
}

void ShadowMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  if (fit.is("scene")) draw_images(fit_to_scene(light, made_->depth_images.boxes(), resolution, margin()));
  glFinish();
}

void ShadowMap::draw_images(LightCamera&& camera) {
  if (made_->read_back.of == this) made_->read_back = {};
  camera_ = std::move(camera);
  DepthImages& images = made_->depth_images;
  drawn_triangles_ = images.draw(camera_, first_, second_depth ? DepthImages::Faces::all : DepthImages::Faces::lit);
  if (second_depth) drawn_triangles_ += images.draw_second(camera_, first_, second_);
}

void ShadowMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_back.of == this) made_->read_back.looked_up.clear();
  if (fit.is("view")) draw_images(fit_to_view(light_, made_->depth_images.boxes(), gbuffer, resolution, margin()));
  look_up(made_->resolve_programs[int(projection())], mask.texture());
  glFinish();
}

void ShadowMap::look_up(const Program& p, unsigned target) const {
  set_light_camera(p, light_, camera_, [&](const LightImage& image) {
    if (!image.is_perspective) return image.far;
    return bias.is("slope") ? glm::length(1.0 / image.scale) : camera_.rounding / (image.near * image.far);
  });
  const shadow_map::Comparison compared = comparison();
  p.set_if_used("radius", filter_radius.value());
  p.set_if_used("biases", glm::vec4(compared.depth_bias, 0.5 * compared.slope_bias, compared.normal_offset, camera_.rounding));
  p.set_if_used("diagonal", static_cast<float>(glm::length(1.0 / camera_.images[0].scale)));
  const GBufferTextures& textures = gbuffer_textures(*gbuffer_, *made_->scene);
  bind_gbuffer(textures);
  glBindTextureUnit(3, map().name());
  begin_mask(made_->framebuffer, target, textures);
  glUseProgram(p.name());
  draw_receivers(textures);
}

Counts ShadowMap::counts() const {
  const double texels = double(resolution) * resolution * camera_.layer_count * (second_depth ? 2 : 1);
  const double bytes =
      double(first_.bytes + (second_depth ? second_.bytes : 0)) + made_.own(double(made_->depth_images.bytes()));
  return {{"texels", texels, "texel"},
          {"faces", double(camera_.layer_count), ""},
          {"triangles", double(drawn_triangles_), ""},
          {"bytes", bytes, "byte"}};
}

const std::vector<float>& ShadowMap::depths() const {
  std::vector<float>& depths = read_back().depths;
  if (depths.empty()) depths = read_texels<float>(map(), GL_DEPTH_COMPONENT);
  return depths;
}

/// Where each pixel looked in the last resolve, in texels, by the very shader: next to a border of texels, float32 decides.
const std::vector<glm::vec2>& ShadowMap::looked_up() const {
  std::vector<glm::vec2>& looked_up = read_back().looked_up;
  if (!looked_up.empty()) return looked_up;
  const StateGuard guard;
  auto& program = made_->explain_programs[int(projection())];
  if (!program) program = resolve_program(projection(), "shadow_map explain", "#define EXPLAIN\n");
  const Texture texels(GL_RG32F, gbuffer_->width, gbuffer_->height);
  look_up(*program, texels.name());
  looked_up = read_texels<glm::vec2>(texels, GL_RG);
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, 0, 0);
  return looked_up;
}

/// The mask of the last resolve, once more.
std::vector<float> ShadowMap::answer() const {
  const StateGuard guard;
  VisibilityMask mask(gbuffer_->width, gbuffer_->height);
  look_up(made_->resolve_programs[int(projection())], mask.texture());
  const std::span<const float> pixels = mask.read();
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, 0, 0);
  return {pixels.begin(), pixels.end()};
}

std::optional<Explanation> ShadowMap::explain(std::size_t index) const {
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return Explanation();
  const glm::dvec3 point = gbuffer_->position(index);
  const int face = camera_.space.face_of(point);
  if (camera_.images[face].layer < 0) return Explanation();  // nothing casts there
  return shadow_map::explain({camera_, camera_.images[face], depths()}, comparison(), point, gbuffer_->normal(index),
                             glm::dvec2(looked_up()[index]));
}

std::vector<float> ShadowMap::draw_debug(std::string_view layer) const {
  if (layer == "map") {
    return paint_map(camera_, gbuffer_->width, gbuffer_->height,
                     [&](std::size_t face) { return camera_.texels_of(camera_.images[face], depths()); });
  }
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<LookUp> look_ups(gbuffer_->size());
  const std::vector<glm::vec2>& texels = looked_up();
  for (std::size_t i = 0; i < look_ups.size(); ++i)
    if (faces_light(*made_->scene, *gbuffer_, light_, i))
      look_ups[i] = {camera_.space.face_of(gbuffer_->position(i)), glm::ivec2(glm::floor(texels[i]))};
  return paint_texels(camera_, *made_->scene, *gbuffer_, light_, look_ups, answer());
}

}  // namespace

GNOMON_TECHNIQUE(shadow_map, ShadowMap, about)
