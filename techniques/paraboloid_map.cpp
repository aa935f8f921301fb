// Dual paraboloid map: two depth images around a point light in place of a cube's six, each of a half space as a paraboloid
// mirror shows it.
//
// A technique of its own and no projection of shadow_map: all that other maps share - fits, planes of receivers, wide filters -
// rests on images in which straight lines are straight.
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <numbers>

#include "paraboloid_map/shader.h"

namespace {
using namespace gnomon;

constexpr OwnCause causes[] = {
    {"projection_curve",
     "The image shows another surface than the ray of the texel meets: edges that should be curves were drawn straight.",
     {24, 176, 200}},
};

constexpr About about{
    .title = "Dual paraboloid map",
    .summary = "Two depth images around a point light, each of a half space as in a paraboloid mirror, compared once.",
    .source = "Brabec, Annen and Seidel 2002",
    .error =
        "That of a shadow map of as many texels, and edges of large triangles that are straight where the paraboloid bends "
        "them: what they hide is shifted, most halfway between the middle of an image and its border. Texels are twice as wide "
        "in the middle as at the border.",
    .fails = "Large triangles near the light: a wall of two triangles, seen under a wide angle.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_alpha_masks,
    .causes = causes,
    .named_only = true};

/// What all lights share.
struct Made {
  CasterPrograms draw;
  Program look_up, explain;
  Framebuffer framebuffer;
  const Scene* scene = nullptr;
  MeshBoxes boxes;
  std::optional<RayScene> rays;  // of casters, for questions
};

class ParaboloidMap final : public Technique {
  Number<int> resolution = Number<int>(this, "resolution", 1024, {.unit = "texel", .min = 64, .max = 8192, .log = true},
                                       Stage::relight, "Side of a square depth image, of which each light has two.");
  Choice axis = Choice(this, "axis", "y", {"x", "y", "z"}, Stage::relight,
                       "Across the seam between both images, which goes around the light in the plane of the other two axes.");
  Number<double> depth_bias = Number<double>(this, "depth_bias", 0.5, {.unit = "texel", .min = 0, .max = 64}, Stage::resolve,
                                             "Constant bias along the light's ray, in world widths of a texel at the point.");
  Number<double> slope_bias =
      Number<double>(this, "slope_bias", 1, {.unit = "half texel diagonal", .min = 0, .max = 16}, Stage::resolve,
                     "Slope-scaled bias, times the tangent of the angle between normal and light.");

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!std::holds_alternative<PointLight>(light.kind))
      return Support::unsupported(
          fmt::format("a {} light does not shine all around a place, as two paraboloids see it", kind_name(light)));
    return within_limits({.varying_components = 4 * 12, .texture_size = resolution, .texture_layers = 2});
  }
  void setup() override {
    made_->draw = CasterPrograms("dual paraboloid depth", paraboloid_map::vertex, paraboloid_map::fragment);
    made_->look_up = program(false);
    made_->explain = {};
    made_->framebuffer = make_framebuffer();
    warm_up(*this);
  }
  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->boxes = mesh_boxes(scene);
    made_->rays.reset();
    made_->draw.fit(scene);
    scene_buffers(scene);
  }
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    found_.clear();
    look_up(made_->look_up, mask.texture());
    glFinish();
  }
  Counts counts() const override {
    return {{"texels", 2.0 * resolution * resolution, "texel"},
            {"faces", 2, ""},
            {"triangles", double(drawn_triangles_), ""},
            {"bytes", double(distances_.bytes) + made_.own(double(made_->boxes.meshes.size() * sizeof(MeshBox))), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ParaboloidMap::made_); }
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<std::uint32_t> image_parts() const override;
  std::vector<DebugLayer> debug_layers() const override {
    return {{"map", "Both images, what is in front of the axis on the left: the nearer, the lighter; black where nothing is."}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  static Program program(bool explains) {
    return pass_program(explains ? "paraboloid_map explain" : "paraboloid_map resolve",
                        std::string(paraboloid_map::constants) + std::string(faces_light_constants),
                        fmt::format("{}{}{}{}", explains ? "#define EXPLAINS\n" : "", gbuffer_snippet, faces_light_snippet,
                                    paraboloid_map::look_up));
  }
  /// Right, down and the axis of image 0; image 1 looks the other way along the last one.
  glm::dmat3 axes() const {
    glm::dmat3 columns(0);
    for (int k = 0; k < 3; ++k) columns[k][(axis.index() + 1 + k) % 3] = 1;
    return columns;
  }
  /// Texels to the unit of a paraboloid's plane: the unit circle, and two texels around it.
  double texels_a_unit() const { return 0.5 * resolution - 2; }
  void draw_image(int number, const SceneBuffers& buffers);
  void look_up(const Program& program, unsigned target) const;
  /// Texel, image and what it stores, of each pixel of the last resolve.
  const std::vector<glm::vec4>& found() const;

  Shared<Made> made_;
  Light light_;
  glm::dvec3 place_{0};  ///< of the light
  double nearest_ = 1;   ///< the distance whose depth is 1, meters
  Texture distances_;    ///< of both images: nearest_ over the distance, 0 where there is nothing
  std::size_t drawn_triangles_ = 0;
  const GBuffer* gbuffer_ = nullptr;
  mutable std::vector<glm::vec4> found_;
};

void ParaboloidMap::relight(const Light& light) {
  const StateGuard guard;
  light_ = light;
  place_ = std::get<PointLight>(light.kind).position;
  double near = INFINITY, far = 0;
  for (const MeshBox& box : made_->boxes.meshes) {
    if (!box.casts) continue;
    const glm::dvec3 low(box.bounds.min), high(box.bounds.max);
    near = std::min(near, glm::distance(place_, glm::clamp(place_, low, high)));
    far = std::max(far, glm::length(glm::max(glm::abs(low - place_), glm::abs(high - place_))));
  }
  nearest_ = far > 0 ? std::max(near, far * 0x1p-20) : 1;
  distances_.fit(GL_DEPTH_COMPONENT32F, resolution, resolution, 2);
  const SceneBuffers& buffers = scene_buffers(*made_->scene);
  glBindFramebuffer(GL_FRAMEBUFFER, made_->framebuffer.name());
  glViewport(0, 0, resolution, resolution);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CLIP_DISTANCE0);
  glDepthFunc(GL_GREATER);
  made_->draw.set("map_light", glm::vec3(place_));
  made_->draw.set("circle", static_cast<float>(texels_a_unit() / (0.5 * resolution)));
  made_->draw.set("nearest", static_cast<float>(nearest_));
  drawn_triangles_ = 0;
  for (const int number : {0, 1}) draw_image(number, buffers);
  glNamedFramebufferTexture(made_->framebuffer.name(), GL_DEPTH_ATTACHMENT, 0, 0);
  glFinish();
}

void ParaboloidMap::draw_image(int number, const SceneBuffers& buffers) {
  glm::dmat3 columns = axes();
  if (number == 1) columns[2] = -columns[2];
  std::vector<std::uint32_t> shown;
  for (std::uint32_t m = 0; m < made_->boxes.meshes.size(); ++m) {
    const MeshBox& box = made_->boxes.meshes[m];
    const glm::dvec3 low = glm::dvec3(box.bounds.min) - place_, high = glm::dvec3(box.bounds.max) - place_;
    const double ahead = glm::dot(glm::max(low * columns[2], high * columns[2]), glm::dvec3(1));
    if (!box.casts || ahead + 0.1 * glm::length(glm::max(glm::abs(low), glm::abs(high))) < 0) continue;
    shown.push_back(m);
    drawn_triangles_ += buffers.meshes[m].triangle_count;
  }
  const GLuint framebuffer = made_->framebuffer.name();
  glNamedFramebufferTextureLayer(framebuffer, GL_DEPTH_ATTACHMENT, distances_.name(), 0, number);
  const float infinitely_far = 0;
  glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &infinitely_far);
  made_->draw.set("face_axes", glm::mat3(columns));
  buffers.draw(shown, made_->draw);
}

