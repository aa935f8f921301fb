// Planar projected shadow: casters flattened onto each receiver plane by a matrix and drawn there from the eye.
//
// Source: Blinn 1988. Homogeneous, so that point and directional lights are one case: with the plane P = (n, d), n toward the
//         light L, M = (P.L) I - L P^T. Casters behind the plane (false shadow) and behind the light (anti-shadow) are clipped.
// Error:  exact up to the rasterizer's snapping of edges to 1/256 pixel: wrong pixels are those whose center lies on an edge
//         (at most 1 in 10 000 of the tested pixels in our scenes, none farther than 1/100 pixel from an edge).
// Fails:  every receiver that is not flat: pixels off the receiver planes are lit and reported as not covered.
#include <gnomon/kit/gl.h>
#include <gnomon/kit/planes.h>
#include <gnomon/registry.h>

#include <algorithm>

namespace {
using namespace gnomon;

/// Which receiver plane each pixel lies on, plus one; 0 where it lies on none or does not face the light.
const std::string receivers_fragment = std::string(faces_light_snippet) + R"(
layout(std430, binding = 0) readonly buffer PlaneOf { uint plane_of[]; };
layout(std430, binding = 1) readonly buffer FirstTriangle { uint first_triangle[]; };
layout(location = 0) out uint receiver;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  uvec2 ids = texelFetch(gbuffer_ids, pixel, 0).xy;
  bool facing = faces_light(texelFetch(gbuffer_position, pixel, 0), texelFetch(gbuffer_normal, pixel, 0));
  receiver = facing ? plane_of[first_triangle[ids.x - 1] + ids.y] + 1 : 0;  // no_plane + 1 is 0
}
)";

/// `clip_from_world` holds the projection onto the plane as well. The share of the way from the light is 1 on the plane, 0 at
/// the light's height.
const std::string shadow_vertex = std::string(position_snippet) + R"(
uniform vec4 plane;
uniform float tolerance, per_light_height, least_share;
out float gl_ClipDistance[2];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_ClipDistance[0] = height - tolerance;
  gl_ClipDistance[1] = (1 - height * per_light_height) - least_share;
  gl_Position = place(vec4(position, 1));
}
)";

constexpr std::string_view shadow_fragment = R"(
layout(binding = 0) uniform usampler2D receivers;
uniform int receiver;
layout(location = 0) out float visibility;
void main() {
  if (texelFetch(receivers, ivec2(gl_FragCoord.xy), 0).r != uint(receiver)) discard;
  visibility = 0;
}
)";

class PlanarProjected final : public Technique {
  Number<double> min_share{
      this,         "min_share",
      0.01,         {.min = 0.001, .max = 1, .log = true},
      Stage::build, "Least share of the receiving area that makes a set of coplanar faces a receiver plane."};

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;

 private:
  /// Casters projected onto one plane by one light.
  struct Projection {
    std::uint32_t index;   ///< in planes_
    glm::dvec4 plane;      ///< turned toward the light
    glm::dmat4 projected;  ///< M / (P.L)
    double per_light_height;
    std::vector<std::uint32_t> casters;
  };
  std::uint32_t plane_of(const GBuffer& gbuffer, std::size_t pixel) const;

  Program receivers_program_, shadow_program_;
  Framebuffer framebuffer_;
  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  ReceiverPlanes planes_;
  std::vector<bool> is_flat_;  // of each mesh: all triangles on one plane
  std::vector<Bounds> bounds_;
  Buffer plane_of_, plane_of_shapes_, first_triangle_;
  double clip_tolerance_ = 0;
  Light light_;
  std::vector<Projection> projections_;
  Texture receivers_;
  std::size_t drawn_planes_ = 0, drawn_casters_ = 0, drawn_triangles_ = 0;
};

Support PlanarProjected::supports(const Scene& scene, const Light& light, const View&) const {
  if (has_area(light)) return Support::unsupported("casters are projected from one point: lights with area have none");
  const ReceiverPlanes planes = find_receiver_planes(scene, min_share);
  if (planes.planes.empty())
    return Support::unsupported(fmt::format("no plane holds {} of the receiving area", min_share.value()));
  if (planes.planar_area < planes.receiving_area * (1 - 1e-9))
    return Support::approximate(
        fmt::format("{:.3g} % of the receiving area lies on no receiver plane; pixels there are not covered",
                    100 * (1 - planes.planar_area / planes.receiving_area)));
  return Support::full();
}

