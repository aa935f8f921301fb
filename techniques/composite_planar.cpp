// Analytic composite shadow: every caster is a simple shape, whose shadow on a plane has a closed form; the shadow of a caster
// composed of shapes is the union of theirs. A pixel tests only the shapes whose outlines reach its part of the picture.
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include "composite_planar/layers.h"
#include "composite_planar/patches.h"
#include "composite_planar/shaders.h"

namespace {
using namespace gnomon;
using namespace composite_planar;

constexpr About about{
    .title = "Analytic composite shadow",
    .summary = "Shadows of simple shapes on planes in closed form, and their union.",
    .source =
        "Pljaskovic et al., Sphere and cone composite realtime shadows (equations 1 to 9); exact forms: "
        "docs/planar_shadow.md.",
    .error =
        "Exact up to float32 rounding at the pixel's point with form = exact. form = paper takes a sphere's shadow for that of "
        "its great circle along the plane, whose area is K^1.5 / (h^2 sqrt(x_i^2 + K)) of the true one, K = h^2 - r^2 (0.81 "
        "with the light 4 m aside and 6 m above a ball of 1 m), and cuts inside the tangents of a cone, by up to a few "
        "percent of the area. form = printed leaves the base of a triangle under the object as well.",
    .fails =
        "Casters without an exact shape; receivers that are not flat: pixels off the planes are lit and not covered; sheets "
        "nearer to each other than float32 tells (25 units of 2^-24 of the scene's extent) are one plane. The forms paper "
        "and printed: all but spheres, discs along the plane, upright cones and triangles, below the light.",
    .promise = Promise::exact,
    .sees = Truth::shape,
    .device = Device::opengl,
    .floor = Floor::fetch,
    .rasterizes = true};

/// Puts data into a buffer that is made anew only when it is too small.
template <class Data>
void fill(Buffer& buffer, const std::vector<Data>& data) {
  const std::size_t bytes = data.size() * sizeof(Data);
  if (buffer.bytes < bytes || !buffer) buffer = Buffer(nullptr, bytes + bytes / 2, GL_DYNAMIC_STORAGE_BIT);
  if (bytes) glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(bytes), data.data());
}