void ParaboloidMap::look_up(const Program& program, unsigned target) const {
  set_light(program, light_);
  program.set("map_light", glm::vec3(place_));
  program.set("axes", glm::mat3(axes()));
  program.set("image", glm::vec3(texels_a_unit(), 0.5 * resolution, nearest_));
  program.set_if_used("biases", glm::vec2(depth_bias.value(), slope_bias * std::numbers::sqrt2 / 2));
  glBindTextureUnit(3, distances_.name());
  draw_mask(program, made_->framebuffer, target, gbuffer_textures(*gbuffer_, *made_->scene));
}

const std::vector<glm::vec4>& ParaboloidMap::found() const {
  if (found_.empty()) {
    const StateGuard guard;
    Program& explaining = made_->explain;
    if (!explaining) explaining = program(true);
    const Texture texels(GL_RGBA32F, gbuffer_->width, gbuffer_->height);
    look_up(explaining, texels.name());
    found_ = read_texels<glm::vec4>(texels, GL_RGBA);
  }
  return found_;
}

std::optional<Explanation> ParaboloidMap::explain(std::size_t index) const {
  Explanation why;
  if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
  const glm::vec4 texel = found()[index];
  const glm::dvec3 v = glm::dvec3(gbuffer_->position(index)) - place_, q = glm::transpose(axes()) * v;
  const double r = glm::length(v), facing = -glm::dot(glm::dvec3(gbuffer_->normal(index)), v) / r;
  const glm::dvec2 p = glm::dvec2(q) / (r + std::abs(q.z));
  why.texel_width = 2 * r / ((1 + glm::dot(p, p)) * texels_a_unit());
  why.bias = why.texel_width *
             (depth_bias + slope_bias * std::numbers::sqrt2 / 2 * std::sqrt(std::max(1 - facing * facing, 0.0)) / facing);
  // The way on which the paraboloid shows the middle of the texel.
  const glm::dvec2 middle = (glm::dvec2(texel) + 0.5 - 0.5 * resolution) / texels_a_unit();
  const double squared = glm::dot(middle, middle);
  const glm::dvec3 way(2.0 * middle, (1 - squared) * (texel.z > 0 ? -1 : 1));
  const glm::dvec3 direction = axes() * (way / (1 + squared));
  const double stored = texel.w > 0 ? nearest_ / texel.w : INFINITY;
  if (!made_->rays) made_->rays.emplace(*made_->scene, Truth::mesh, RayScene::Which::casters);
  const double met = made_->rays->closest_caster(place_, direction).t;
  // Where another surface is shown that answers alike, what the ray meets is as wrong, and says why.
  const bool is_alike = (stored < r - why.bias) == (met < r - why.bias);
  why.taps.push_back({place_, direction, 1, is_alike ? met : stored});
  if (!is_alike) why.cause = causes[0].id;
  return why;
}

