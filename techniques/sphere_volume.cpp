// Shadow volumes of shapes: those of the exact spheres, cones and discs, counted in the stencil buffer by z-fail; no triangle
// of their tessellation takes part. Casters without a curved shape cast the volumes of their own triangles.
//
// Source: Heidmann 1991; Everitt and Kilgard 2002 (z-fail, caps). A sphere's volume starts from the circle where tangents from
//         the light touch it, a cone's from its two tangent generators and an arc of its base, a disc's from its circle.
// Error:  a polygon of N segments stands for a circle. Its radius errs by up to (pi / N)^2 / 2, 0.12 % at 64: inscribed inward,
//         circumscribed outward, of equal area by a third of that inward and two thirds outward. The share of wrong pixels
//         falls with N^2; of equal area it is 0.38 of the inscribed one's and 0.77 of the circumscribed one's. `exact` decides
//         at the pixel's point and errs by float32 rounding only. Besides, the rasterizer snaps vertices to 1/256 pixel.
// Fails:  few segments, seen near. Nothing it supports with fit = exact, but for the triangles of other casters.
//
// A convex body casts no shadow on its own surface facing the light, so its faces leave alone the pixels of its own mesh; its
// light cap runs inside it, where no eye outside sees it. A body with the light inside has no outline and casts no volume:
// if the eye is inside, too, it casts on nothing in view; else all that is in view lies on the other side of its surface, and
// is dark. The same holds for a body around the eye and not the light.
#include <gnomon/kit/depth_bound.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/lines.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "sphere_volume/shaders.h"
#include "sphere_volume/volumes.h"

namespace {
using namespace gnomon;
using namespace sphere_volume;
using Pass = VolumeCounter::Pass;

class SphereVolume final : public Technique {
  Number<int> segments{this,
                       "segments",
                       64,
                       {.min = 8, .max = 256, .log = true},
                       Stage::relight,
                       "Sides of the polygon that stands for a circle; `exact` does without."};
  Choice fit{
      this,
      "fit",
      "equal_area",
      {"inscribed", "equal_area", "circumscribed", "exact"},
      Stage::relight,
      "Where the polygon lies: inside the circle, of its area, or around it; or the circle itself, decided at each pixel."};

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override;
  void setup() override;
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = volume_layers();
    layers.push_back(silhouette_layer());
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  void upload();
  void find_bound();
  bool is_exact() const { return fit.index() == sphere_volume::exact; }
  /// A solid that holds the light or the eye, and not both, hides the one from all that the other sees.
  bool is_all_dark(const View& view) const;
  void answer(const GBuffer& gbuffer, VisibilityMask& mask) const;
  std::vector<Line> outlines() const;
  void begin(const GBuffer& gbuffer, Pass pass, int start) const;
  void count(Pass pass) const;
  void draw(const std::array<std::vector<DrawRange>, 3>& ranges, const VolumeProgram& program, Pass pass) const;
  void count_exactly(Pass pass) const;

  mutable VolumeCounter counter_;
  VolumeProgram body_program_, flat_program_;
  std::array<Program, kind_count> exact_programs_;
  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  std::vector<Body> bodies_;  // by kind
  std::array<std::size_t, kind_count + 1> first_of_kind_{};
  EdgeAdjacency adjacency_;  // of the flat casters
  Light light_;
  Silhouette silhouette_;
  Volumes volumes_;
  Buffer vertices_, body_of_, indices_, body_data_;
  std::array<std::size_t, 3> first_index_{};  // of each face, in `indices_`
  VertexArray vertex_array_;
  static constexpr std::size_t stencil_limit = 255;
  std::size_t volume_bound_ = 0, stencil_limit_ = stencil_limit;
};

Support SphereVolume::supports(const Scene& scene, const Light& light, const View&) const {
  if (has_area(light)) return Support::unsupported("a shadow volume starts from one point: lights with area have none");
  if (homogeneous(light).w != 0)
    for (const Mesh& mesh : scene.meshes)
      if (mesh.casts && mesh.has_curved_shape() && is_on_surface(*mesh.shape, glm::dvec3(homogeneous(light))))
        return Support::unsupported(
            fmt::format("the light lies on the surface of {}, whose outline cannot be seen from there", mesh.name));
  return Support::full();
}

void SphereVolume::setup() {
  counter_.setup();
  body_program_ = VolumeProgram("sphere_volume bodies", volume_vertex, true);
  flat_program_ = VolumeProgram("sphere_volume triangles", volume_vertex);
  for (int kind = 0; kind < kind_count; ++kind)
    exact_programs_[kind] =
        Program("sphere_volume exact", bounding_vertex, fmt::format("#define KIND {}\n{}", kind, exact_fragment));
  // Each way to count bodies, in eight bits and in 32.
  const std::string kept = fit.text();
  for (const char* way : {"equal_area", "exact"}) {
    fit.set(way);
    for (const std::size_t limit : {std::size_t(0), stencil_limit}) {
      stencil_limit_ = limit;
      warm_up(*this);
    }
  }
  fit.set(kept);
  counter_.drop_pictures();
}

void SphereVolume::build(const Scene& scene) {
  scene_ = &scene;
  scene_buffers(scene);
  bodies_.clear();
  Scene flat;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (!mesh.casts) continue;
    if (mesh.has_curved_shape()) {
      bodies_.push_back({m, *mesh.shape});
      continue;
    }
    flat.meshes.push_back(mesh);
  }
  const auto kind_of = [](const Body& body) { return body.shape.index(); };
  std::ranges::stable_sort(bodies_, {}, kind_of);
  for (std::size_t kind = 0; kind <= kind_count; ++kind)
    first_of_kind_[kind] = std::ranges::lower_bound(bodies_, kind, {}, kind_of) - bodies_.begin();
  adjacency_ = EdgeAdjacency(flat);