void PlanarProjected::setup() {
  receivers_program_ = Program("planar_projected receivers", full_screen_vertex, receivers_fragment);
  shadow_program_ = Program("planar_projected shadow", shadow_vertex, shadow_fragment);
  framebuffer_ = make_framebuffer();
  warm_up(*this);
}

void PlanarProjected::build(const Scene& scene) {
  scene_ = &scene;
  scene_buffers(scene);
  planes_ = find_receiver_planes(scene, min_share);
  bounds_.clear();
  is_flat_.clear();
  // Under shape truth a pixel on a curved shape says triangle 0: a plane only where the whole mesh lies on one (a disc).
  std::vector<std::uint32_t> of_shapes = planes_.plane_of;
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    bounds_.emplace_back();
    for (const glm::vec3& p : mesh.positions) bounds_.back().add(p);
    const std::span planes = std::span(planes_.plane_of).subspan(planes_.first_triangle[m], mesh.triangles.size());
    is_flat_.push_back(std::ranges::all_of(planes, [&](std::uint32_t p) { return p == planes[0]; }));
    if (mesh.has_curved_shape() && !is_flat_[m])
      std::fill_n(of_shapes.begin() + planes_.first_triangle[m], mesh.triangles.size(), no_plane);
  }
  const auto upload = [](const std::vector<std::uint32_t>& values) { return Buffer(values.data(), values.size() * 4); };
  plane_of_ = upload(planes_.plane_of);
  plane_of_shapes_ = upload(of_shapes);
  first_triangle_ = upload(planes_.first_triangle);

  // The shader's height n.p + d in float32 errs by five roundings (three products, three sums, less one) of terms that add up
  // to at most 2 sqrt 3 E: less than 18 * 2^-24 E. Triangles on the plane must stay below that.
  const Bounds all = scene.bounds();
  const glm::vec3 largest = glm::max(glm::abs(all.min), glm::abs(all.max));
  clip_tolerance_ = planes_.tolerance + 18 * 0x1p-24 * std::max({largest.x, largest.y, largest.z});
}

void PlanarProjected::relight(const Light& light) {
  light_ = light;
  projections_.clear();
  const glm::dvec4 l = homogeneous(light);
  for (std::uint32_t i = 0; i < planes_.planes.size(); ++i) {
    glm::dvec4 plane = planes_.planes[i].plane;
    if (glm::dot(plane, l) < 0) plane = -plane;
    const double light_height = glm::dot(plane, l);  // of a directional light: per unit of its direction
    // A light in the plane, as far as float32 can tell, faces none of it.
    if (light_height <= (l.w != 0 ? clip_tolerance_ : 0x1p-24 * glm::length(l))) continue;
    Projection projection{.index = i,
                          .plane = plane,
                          .projected = glm::dmat4(1) - glm::outerProduct(l, plane) / light_height,
                          .per_light_height = l.w / light_height,
                          .casters = {}};
    for (std::uint32_t m = 0; m < bounds_.size(); ++m) {
      if (!scene_->meshes[m].casts) continue;
      const glm::dvec3 middle = (glm::dvec3(bounds_[m].min) + glm::dvec3(bounds_[m].max)) / 2.0;
      const glm::dvec3 half = (glm::dvec3(bounds_[m].max) - glm::dvec3(bounds_[m].min)) / 2.0;
      const double height = glm::dot(plane, glm::dvec4(middle, 1)), reach = glm::dot(glm::abs(glm::dvec3(plane)), half);
      const bool behind_plane = height + reach <= clip_tolerance_;
      const bool behind_light = l.w != 0 && height - reach >= light_height;
      if (!behind_plane && !behind_light) projection.casters.push_back(m);
    }
    if (!projection.casters.empty()) projections_.push_back(std::move(projection));
  }
}

