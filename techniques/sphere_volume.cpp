// Shadow volumes of shapes: those of the exact spheres, cones and discs, counted in the stencil buffer by z-fail; no triangle
// of their tessellation takes part. Casters without a curved shape cast the volumes of their own triangles.
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/volumes/volume_technique.h>
#include <gnomon/registry.h>

#include "sphere_volume/bodies.h"
#include "sphere_volume/shaders.h"

namespace {
using namespace gnomon;
using namespace sphere_volume;

constexpr About about{
    .title = "Shadow volumes of shapes",
    .summary = "Stencil shadow volumes of the exact spheres, cones and discs, from the circle where tangents touch.",
    .source =
        "Heidmann 1991; Everitt and Kilgard 2002 (z-fail, caps). A sphere's volume starts from the circle where tangents "
        "from the light touch it, a cone's from its two tangent generators and an arc of its base, a disc's from its "
        "circle.",
    .error =
        "A polygon of N segments stands for a circle. Its radius errs by up to (pi / N)^2 / 2, 0.12 % at 64: inscribed "
        "inward, circumscribed outward, of equal area by a third of that inward and two thirds (0.08 % at 64) outward. The "
        "share of wrong pixels falls with N^2; of equal area it is 0.38 of the inscribed one's and 0.77 of the "
        "circumscribed one's. With fit = exact each pixel's point decides and errs by float32 rounding only. Besides, the "
        "rasterizer snaps vertices to 1/256 pixel.",
    .fails = "Few segments, seen near. Nothing it supports with fit = exact, but for the triangles of other casters.",
    .sees = Truth::shape,
    .device = Device::opengl,
    .floor = Floor::fetch,
    .rasterizes = true};

// A convex body casts no shadow on its own surface facing the light, so its faces leave alone the pixels of its own mesh; its
// light cap runs inside it, where no eye outside sees it. A body with the light inside has no outline and casts no volume:
// if the eye is inside, too, it casts on nothing in view; else all that is in view lies on the other side of its surface, and
// is dark. So it is with a body around the eye and not the light.
class SphereVolume final : public VolumeTechnique {
  Number<int> segments = Number<int>(this, "segments", 64, {.min = 8, .max = 256, .log = true}, Stage::relight,
                                     "Sides of the polygon that stands for a circle; `exact` does without.");
  Choice fit = Choice(
      this, "fit", "equal_area", {"inscribed", "equal_area", "circumscribed", "exact"}, Stage::relight,
      "Where the polygon lies: inside the circle, of its area, or around it; or the circle itself, decided at each pixel.");

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("a shadow volume starts from one point: lights with area have none");
    if (homogeneous(light).w != 0)
      for (const Mesh& mesh : scene.meshes)
        if (mesh.casts && mesh.has_curved_shape() && is_on_surface(*mesh.shape, glm::dvec3(homogeneous(light))))
          return Support::unsupported(
              fmt::format("the light lies on the surface of {}, whose outline cannot be seen from there", mesh.name));
    const GlLimits needed = FaceDrawer::needs(scene);
    return within_limits(is_exact() ? most_of(needed, bodies_need(scene.meshes.size())) : needed);
  }

  void setup() override {
    made_->counter.setup();
    own_->body_program = VolumeProgram("sphere_volume bodies", volume_vertex, true);
    made_->drawer.setup("sphere_volume");
    for (int kind = 0; kind < kind_count; ++kind)
      own_->exact_programs[kind] =
          Program("sphere_volume exact", bounding_vertex, fmt::format("#define KIND {}\n{}", kind, exact_fragment));
    // Each way to count bodies, in eight bits and in 32.
    const std::string chosen = fit.text();
    for (const char* way : {"equal_area", "exact"}) {
      fit.set(way);
      for (const std::size_t limit : {0, VolumeCounter::stencil_limit}) {
        stencil_limit_ = limit;
        warm_up(*this);
      }
    }
    fit.set(chosen);
    made_->counter.drop_pictures();
  }