class CompositePlanar final : public Technique {
  Choice form = Choice(this, "form", "exact", {"printed", "paper", "exact"}, Stage::relight,
                       "The paper's equations as printed; as they are meant; conic sections and tangents.");
  Number<double> min_share =
      Number<double>(this, "min_share", 0.01, {.min = 0.001, .max = 1, .log = true}, Stage::build,
                     "Least share of the receiving area, curved shapes left out, that makes coplanar faces a receiver plane.");

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("the formulas are of one point: lights with area have none");
    const GlLimits needed{.varying_components = composite_planar::varying_components(1),
                          .vertex_storage_blocks = 3,
                          .storage_bindings = 3,
                          .storage_block_bytes = sizeof(TestData)};
    if (const Support enough = within_limits(needed); !enough) return enough;
    for (const Mesh& mesh : scene.meshes)
      if (mesh.casts && !mesh.shape) return Support::unsupported(fmt::format("{} has no exact shape", mesh.name));
    const ReceiverSet receivers = find_receivers(scene, min_share);
    const Support support = support_on_planes(!receivers.planes.empty(), receivers.covered_share, min_share);
    if (!support) return support;
    const glm::dvec4 l = homogeneous(light);
    const std::vector<ShapeCaster> casters = casters_of(scene);
    for (const Receiver& receiver : receivers.planes) {
      const auto turned = facing(receiver, l, receivers.tolerance);
      if (!turned) continue;
      for (const ShapeCaster& caster : casters) {
        // A finite light touches what it touches whatever the plane; the rest matters where a shadow may fall.
        const bool casts = may_cast(caster.shape, l, turned->plane, receivers.tolerance);
        const ShadowForm used = casts ? shadow_form() : ShadowForm::exact;
        const std::string why = PlanarShadow::objection(caster.shape, l, turned->plane, used);
        if (!why.empty()) return Support::unsupported(fmt::format("{}: {}", scene.meshes[caster.mesh].name, why));
      }
    }
    return support;
  }

  void setup() override {
    while (made_->most_tests > 1 &&
           !within_limits({.varying_components = composite_planar::varying_components(made_->most_tests)}))
      --made_->most_tests;
    for (std::size_t kind = 0; kind < made_->programs.size(); ++kind) {
      const std::string head = fmt::format("#define COUNT {}\n", std::array<std::uint32_t, 3>{0, 1, made_->most_tests}[kind]);
      made_->programs[kind] = Program("composite_planar", head + std::string(patch_vertex), head + patch_fragment);
    }
    made_->framebuffer = make_framebuffer();
    made_->vertex_array = make_vertex_array();
    const GLuint vao = made_->vertex_array.name();
    glVertexArrayAttribIFormat(vao, 0, 4, GL_UNSIGNED_INT, offsetof(Patch, left));
    glVertexArrayAttribIFormat(vao, 1, 3, GL_UNSIGNED_INT, offsetof(Patch, plane));
    for (const GLuint attribute : {0u, 1u}) {
      glVertexArrayAttribBinding(vao, attribute, 0);
      glEnableVertexArrayAttrib(vao, attribute);
    }
    glVertexArrayBindingDivisor(vao, 0, 1);
    // The same picture without lists, with lists of one and of more: each program draws. All forms draw alike; exact takes any
    // scene.
    const std::string chosen = form.text();
    form.set("exact");
    for (const std::uint32_t limit : {0u, 1u, made_->most_tests}) {
      list_limit_ = limit;
      warm_up(*this);
    }
    form.set(chosen);
  }

  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->casters = casters_of(scene);
    made_->receivers = find_receivers(scene, min_share);
  }
  void relight(const Light& light) override {
    light_ = light;
    const glm::dvec4 l = homogeneous(light);
    facing_.clear();
    test_data_.clear();
    reaches_.clear();
    exact_.reset();
    std::vector<std::array<glm::vec4, 2>> planes;
    for (const Receiver& receiver : made_->receivers.planes) {
      facing_.push_back(facing(receiver, l, made_->receivers.tolerance));
      const Receiver& turned = facing_.back() ? *facing_.back() : receiver;
      planes.push_back({glm::vec4(turned.plane), glm::vec4(static_cast<float>(turned.turn))});
    }
    add_reaches(shadow_form(), reaches_);
    for (const Reach& reach : reaches_) test_data_.emplace_back(reach.test);
    tests_ = Buffer(test_data_.data(), test_data_.size() * sizeof(TestData));
    planes_ = Buffer(planes.data(), planes.size() * sizeof(planes[0]));
    glFinish();
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    find_patches(gbuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, made_->framebuffer.name());
    glNamedFramebufferTexture(made_->framebuffer.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
    glViewport(0, 0, gbuffer.width, gbuffer.height);
    const float lit[] = {1, 0, 0, 0};
    glClearNamedFramebufferfv(made_->framebuffer.name(), GL_COLOR, 0, lit);
    if (patches_.size() > 0) draw(gbuffer);
    glFinish();
  }

  Counts counts() const override {
    double fill = 0, tests = 0;
    for (const auto* kind : {&patches_.whole, &patches_.single, &patches_.several})
      for (const Patch& patch : *kind) {
        fill += patch.pixel_count();
        tests += patch.pixel_count() * patch.count;
      }
    const auto discs = std::ranges::count_if(test_data_, [](const TestData& test) { return test.anchor.w != 0; });
    const std::size_t bytes = bytes_of(facing_, test_data_, reaches_) + tests_.bytes + planes_.bytes + tiles_.bytes() +
                              2 * patches_.bytes();  // patches: also on the device
    return {{"casters", double(made_->casters.size()), ""},
            {"planes", double(made_->receivers.planes.size()), ""},
            {"discs", double(discs), ""},
            {"polygons", double(test_data_.size() - discs), ""},
            {"patches", double(patches_.size()), ""},
            {"fill", fill, "pixel"},
            {"asked", tests, "test"},
            {"bytes", double(bytes) + made_.own(double(bytes_of(made_->casters, made_->receivers.planes))), "byte"}};
  }

  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    const glm::dvec3 point = gbuffer_->position(index);
    const auto receiver = receiver_of(index);
    why.covered = receiver.has_value();
    if (!why.covered) return why;
    const auto holder_in = [&](std::span<const Reach> reaches) -> std::optional<std::uint64_t> {
      for (const Reach& reach : reaches)
        if (reach.plane == *receiver && reach.test.contains(point)) return reach.mesh;
      return std::nullopt;
    };
    why.element = holder_in(reaches_);
    if (shadow_form() == ShadowForm::exact) return why;
    if (!exact_) add_reaches(ShadowForm::exact, exact_.emplace());
    why.formula_differs = why.element.has_value() != holder_in(*exact_).has_value();
    return why;
  }

  std::vector<DebugLayer> debug_layers() const override { return composite_layers(); }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "parts") return paint_parts(*made_->scene, *gbuffer_, light_, find_holders());
    if (layer == "overlaps") return paint_overlaps(*gbuffer_, find_holders());
    return Technique::draw_debug(layer);
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &CompositePlanar::made_); }

 private:
  struct ShapeCaster {
    std::uint32_t mesh;
    Shape shape;
  };
  /// A test of a caster's shadow, and where in the world it may answer yes.
  struct Reach {
    std::uint32_t plane, mesh;
    ShadowTest test;
    Polygon polygon;
  };
  ShadowForm shadow_form() const { return static_cast<ShadowForm>(form.index()); }
  static std::vector<ShapeCaster> casters_of(const Scene& scene) {
    std::vector<ShapeCaster> casters;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (mesh.casts && mesh.shape) casters.push_back({m, *mesh.shape});
    }
    return casters;
  }

  /// Adds the tests of a form under the light, plane after plane.
  void add_reaches(ShadowForm used, std::vector<Reach>& reaches) const {
    const glm::dvec4 l = homogeneous(light_);
    for (std::uint32_t r = 0; r < facing_.size(); ++r) {
      if (!facing_[r]) continue;
      for (const ShapeCaster& caster : made_->casters) {
        if (!may_cast(caster.shape, l, facing_[r]->plane, made_->receivers.tolerance)) continue;
        const PlanarShadow shadow(caster.shape, l, facing_[r]->plane, used);
        for (std::size_t i = 0; i < shadow.parts().size(); ++i) {
          const Polygon polygon = bound_of(shadow.parts()[i], used != ShadowForm::exact, l, *facing_[r]);
          if (polygon.size() > 0) reaches.push_back({r, caster.mesh, shadow.tests()[i], polygon});
        }
      }
    }
  }

  std::optional<std::size_t> receiver_of(std::size_t index) const {
    const glm::dvec4 point(gbuffer_->position(index), 1);
    for (std::size_t r = 0; r < made_->receivers.planes.size(); ++r)
      if (facing_[r] && std::abs(glm::dot(facing_[r]->plane, point)) <= made_->receivers.tolerance &&
          glm::distance(glm::dvec3(gbuffer_->normal(index)), glm::dvec3(facing_[r]->plane)) <= facing_[r]->turn)
        return r;
    return std::nullopt;
  }

  std::vector<Holders> find_holders() const {
    std::vector<Holders> holders(gbuffer_->size());
    for_blocks(holders.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (!faces_light(*made_->scene, *gbuffer_, light_, i)) continue;
        const glm::dvec3 point = gbuffer_->position(i);
        const auto receiver = receiver_of(i);
        for (const Reach& reach : reaches_)
          if (receiver == reach.plane && reach.test.contains(point))
            ++(reach.test.is_disc ? holders[i].discs : holders[i].polygons);
      }
    });
    return holders;
  }

  void find_patches(const GBuffer& gbuffer) {
    tiles_.begin(gbuffer);
    const glm::dvec4 eye(glm::dvec3(gbuffer.view.eye), 1);
    std::optional<std::uint32_t> begun;
    for (std::uint32_t t = 0; t < reaches_.size(); ++t) {
      const auto& [plane, mesh, test, polygon] = reaches_[t];
      // Seen from behind, the plane shows its unlit side.
      if (glm::dot(facing_[plane]->plane, eye) <= 0) continue;
      if (begun != plane) {
        tiles_.begin_plane(plane, facing_[plane]->plane);
        begun = plane;
      }
      tiles_.add(t, test, polygon);
    }
    patches_.make(tiles_.sorted(), tiles_.columns(), gbuffer.width, gbuffer.height, std::min(list_limit_, made_->most_tests));
  }

  void draw(const GBuffer& gbuffer) {
    std::vector<Patch> all = patches_.whole;
    all.insert(all.end(), patches_.single.begin(), patches_.single.end());
    all.insert(all.end(), patches_.several.begin(), patches_.several.end());
    fill(instances_, all);
    fill(lists_, patches_.lists);
    const GLuint vao = made_->vertex_array.name();
    glVertexArrayVertexBuffer(vao, 0, instances_.name(), 0, sizeof(Patch));
    bind_gbuffer(gbuffer_textures(gbuffer, *made_->scene));
    require_storage_block(std::max(tests_.bytes, lists_.bytes));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, tests_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, lists_.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, planes_.name());
    glBindVertexArray(vao);
    std::size_t first = 0;
    for (std::size_t kind = 0; kind < made_->programs.size(); ++kind) {
      const std::size_t count = std::array{patches_.whole.size(), patches_.single.size(), patches_.several.size()}[kind];
      if (count == 0) continue;
      const Program& program = made_->programs[kind];
      set_light(program, light_);
      program.set("tolerance", static_cast<float>(made_->receivers.tolerance));
      program.set("size", glm::vec2(gbuffer.width, gbuffer.height));
      glUseProgram(program.name());
      glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count), static_cast<GLuint>(first));
      first += count;
    }
    glBindVertexArray(0);
  }

  struct Made {
    std::array<Program, 3> programs;  // for patches without a list, of one test, of more
    Framebuffer framebuffer;
    VertexArray vertex_array;
    std::uint32_t most_tests = Patches::most;  // of a patch: fewer where the device hands fewer floats to pixels
    const Scene* scene = nullptr;
    std::vector<ShapeCaster> casters;
    ReceiverSet receivers;
  };

  Shared<Made> made_;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  std::vector<std::optional<Receiver>> facing_;  // of each receiver
  std::vector<TestData> test_data_;
  std::vector<Reach> reaches_;                       // of each test, by plane
  mutable std::optional<std::vector<Reach>> exact_;  // the same of the exact form, made by the first `explain` of another
  Tiles tiles_;
  Patches patches_;
  std::uint32_t list_limit_ = Patches::most;
  Buffer tests_, planes_, lists_, instances_;
};

}  // namespace

GNOMON_TECHNIQUE(composite_planar, CompositePlanar, about)