void PlanarProjected::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  const StateGuard guard;
  gbuffer_ = &gbuffer;
  if (receivers_.width != gbuffer.width || receivers_.height != gbuffer.height) {
    receivers_ = {};
    receivers_ = Texture(GL_R32UI, gbuffer.width, gbuffer.height);
  }
  const Buffer& plane_of = gbuffer.truth == Truth::shape ? plane_of_shapes_ : plane_of_;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  glViewport(0, 0, gbuffer.width, gbuffer.height);
  const auto draw_into = [&](GLuint texture) {
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, texture, 0);
  };

  draw_into(receivers_.name());
  bind_gbuffer(gbuffer_textures(gbuffer, *scene_));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, plane_of.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, first_triangle_.name());
  set_light(receivers_program_, light_);
  glUseProgram(receivers_program_.name());
  draw_full_screen();

  draw_into(mask.texture());
  const float lit[] = {1, 0, 0, 0};
  glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, lit);
  glBindTextureUnit(0, receivers_.name());
  glEnable(GL_CLIP_DISTANCE0);
  glEnable(GL_CLIP_DISTANCE1);
  const SceneBuffers& buffers = scene_buffers(*scene_);
  const glm::dmat4 clip = clip_from_world(gbuffer.view, gbuffer.width, gbuffer.height);
  const Program& p = shadow_program_;
  glUseProgram(p.name());
  p.set("tolerance", static_cast<float>(clip_tolerance_));
  drawn_planes_ = drawn_casters_ = drawn_triangles_ = 0;
  for (const Projection& projection : projections_) {
    // Seen from behind, the plane shows its unlit side.
    if (glm::dot(projection.plane, glm::dvec4(glm::dvec3(gbuffer.view.eye), 1)) <= 0) continue;
    p.set("clip_from_world", glm::mat4(clip * projection.projected));
    p.set("plane", glm::vec4(projection.plane));
    p.set("per_light_height", static_cast<float>(projection.per_light_height));
    // The share's own rounding error: casters that near to the light's height go to infinity anyway.
    p.set("least_share", static_cast<float>(0x1p-22 + clip_tolerance_ * projection.per_light_height));
    p.set("receiver", static_cast<int>(projection.index + 1));
    buffers.draw(projection.casters);
    ++drawn_planes_;
    drawn_casters_ += projection.casters.size();
    for (const std::uint32_t m : projection.casters) drawn_triangles_ += buffers.meshes[m].triangle_count;
  }
  glFinish();
}

Counts PlanarProjected::counts() const {
  std::size_t bytes = plane_of_.bytes + plane_of_shapes_.bytes + first_triangle_.bytes + receivers_.bytes;
  bytes += (planes_.plane_of.size() + planes_.first_triangle.size()) * 4 + planes_.planes.size() * sizeof(ReceiverPlane);
  for (const Projection& projection : projections_) bytes += sizeof(projection) + projection.casters.size() * 4;
  return {{"planes", double(drawn_planes_), ""},
          {"casters", double(drawn_casters_), ""},
          {"triangles", double(drawn_triangles_), ""},
          {"bytes", double(bytes), "byte"}};
}

std::uint32_t PlanarProjected::plane_of(const GBuffer& gbuffer, std::size_t pixel) const {
  const std::uint32_t mesh = gbuffer.mesh[pixel];
  if (gbuffer.truth == Truth::shape && scene_->meshes[mesh].has_curved_shape() && !is_flat_[mesh]) return no_plane;
  return planes_.plane_of[planes_.first_triangle[mesh] + gbuffer.triangle[pixel]];
}

std::optional<Explanation> PlanarProjected::explain(std::size_t index) const {
  Explanation why;
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return why;
  const std::uint32_t plane = plane_of(*gbuffer_, index);
  why.covered = plane != no_plane;
  if (why.covered) why.element = plane;
  return why;
}

}  // namespace

GNOMON_TECHNIQUE(planar_projected, PlanarProjected,
                 {.title = "Planar projected shadow",
                  .summary = "Casters flattened onto each receiver plane by a matrix and drawn there from the eye.",
                  .source = "Blinn 1988",
                  .error = "Exact up to the rasterizer's snapping of edges to 1/256 pixel.",
                  .fails = "Receivers that are not flat: pixels off the receiver planes are lit and not covered.",
                  .needs_gl = true})