  void build(const Scene& scene) override {
    made_->scene = &scene;
    scene_buffers(scene);
    own_->bodies.clear();
    Scene flat;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (!mesh.casts) continue;
      if (mesh.has_curved_shape())
        own_->bodies.push_back({m, *mesh.shape});
      else
        flat.meshes.push_back(mesh);
    }
    const auto kind_of = [](const Body& body) { return body.shape.index(); };
    std::ranges::stable_sort(own_->bodies, {}, kind_of);
    for (std::size_t kind = 0; kind <= kind_count; ++kind)
      own_->first_of_kind[kind] = std::ranges::lower_bound(own_->bodies, kind, {}, kind_of) - own_->bodies.begin();
    made_->adjacency = EdgeAdjacency(flat);
    made_->far_planes = FarPlanes(scene);
    own_->flat_positions = Buffer(made_->adjacency.positions().data(), made_->adjacency.positions().size_bytes());

    std::vector<BodyData> data;
    for (const Body& body : own_->bodies) {
      if (const auto* sphere = std::get_if<Sphere>(&body.shape))
        data.push_back({{sphere->center, sphere->radius}, {}, body.mesh + 1});
      else if (const auto* cone = std::get_if<Cone>(&body.shape))
        data.push_back({{cone->base, cone->radius}, {glm::normalize(glm::dvec3(cone->axis)), cone->height}, body.mesh + 1});
      else if (const auto* disc = std::get_if<Disc>(&body.shape))
        data.push_back({{disc->center, disc->radius}, {glm::normalize(glm::dvec3(disc->normal)), 0}, body.mesh + 1});
    }
    own_->body_data = Buffer(data.data(), data.size() * sizeof(BodyData));
  }

  void relight(const Light& light) override {
    light_ = light;
    const glm::dvec4 l = homogeneous(light);
    volumes_ = {};
    for (std::uint32_t i = 0; i < own_->bodies.size(); ++i) {
      const Shape& shape = own_->bodies[i].shape;
      volumes_.add(holds_light(own_->bodies[i]) ? Contour{}
                   : is_exact()                 ? bounding_contour(shape, l)
                                                : contour_of(shape, l, polygon_fit(), segments),
                   l, i, own_->bodies[i].mesh);
    }
    made_->adjacency.find_silhouette(l, silhouette_);
    ends_early_ = !made_->far_planes.empty();
    commands_ = write_faces(made_->adjacency, silhouette_, {.dark_caps = l.w != 0 || ends_early_, .ends = ends()}, faces_);
    // A convex body has one volume; with `exact` a dark pixel is counted once.
    volume_bound_ = static_cast<std::size_t>(bound_depth(made_->adjacency, silhouette_, VolumeCounter::stencil_limit));
    if (!is_exact()) volume_bound_ += own_->bodies.size();
    wide_ = volume_bound_ > stencil_limit_;
    upload();
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    answer(mask);
  }
  Counts counts() const override {
    const std::size_t bytes =
        VolumeTechnique::bytes() + volumes_.bytes() + vertices_.bytes() + body_of_.bytes() + indices_.bytes() +
        static_cast<std::size_t>(own_.own(double(bytes_of(own_->bodies) + own_->body_data.bytes + own_->flat_positions.bytes)));
    const std::size_t side_triangles = volumes_.side_triangle_count() + commands_.sides.count / 3;
    const std::size_t triangles = volumes_.triangle_count() + commands_.triangle_count();
    Counts counts{{"bodies", double(own_->bodies.size()), ""},
                  {"side_quads", double(side_triangles / (homogeneous(light_).w == 0 ? 1 : 2)), ""},
                  {"cap_triangles", double(triangles - side_triangles), ""},
                  {"silhouette_edges", double(silhouette_.edges.size()), ""},
                  {"triangles", double(triangles), ""},
                  {"bytes", double(bytes), "byte"}};
    if (!gbuffer_) return counts;

    const auto [fill, deepest] = measure_work();
    counts.insert(counts.end(), {{"depth_bound", double(volume_bound_), "", Count::Together::largest},
                                 {"fill", fill, "pixel"},
                                 {"deepest", deepest, "volume", Count::Together::largest},
                                 {"counter_bits", wide_ ? 32.0 : 8.0, "bit", Count::Together::largest}});
    return counts;
  }

  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    why.element = gbuffer_->mesh[index];
    if (!is_exact())
      why.outline_error = outline_error(own_->bodies, homogeneous(light_), gbuffer_->position(index), polygon_fit(), segments);
    return why;
  }

  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &SphereVolume::made_, &SphereVolume::own_);
  }

 private:
  void upload() {
    vertices_.rewrite(volumes_.vertices);
    body_of_.rewrite(is_exact() ? volumes_.body_of : std::vector<std::uint32_t>());
    std::vector<std::uint32_t> all;
    for (int f = 0; f < 3; ++f) {
      first_index_[f] = all.size();
      all.insert(all.end(), volumes_.indices[f].begin(), volumes_.indices[f].end());
    }
    indices_.rewrite(all);
    if (!vertex_array_) vertex_array_ = make_vertex_array();
    const GLuint vao = vertex_array_.name();
    glVertexArrayVertexBuffer(vao, 1, vertices_.name(), 0, sizeof(glm::vec4));
    glVertexArrayAttribFormat(vao, 1, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vao, 1, 1);
    glEnableVertexArrayAttrib(vao, 1);
    glVertexArrayVertexBuffer(vao, 2, body_of_.name(), 0, 4);
    glVertexArrayAttribIFormat(vao, 2, 1, GL_UNSIGNED_INT, 0);
    glVertexArrayAttribBinding(vao, 2, 2);
    (is_exact() ? glEnableVertexArrayAttrib : glDisableVertexArrayAttrib)(vao, 2);
    glVertexArrayElementBuffer(vao, indices_.name());
    glFinish();
  }

  bool is_exact() const { return fit.index() == sphere_volume::exact; }
  Fit polygon_fit() const { return static_cast<Fit>(fit.index()); }
  /// From inside a body there is no outline: see is_all_dark.
  bool holds_light(const Body& body) const {
    const glm::dvec4 l = homogeneous(light_);
    return l.w != 0 && contains(body.shape, glm::dvec3(l));
  }
  /// A solid that holds the light or the eye, and not both, hides the one from all that the other sees.
  bool is_all_dark(const View& view) const {
    const glm::dvec3 eye = view.eye;
    return std::ranges::any_of(own_->bodies, [&](const Body& b) { return holds_light(b) != contains(b.shape, eye); });
  }
  void answer(VisibilityMask& mask) const override {
    const bool all_dark = is_all_dark(gbuffer_->view);
    begin(mask_pass(), all_dark);
    if (!all_dark) count(mask_pass());
    made_->counter.write_mask(gbuffer_textures(*gbuffer_, *made_->scene), light_, mask);
    glFinish();
  }
  /// Of bodies and of flat casters. The outline that `exact` decides by is drawn with many sides.
  std::vector<Line> outlines() const override {
    const Fit drawn = is_exact() ? equal_area : polygon_fit();
    const int side_count = is_exact() ? 256 : int(segments);
    std::vector<Line> lines = VolumeTechnique::outlines();
    for (const Body& body : own_->bodies) {
      if (holds_light(body)) continue;
      const std::vector<glm::dvec3> points = contour_of(body.shape, homogeneous(light_), drawn, side_count).points;
      for (std::size_t i = 0; i < points.size(); ++i)
        lines.push_back({points[i], points[(i + 1) % points.size()], silhouette_color(1)});
    }
    return lines;
  }

  void draw(Pass pass) const override {
    begin(pass, 0);
    count(pass);
  }
  void begin(Pass pass, int start) const {
    const GBufferTextures& textures = gbuffer_textures(*gbuffer_, *made_->scene);
    made_->counter.begin(depth_stencil(*made_->scene, *gbuffer_, Truth::shape), textures, pass, CountWhere::behind_surface,
                         start);
    bind_gbuffer(textures);
  }
  void count(Pass pass) const {
    if (commands_.caps.count + commands_.reversed_caps.count > 0) {
      bind_faces(own_->flat_positions);
      made_->drawer.draw_sides(made_->counter);
      made_->drawer.draw_caps(made_->counter);
    }
    glBindVertexArray(vertex_array_.name());
    const glm::mat4 clip(clip_from_world(*gbuffer_, *made_->scene));
    own_->body_program.each([&](const Program& p) { p.set("clip_from_world", clip); });
    for (const Program& program : own_->exact_programs) program.set("clip_from_world", clip);
    if (is_exact() && pass != Pass::layer)
      count_bodies_exactly(pass);
    else
      count_bodies(pass);
    glBindVertexArray(0);
  }

  void count_bodies(Pass pass) const {
    const VolumeProgram& program = own_->body_program;
    const Program& used = pass == Pass::stencil ? program.stencil : pass == Pass::wide ? program.wide : program.layer;
    const GLint own_mesh = glGetUniformLocation(used.name(), "own_mesh");
    for (int f = 0; f < 3; ++f) {
      made_->counter.use(program, static_cast<VolumeFace>(f));
      for (const DrawRange& range : volumes_.ranges[f]) {
        if (range.count == 0) continue;
        glUniform1i(own_mesh, static_cast<GLint>(range.own_mesh));
        const auto* const offset = reinterpret_cast<const void*>(4 * (first_index_[f] + range.first));
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(range.count), GL_UNSIGNED_INT, offset);
      }
    }
  }

  /// Counts a body at the pixels before the far faces of its bounding volume whose points are in its shadow. Far faces, because
  /// they cover a volume's pixels also when the eye is inside. In the stencil, one body is enough: the test passes over dark
  /// pixels.
  void count_bodies_exactly(Pass pass) const {
    glDepthFunc(GL_LESS);  // reversed: farther than the surface
    glEnable(GL_CULL_FACE);
    glCullFace(GL_FRONT);
    if (pass == Pass::stencil) {
      glStencilFunc(GL_EQUAL, 0, ~0u);
      glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, own_->body_data.name());
    for (int kind = 0; kind < kind_count; ++kind) {
      const std::size_t first = own_->first_of_kind[kind], end = own_->first_of_kind[kind + 1];
      if (first == end) continue;
      const Program& program = own_->exact_programs[kind];
      set_light(program, light_);
      glUseProgram(program.name());
      for (int f = 0; f < 3; ++f) {
        // Neighbors in the list of bodies are neighbors in the list of indices.
        const DrawRange &from = volumes_.ranges[f][first], &to = volumes_.ranges[f][end - 1];
        const auto* const offset = reinterpret_cast<const void*>(4 * (first_index_[f] + from.first));
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(to.first + to.count - from.first), GL_UNSIGNED_INT, offset);
      }
    }
    glDisable(GL_CULL_FACE);
  }

  struct Own {
    VolumeProgram body_program;
    std::array<Program, kind_count> exact_programs;
    std::vector<Body> bodies;  // by kind
    std::array<std::size_t, kind_count + 1> first_of_kind{};
    Buffer flat_positions;  // of the adjacency
    Buffer body_data;
  };

  Shared<Own> own_;
  Volumes volumes_;  // of the bodies; those of other casters are `faces_`
  RewrittenBuffer vertices_, body_of_, indices_;
  std::array<std::size_t, 3> first_index_{};  // of each face, in `indices_`
  VertexArray vertex_array_;
  std::size_t volume_bound_ = 0, stencil_limit_ = VolumeCounter::stencil_limit;
};

}  // namespace

GNOMON_TECHNIQUE(sphere_volume, SphereVolume, about)
