// Smooth map: a depth image from the light, compared at the four texels around the point, weighted by nearness.
#include <gnomon/kit/maps/light_map.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{.title = "Smooth map",
                      .summary = "A depth image from the light, compared at four texels, weighted by nearness.",
                      .source = "Williams 1978; Reeves, Salesin and Cook 1987, with the weights of a bilinear filter.",
                      .error = "Edges are ramps one texel wide; acne where the bias is below the depth spread of two texels.",
                      .fails = "Large scenes: the image is spread over all of it.",
                      .device = Device::opengl};

const std::string fragment = std::string(gbuffer_snippet) + std::string(light_map_snippet) + R"(
layout(location = 0) out float visibility;
float lit(vec2 texel, float z) {
  float d = stored_depth(texel), near = light_facts.z, far = light_facts.w;  // 0: nothing is stored
#if PROJECTION == 0
  return d > 0 && far - d * (far - near) < z ? 0 : 1;
#else
  return near < z * d ? 0 : 1;
#endif
}
void main() {
  vec4 position = position_here(), normal = normal_here();
  vec3 v = position.xyz - light_origin;
  choose_image(v);
  vec3 place = in_image(v);
  float width = light_facts.y;  // of a texel, meters
#if PROJECTION != 0
  place.xy /= place.z, width *= place.z;
#endif
  float z = place.z - bias * width;
  vec2 corner = floor(place.xy - 0.5), share = place.xy - 0.5 - corner;
  float upper = mix(lit(corner, z), lit(corner + vec2(1, 0), z), share.x);
  float lower = mix(lit(corner + vec2(0, 1), z), lit(corner + vec2(1, 1), z), share.x);
  visibility = faces_light_at(position, normal, v) ? mix(upper, lower, share.y) : 1;
}
)";

class SmoothMap final : public Technique {
  Number<int> resolution{this,           "resolution",
                         1024,           {.unit = "texel", .min = 64, .max = 8192, .log = true},
                         Stage::relight, "Side of the square image, or of each of six."};
  Number<double> bias{this,
                      "bias",
                      3,
                      {.unit = "texel", .min = 0, .max = 64},
                      Stage::resolve,
                      "What is added to stored depths, in widths of a texel."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return light_map_support(light, resolution, 2, 1);
  }
  void setup() override {
    made_->images.setup();
    made_->framebuffer = make_framebuffer();
    for (int i = 0; i < light_projection_count; ++i) {
      const LightProjection projection = LightProjection(i);
      made_->programs[i] =
          pass_program("smooth_map", light_map_constants(projection) + "float bias;", light_map_head(projection) + fragment);
    }
    warm_up(*this);
  }
  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->images.build(scene);
  }
  void relight(const Light& light) override {
    const StateGuard guard;
    light_ = light;
    camera_ = fit_to_scene(light, made_->images.boxes(), resolution, 2);
    made_->images.draw(camera_, depths_);
    texels_.clear();
    glFinish();
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    const GBufferTextures& textures = gbuffer_textures(gbuffer, *made_->scene);
    const Program& program = made_->programs[int(projection_of(camera_))];
    set_light_camera(program, light_, camera_);
    program.set("bias", static_cast<float>(bias));
    bind_gbuffer(textures);
    glBindTextureUnit(3, depths_.name());
    begin_mask(made_->framebuffer, mask.texture(), textures);
    glUseProgram(program.name());
    draw_receivers(textures);
    glFinish();
  }
  Counts counts() const override { return {{"bytes", static_cast<double>(depths_.bytes), "byte"}}; }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &SmoothMap::made_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return Explanation();
    const glm::dvec3 point = gbuffer_->position(index);
    const LightImage& image = camera_.images[camera_.image_of(point)];
    if (image.layer < 0) return Explanation();  // nothing casts there
    if (texels_.empty()) texels_ = read_texels<float>(depths_, GL_DEPTH_COMPONENT);
    const glm::dvec2 place = image.place_of(point) * image.scale + image.offset - 0.5, corner = glm::floor(place),
                     share = place - corner;
    Explanation why;
    why.texel_width = image.largest_texel(image.seen(point));
    why.bias = bias * why.texel_width * image.stretch(point);
    for (int k = 0; k < 4; ++k) {
      const glm::ivec2 aside(k % 2, k / 2), texel = glm::ivec2(corner) + aside;
      const glm::dvec2 near = glm::mix(1.0 - share, share, glm::dvec2(aside));
      why.taps.push_back(camera_.tap(image, texels_, texel, near.x * near.y));
    }
    return why;
  }

 private:
  struct Made {
    DepthImages images;
    std::array<Program, light_projection_count> programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
  };
  Shared<Made> made_;
  Light light_;
  LightCamera camera_;
  Texture depths_;
  mutable std::vector<float> texels_;  // of all images, read at the first question after a relight
  const GBuffer* gbuffer_ = nullptr;
};

}  // namespace

GNOMON_TECHNIQUE(smooth_map, SmoothMap, about)