  std::vector<BodyData> data;
  for (const Body& body : bodies_) {
    if (const auto* sphere = std::get_if<Sphere>(&body.shape))
      data.push_back({{sphere->center, sphere->radius}, {}, body.mesh + 1});
    else if (const auto* cone = std::get_if<Cone>(&body.shape))
      data.push_back({{cone->base, cone->radius}, {glm::normalize(glm::dvec3(cone->axis)), cone->height}, body.mesh + 1});
    else if (const auto* disc = std::get_if<Disc>(&body.shape))
      data.push_back({{disc->center, disc->radius}, {glm::normalize(glm::dvec3(disc->normal)), 0}, body.mesh + 1});
  }
  body_data_ = Buffer(data.data(), data.size() * sizeof(BodyData));
}

void SphereVolume::relight(const Light& light) {
  light_ = light;
  const glm::dvec4 l = homogeneous(light);
  volumes_.clear();
  for (std::uint32_t i = 0; i < bodies_.size(); ++i) {
    // From inside there is no outline: see is_all_dark.
    const bool holds_light = l.w != 0 && is_inside(bodies_[i].shape, glm::dvec3(l));
    volumes_.add(holds_light  ? Contour{}
                 : is_exact() ? bounding_contour(bodies_[i], l)
                              : contour_of(bodies_[i], l, Fit(fit.index()), segments),
                 l, i, bodies_[i].mesh);
  }
  adjacency_.find_silhouette(l, silhouette_);
  volumes_.add(adjacency_, silhouette_);
  find_bound();
  upload();
}

/// A convex body has one volume; with `exact` a dark pixel is counted once.
void SphereVolume::find_bound() {
  volume_bound_ = static_cast<std::size_t>(bound_depth(adjacency_, silhouette_, VolumeCounter::stencil_limit));
  if (!is_exact()) volume_bound_ += bodies_.size();
}

void SphereVolume::upload() {
  vertices_ = Buffer(volumes_.vertices.data(), volumes_.vertices.size() * sizeof(glm::vec4));
  body_of_ = is_exact() ? Buffer(volumes_.body_of.data(), volumes_.body_of.size() * 4) : Buffer();
  std::vector<std::uint32_t> all;
  for (int f = 0; f < 3; ++f) {
    first_index_[f] = all.size();
    all.insert(all.end(), volumes_.indices[f].begin(), volumes_.indices[f].end());
  }
  indices_ = Buffer(all.data(), all.size() * 4);
  vertex_array_ = make_vertex_array();
  const GLuint vao = vertex_array_.name();
  glVertexArrayVertexBuffer(vao, 1, vertices_.name(), 0, sizeof(glm::vec4));
  glVertexArrayAttribFormat(vao, 1, 4, GL_FLOAT, GL_FALSE, 0);
  glVertexArrayAttribBinding(vao, 1, 1);
  glEnableVertexArrayAttrib(vao, 1);
  if (is_exact()) {
    glVertexArrayVertexBuffer(vao, 2, body_of_.name(), 0, 4);
    glVertexArrayAttribIFormat(vao, 2, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(vao, 2, 2);
    glEnableVertexArrayAttrib(vao, 2);
  }
  glVertexArrayElementBuffer(vao, indices_.name());
  glFinish();
}

bool SphereVolume::is_all_dark(const View& view) const {
  const glm::dvec4 l = homogeneous(light_);
  return std::ranges::any_of(bodies_, [&](const Body& body) {
    const bool holds_light = l.w != 0 && is_inside(body.shape, glm::dvec3(l));
    return holds_light != is_inside(body.shape, glm::dvec3(view.eye));
  });
}

void SphereVolume::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  answer(gbuffer, mask);
}

