// Shadow map: one depth image from the light (six around a point light), compared once or a few times per visible point.
//
// The faces of a cube are layers of one array, drawn one by one: only faces with casters and receivers are allocated, each is
// fitted and culls meshes for itself, and a 3 x 2 atlas of the largest faces would exceed the largest texture (16384).
//
// Defaults: the bias with the lowest mean wrong rate in suite shadow_map_defaults; results/shadow_map_defaults has the sweep.
//
// The bias is a length along the axis of the image. Its parameters are in texels because acne is: a texel's world width at the
// point, times the parameter, gives meters.
#include <gnomon/kit/gl.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include "shadow_map/layers.h"
#include "shadow_map/shaders.h"

namespace {
using namespace gnomon;
using shadow_map::Face;

constexpr About about{
    .title = "Shadow map",
    .summary = "One depth image from the light, compared once per visible point.",
    .source = "Williams 1978; Reeves, Salesin and Cook 1987 (filter=pcf); Wang and Molnar 1994 (second_depth)",
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
  Choice filter{
      this,         "filter",
      "nearest",    {"nearest", "pcf"},
      Stage::setup, "One comparison, or the mean of (2 filter_radius + 1)^2 comparisons (percentage-closer filtering)."};
  Number<int> filter_radius{this,
                            "filter_radius",
                            1,
                            {.unit = "texel", .min = 1, .max = 8},
                            Stage::relight,
                            "Half the side of the filter beside its middle texel; for filter=pcf."};
  Flag second_depth{this, "second_depth", false, Stage::relight,
                    "Stores the second surface seen from the light instead of the first; the far plane where there is none."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "a shadow map has one center: lights with area have none");
  }
  void setup() override;
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ShadowMap::made_); }
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override { return shadow_map::map_layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  int radius() const { return filter.is("pcf") ? filter_radius : 0; }
  /// Texels that a look-up may leave the fitted window by: the filter, the normal offset, and one for rounding.
  int margin() const { return radius() + 1 + (bias.is("normal_offset") ? static_cast<int>(std::ceil(normal_offset)) : 0); }
  const Texture& map() const { return second_depth ? second_ : first_; }
  /// Texels of a face; none where it is not drawn.
  std::span<const float> layer_depths(std::size_t face) const;
  const std::vector<float>& depths() const;
  const std::vector<glm::vec2>& looked_up() const;
  std::vector<float> answer() const;
  /// Runs a program of resolve over all pixels, into a texture.
  void look_up(const Program& program, unsigned target) const;
  /// What the head of the resolve shader says for a projection.
  std::string head(int projection) const {
    return fmt::format("#define PROJECTION {}\n#define BIAS {}\n#define PCF {}\n", projection, bias.index(), filter.index());
  }

  int projection() const {
    return faces_.size() == 6         ? shadow_map::cube
           : faces_[0].is_perspective ? shadow_map::perspective
                                      : shadow_map::orthographic;
  }

  /// What questions need, in memory: of one object at a time, for 64 lights' images fill a gigabyte.
  struct ReadBack {
    const ShadowMap* of = nullptr;
    std::vector<float> depths;         // of all layers, read at the first question after a relight
    std::vector<glm::vec2> looked_up;  // by pixel, asked for at the first question after a resolve
  };
  struct Made {
    ReadBack read_back;
    Program depth_program, second_program;
    std::array<Program, shadow_map::projection_count> resolve_programs;  // of the present bias and filter
    std::array<std::optional<Program>, shadow_map::projection_count> explain_programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    std::vector<shadow_map::MeshBox> boxes;
    double extent = 0;  // largest coordinate of the scene
  };
  Shared<Made> made_;
  ReadBack& read_back() const {
    if (made_->read_back.of != this) made_->read_back = {.of = this, .depths = {}, .looked_up = {}};
    return made_->read_back;
  }
  double rounding_ = 0;  // float32 error of a depth, meters
  Light light_;
  LightSpace space_;
  std::vector<Face> faces_;  // of that space
  std::vector<int> layers_;  // of each face; -1 when it is not drawn
  Texture first_, second_;   // arrays with one layer per drawn face
  int drawn_faces_ = 0;
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
};

void ShadowMap::setup() {
  made_->depth_program = Program("shadow_map depth", shadow_map::depth_vertex, shadow_map::depth_fragment);
  made_->second_program = Program("shadow_map second depth", shadow_map::depth_vertex, shadow_map::second_fragment);
  for (int i = 0; i < shadow_map::projection_count; ++i) {
    made_->resolve_programs[i] = Program("shadow_map resolve", full_screen_vertex, head(i) + shadow_map::resolve_fragment);
    made_->explain_programs[i].reset();
  }
  made_->framebuffer = make_framebuffer();
  warm_up(*this);
}