// By the plane between both images, 1 in front of the axis and 2 behind it; next to it the shader's float32 may say otherwise.
std::vector<std::uint32_t> ParaboloidMap::image_parts() const {
  const glm::dvec3 ahead = axes()[2];
  std::vector<std::uint32_t> parts(gbuffer_->size());
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (faces_light(*made_->scene, *gbuffer_, light_, i))
      parts[i] = glm::dot(ahead, glm::dvec3(gbuffer_->position(i)) - place_) < 0 ? 2 : 1;
  return parts;
}

std::vector<float> ParaboloidMap::draw_debug(std::string_view layer) const {
  if (layer != "map") return Technique::draw_debug(layer);
  const std::vector<float> all = read_texels<float>(distances_, GL_DEPTH_COMPONENT);
  const int width = gbuffer_->width, height = gbuffer_->height, side = std::max(std::min(width / 2, height), 1);
  std::vector<float> picture(3 * gbuffer_->size(), 0.0f);
  for (int y = 0; y < std::min(side, height); ++y)
    for (int x = 0; x < std::min(2 * side, width); ++x) {
      const auto texel = [&](int pixel) { return static_cast<std::size_t>((pixel + 0.5) / side * resolution); };
      const auto texels = static_cast<std::size_t>(resolution);
      const float depth = all[(static_cast<std::size_t>(x / side) * texels + texel(y)) * texels + texel(x % side)];
      std::fill_n(picture.begin() + 3 * (y * width + x), 3, std::sqrt(depth));
    }
  return picture;
}

}  // namespace

GNOMON_TECHNIQUE(paraboloid_map, ParaboloidMap, about)