void SphereVolume::answer(const GBuffer& gbuffer, VisibilityMask& mask) const {
  const StateGuard guard;
  const bool all_dark = is_all_dark(gbuffer.view);
  const Pass pass = volume_bound_ > stencil_limit_ ? Pass::wide : Pass::stencil;
  begin(gbuffer, pass, all_dark);
  if (!all_dark) count(pass);
  counter_.write_mask(gbuffer_textures(gbuffer, *scene_), light_, mask);
  glFinish();
}

void SphereVolume::begin(const GBuffer& gbuffer, Pass pass, int start) const {
  counter_.begin(depth_stencil(*scene_, gbuffer, Truth::shape), pass, CountWhere::behind_surface, start);
  bind_gbuffer(gbuffer_textures(gbuffer, *scene_));
  const glm::mat4 clip(clip_from_world(gbuffer.view, gbuffer.width, gbuffer.height));
  for (const VolumeProgram* program : {&body_program_, &flat_program_})
    program->each([&](const Program& p) { p.set("clip_from_world", clip); });
  for (const Program& program : exact_programs_) program.set("clip_from_world", clip);
}

void SphereVolume::count(Pass pass) const {
  glBindVertexArray(vertex_array_.name());
  draw(volumes_.flat, flat_program_, pass);
  if (is_exact() && pass != Pass::layer)
    count_exactly(pass);
  else
    draw(volumes_.bodies, body_program_, pass);
  glBindVertexArray(0);
}

void SphereVolume::draw(const std::array<std::vector<DrawRange>, 3>& ranges, const VolumeProgram& program, Pass pass) const {
  const Program& used = pass == Pass::stencil ? program.stencil : pass == Pass::wide ? program.wide : program.layer;
  const GLint own_mesh = glGetUniformLocation(used.name(), "own_mesh");
  for (int f = 0; f < 3; ++f) {
    std::optional<bool> reversed;
    for (const DrawRange& range : ranges[f]) {
      if (range.count == 0) continue;
      if (reversed != range.reversed) counter_.use(program, static_cast<VolumeFace>(f), range.reversed);
      reversed = range.reversed;
      if (own_mesh >= 0) glUniform1i(own_mesh, static_cast<GLint>(range.own_mesh));
      const auto* const offset = reinterpret_cast<const void*>(4 * (first_index_[f] + range.first));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT, offset);
    }
  }
}

/// Counts a body at the pixels before the far faces of its bounding volume whose points are in its shadow. Far faces, because
/// they cover a volume's pixels also when the eye is inside. In the stencil, one body is enough: dark pixels are not asked
/// again.
void SphereVolume::count_exactly(Pass pass) const {
  glDepthFunc(GL_LESS);  // reversed: farther than the surface
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT);
  if (pass == Pass::stencil) {
    glStencilFunc(GL_EQUAL, 0, ~0u);
    glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
  }
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, body_data_.name());
  for (int kind = 0; kind < kind_count; ++kind) {
    const std::size_t first = first_of_kind_[kind], end = first_of_kind_[kind + 1];
    if (first == end) continue;
    const Program& program = exact_programs_[kind];
    set_light(program, light_);
    glUseProgram(program.name());
    for (int f = 0; f < 3; ++f) {
      // Neighbors in the list of bodies are neighbors in the list of indices.
      const DrawRange &from = volumes_.bodies[f][first], &to = volumes_.bodies[f][end - 1];
      const auto* const offset = reinterpret_cast<const void*>(4 * (first_index_[f] + from.first));
      glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(to.first + to.count - from.first), GL_UNSIGNED_INT, offset);
    }
  }
  glDisable(GL_CULL_FACE);
}