void ShadowMap::build(const Scene& scene) {
  made_->scene = &scene;
  scene_buffers(scene);
  made_->extent = scene.bounds().extent();
  made_->boxes.clear();
  for (const Mesh& mesh : scene.meshes) {
    shadow_map::MeshBox box{.bounds = {}, .casts = mesh.casts, .receives = mesh.receives};
    box.bounds.add(mesh.positions);
    // A flat mesh gets a box with an inside, and rounding cannot push a vertex out of it.
    const glm::vec3 slack(static_cast<float>(made_->extent * 0x1p-20));
    box.bounds.min -= slack;
    box.bounds.max += slack;
    made_->boxes.push_back(box);
  }
}

void ShadowMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  if (made_->read_back.of == this) made_->read_back = {};
  space_ = shadow_map::space_of(light, made_->boxes);
  faces_ = shadow_map::fit_faces(light, space_, made_->boxes, resolution, margin());
  layers_.clear();
  drawn_faces_ = 0;
  for (const Face& face : faces_) layers_.push_back(face.casters.empty() ? -1 : drawn_faces_++);
  first_.fit(GL_DEPTH_COMPONENT32F, resolution, resolution, std::max(drawn_faces_, 1));
  if (second_depth) second_.fit(GL_DEPTH_COMPONENT32F, resolution, resolution, std::max(drawn_faces_, 1));

  const SceneBuffers& buffers = scene_buffers(*made_->scene);
  drawn_triangles_ = 0;
  glBindFramebuffer(GL_FRAMEBUFFER, made_->framebuffer.name());
  glViewport(0, 0, resolution, resolution);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_DEPTH_CLAMP);
  glDepthFunc(GL_GREATER);
  glBindTextureUnit(0, first_.name());
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, 0, 0);  // the mask of the last resolve
  const auto draw = [&](const Program& program, const Texture& target, std::size_t face) {
    glNamedFramebufferTextureLayer(made_->framebuffer.name(), GL_DEPTH_ATTACHMENT, target.name(), 0, layers_[face]);
    const float infinitely_far = 0;
    glClearNamedFramebufferfv(made_->framebuffer.name(), GL_DEPTH, 0, &infinitely_far);
    program.set("clip_from_world", glm::mat4(faces_[face].clip_from_world(resolution)));
    glUseProgram(program.name());
    buffers.draw(faces_[face].casters);
    for (const std::uint32_t mesh : faces_[face].casters) drawn_triangles_ += buffers.meshes[mesh].triangle_count;
  };
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (layers_[i] < 0) continue;
    draw(made_->depth_program, first_, i);
    if (!second_depth) continue;
    made_->second_program.set("layer", layers_[i]);
    draw(made_->second_program, second_, i);
  }
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_DEPTH_ATTACHMENT, 0, 0);

  // Sixteen half units in the last place of the largest coordinate: the three of the rounded point and vertices (sqrt 3 each),
  // and four products and three sums of the transforms in float32, twice.
  const glm::dvec3 light_position(homogeneous(light) * homogeneous(light).w);
  rounding_ = 16 * 0x1p-24 * std::max(made_->extent, extent(light_position));
  glFinish();
}

void ShadowMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (made_->read_back.of == this) made_->read_back.looked_up.clear();
  look_up(made_->resolve_programs[projection()], mask.texture());
  glFinish();
}

void ShadowMap::look_up(const Program& p, unsigned target) const {
  set_light(p, light_);
  std::array<glm::vec4, 6> windows{}, texels{};
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    Face face = faces_[i];
    // Where nothing casts, every look-up falls off the image.
    if (layers_[i] < 0) {
      face.scale = glm::dvec2(0);
      face.offset = glm::dvec2(-1);
      face.near = face.far = 1;
    }
    const double texel_width = 1 / std::min(face.scale.x, face.scale.y);
    windows[i] = glm::vec4(face.scale, face.offset);
    const double diagonal = glm::length(1.0 / face.scale);
    const double fourth = !face.is_perspective ? face.far : bias.is("slope") ? diagonal : rounding_ / (face.near * face.far);
    p.set_if_used("diagonal", static_cast<float>(diagonal));
    texels[i] = glm::vec4(std::max(layers_[i], 0), texel_width, face.near, fourth);
    if (faces_.size() == 6) continue;
    const glm::dvec3 axes[] = {face.axis(0), face.axis(1), face.axis(2)};  // right, down, axis
    const glm::dvec2 along_axis = face.is_perspective ? face.offset : glm::dvec2(0);
    const glm::dmat3 rows(axes[0] * face.scale.x + axes[2] * along_axis.x, axes[1] * face.scale.y + axes[2] * along_axis.y,
                          axes[2]);
    p.set_if_used("texel_from_light", glm::mat3(glm::transpose(rows)));
    p.set_if_used("texel_steps", glm::mat3(axes[0] / face.scale.x, axes[1] / face.scale.y, axes[2]));
  }
  p.set_if_used("window", std::span<const glm::vec4>(windows).first(faces_.size()));
  p.set_if_used("texel", std::span<const glm::vec4>(texels).first(faces_.size()));
  p.set_if_used("origin", glm::vec3(faces_[0].origin));
  p.set_if_used("resolution", resolution.value());
  p.set_if_used("radius", radius());
  p.set_if_used("depth_bias", static_cast<float>(depth_bias));
  p.set_if_used("slope_bias", static_cast<float>(slope_bias));
  p.set_if_used("normal_offset", static_cast<float>(normal_offset));
  p.set_if_used("rounding", static_cast<float>(rounding_));
  bind_gbuffer(gbuffer_textures(*gbuffer_, *made_->scene));
  glBindTextureUnit(3, map().name());
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, target, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, made_->framebuffer.name());
  glViewport(0, 0, gbuffer_->width, gbuffer_->height);
  glUseProgram(p.name());
  draw_full_screen();
}