Counts SphereVolume::counts() const {
  std::size_t bytes = vertices_.bytes + body_of_.bytes + indices_.bytes + body_data_.bytes + counter_.bytes();
  bytes += volumes_.bytes() + adjacency_.bytes() + bodies_.capacity() * sizeof(Body);
  bytes += silhouette_.bytes();
  const std::size_t sides = volumes_.triangle_count(VolumeFace::side) / (homogeneous(light_).w == 0 ? 1 : 2);
  const std::size_t light_caps = volumes_.triangle_count(VolumeFace::light_cap);
  const std::size_t dark_caps = volumes_.triangle_count(VolumeFace::dark_cap);
  Counts counts{{"bodies", double(bodies_.size()), ""},
                {"side_quads", double(sides), ""},
                {"cap_triangles", double(light_caps + dark_caps), ""},
                {"silhouette_edges", double(silhouette_.edges.size()), ""},
                {"triangles", double(volumes_.triangle_count(VolumeFace::side) + light_caps + dark_caps), ""},
                {"bytes", double(bytes), "byte"}};
  if (!gbuffer_) return counts;

  // What the stencil cannot tell, by a pass in 32 bits that is thrown away.
  const StateGuard guard;
  begin(*gbuffer_, Pass::wide, 0);
  count(Pass::wide);
  const auto [fill, deepest] = counter_.work();
  const bool wide = volume_bound_ > stencil_limit_;
  counter_.end();
  if (!wide) counter_.drop_pictures();
  counts.push_back({"depth_bound", double(volume_bound_), ""});
  counts.push_back({"fill", fill, "pixel"});
  counts.push_back({"deepest", deepest, "volume"});
  counts.push_back({"counter_bits", wide ? 32.0 : 8.0, "bit"});
  return counts;
}

std::optional<Explanation> SphereVolume::explain(std::size_t index) const {
  Explanation why;
  if (faces_light(*scene_, *gbuffer_, light_, index)) {
    why.element = gbuffer_->mesh[index];
    if (!is_exact())
      why.outline_error =
          outline_error(bodies_, homogeneous(light_), gbuffer_->position(index), static_cast<Fit>(fit.index()), segments);
  }
  return why;
}

/// Of bodies and of flat casters. The outline that `exact` decides by is drawn with many sides.
std::vector<Line> SphereVolume::outlines() const {
  constexpr int many = 256;
  const glm::dvec4 l = homogeneous(light_);
  std::vector<Line> lines = silhouette_lines(adjacency_, silhouette_);
  for (const Body& body : bodies_) {
    if (l.w != 0 && is_inside(body.shape, glm::dvec3(l))) continue;
    const Contour contour =
        is_exact() ? contour_of(body, l, equal_area, many) : contour_of(body, l, static_cast<Fit>(fit.index()), segments);
    for (std::size_t i = 0; i < contour.points.size(); ++i)
      lines.push_back({contour.points[i], contour.points[(i + 1) % contour.points.size()], silhouette_color(1)});
  }
  return lines;
}

std::vector<float> SphereVolume::draw_debug(std::string_view layer) const {
  if (layer != "volumes" && layer != "counts" && layer != "silhouette") return Technique::draw_debug(layer);
  if (layer != "silhouette") {
    const Pass pass = layer == "volumes" ? Pass::layer : Pass::wide;
    const StateGuard guard;
    begin(*gbuffer_, pass, 0);
    count(pass);
  }
  std::vector<float> picture;
  if (layer == "counts") {
    std::vector<float> counts;
    for (const VolumeCounter::WideCount& c : counter_.wide_counts()) counts.push_back(c.count);
    picture = heat_layer(*gbuffer_, counts);
  } else {
    VisibilityMask mask(gbuffer_->width, gbuffer_->height);
    answer(*gbuffer_, mask);
    picture = shaded_layer(*scene_, *gbuffer_, light_, mask.read());
    if (layer == "volumes")
      paint_volumes(counter_.layer_faces(), gbuffer_->width, picture);
    else
      draw_lines(outlines(), *gbuffer_, picture);
  }
  counter_.drop_pictures();
  return picture;
}

}  // namespace

GNOMON_TECHNIQUE(
    sphere_volume, SphereVolume,
    {.title = "Shadow volumes of shapes",
     .summary = "Stencil shadow volumes of the exact spheres, cones and discs, from the circle where tangents touch.",
     .source = "Heidmann 1991; Everitt and Kilgard 2002",
     .error = "A polygon for each circle: its radius is off by up to 0.08 % at 64 segments of equal area, 0.12 % of the other "
              "fits; none with fit = exact.",
     .fails = "Few segments seen near.",
     .promise = Promise::sampled,
     .sees = Truth::shape,
     .needs_gl = true})