Counts ShadowMap::counts() const {
  const double texels = double(resolution) * resolution * drawn_faces_ * (second_depth ? 2 : 1);
  const double bytes = double(first_.bytes + second_.bytes) + made_.own(double(made_->boxes.size() * sizeof(made_->boxes[0])));
  return {{"texels", texels, "texel"},
          {"faces", double(drawn_faces_), ""},
          {"triangles", double(drawn_triangles_), ""},
          {"bytes", bytes, "byte"}};
}

const std::vector<float>& ShadowMap::depths() const {
  std::vector<float>& depths = read_back().depths;
  if (depths.empty()) depths = read_texels<float>(map(), GL_DEPTH_COMPONENT);
  return depths;
}

/// The texel that each pixel looked up in the last resolve, by the very shader: next to a border of texels, float32 decides.
const std::vector<glm::vec2>& ShadowMap::looked_up() const {
  std::vector<glm::vec2>& looked_up = read_back().looked_up;
  if (!looked_up.empty()) return looked_up;
  const StateGuard guard;
  auto& program = made_->explain_programs[projection()];
  if (!program)
    program.emplace("shadow_map explain", full_screen_vertex,
                    "#define EXPLAIN\n" + head(projection()) + shadow_map::resolve_fragment);
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
  look_up(made_->resolve_programs[projection()], mask.texture());
  const std::span<const float> pixels = mask.read();
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, 0, 0);
  return {pixels.begin(), pixels.end()};
}

std::optional<Explanation> ShadowMap::explain(std::size_t index) const {
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return Explanation();
  const glm::dvec3 point = gbuffer_->position(index);
  const int face = space_.face_of(point);
  if (layers_[face] < 0) return Explanation();  // nothing casts there
  const shadow_map::Image image{faces_[face], resolution, layer_depths(face)};
  const shadow_map::Comparison comparison{.bias = shadow_map::Bias(bias.index()),
                                          .depth_bias = depth_bias,
                                          .slope_bias = slope_bias,
                                          .normal_offset = normal_offset,
                                          .rounding = rounding_,
                                          .radius = radius()};
  return shadow_map::explain(image, comparison, point, gbuffer_->normal(index), glm::ivec2(looked_up()[index]));
}

std::span<const float> ShadowMap::layer_depths(std::size_t face) const {
  const std::size_t texels = std::size_t(resolution) * resolution;
  return layers_[face] < 0 ? std::span<const float>() : std::span(depths()).subspan(layers_[face] * texels, texels);
}

std::vector<float> ShadowMap::draw_debug(std::string_view layer) const {
  if (layer == "map") {
    return shadow_map::paint_map(faces_, resolution, gbuffer_->width, gbuffer_->height,
                                 [&](std::size_t face) { return layer_depths(face); });
  }
  if (layer != "texels") return Technique::draw_debug(layer);
  std::vector<shadow_map::LookUp> look_ups(gbuffer_->size());
  const std::vector<glm::vec2>& texels = looked_up();
  for (std::size_t i = 0; i < look_ups.size(); ++i)
    if (faces_light(*made_->scene, *gbuffer_, light_, i))
      look_ups[i] = {space_.face_of(gbuffer_->position(i)), glm::ivec2(texels[i])};
  return shadow_map::paint_texels(faces_, resolution, *made_->scene, *gbuffer_, light_, look_ups, answer());
}

}  // namespace

GNOMON_TECHNIQUE(shadow_map, ShadowMap, about)
