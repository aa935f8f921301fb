// Planar projected shadow: casters flattened onto each receiver plane by a matrix and drawn there from the eye.
#include <gnomon/kit/geometry/plane_projection.h>
#include <gnomon/kit/gl/gl_planes.h>
#include <gnomon/kit/gl/projected_shadows.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <iterator>

#include "planar_projected/shaders.h"

namespace {
using namespace gnomon;
using namespace planar_projected;

constexpr About about{
    .title = "Planar projected shadow",
    .summary = "Casters flattened onto each receiver plane by a matrix and drawn there from the eye.",
    .source = "Blinn 1988, in homogeneous form, so that point and directional lights are one case.",
    .error =
        "Exact up to the rasterizer's snapping of edges to 1/256 pixel: wrong pixels are those whose center lies on an edge "
        "(at most 1 in 10 000 of the tested pixels in our scenes, none farther than 1/100 pixel from an edge). Behind k surfaces "
        "of glass the product is off by k 2^-24 of itself: each is multiplied in float32. Wrong on purpose with a textbook "
        "artefact on.",
    .fails = "Receivers that are not flat: pixels off the receiver planes are lit and reported as not covered.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .rasterizes = true,
    .handles = with_gray_transmission};

// With the plane P = (n, d), n toward the light L, M = (P.L) I - L P^T. The image of a caster's point p has w = P.L - (light's
// w) P.p: positive between the plane and the light, zero at the light's height. Lecture notes print the matrix of the plane
// z = 0 with the last row (0, 0, 1, -l_z): that w has the other sign, and the shadow comes out reflected in the origin. Casters
// behind the plane (false shadow) and behind the light (anti-shadow) are clipped, and so are triangles that pass the one or the
// other, before anything is divided.
//
// Each pixel stores its receiver plane, and each plane receives the shadows of all casters on its light's side. So receivers
// end where they end, hide each other, and have the shadows of objects on them. A pixel is dark or it is not, however many
// triangles of opaque casters cover it. Glass is blended: each of its triangles multiplies what is there by what it lets
// through at its place. Products commute, so that the order does not matter. The rasterizer gives a pixel on the edge of two
// triangles to one of them, so that a surface counts once there; a thin box is two surfaces and counts twice. Two settings do
// what textbooks warn of:
//   unclipped     divides by w and clips nothing. A caster behind the light casts a mirrored anti-shadow, one behind the plane
//                 a false shadow, a triangle through the light's height the wrong part of its plane. Whatever lies behind a
//                 plane darkens it: the ground does so to every table, a solid's far sides to its near ones.
//   double_blend  halves what is there for every opaque triangle: n of them leave 1/2^n. A closed convex caster has n = 2,
//                 its near side and its far one, or 1 where the plane cuts it open; where shadows overlap, they add up.
// Where the answer differs by more than one half from that without them, in scenes with glass by more than 1/20, `explain`
// reports that the formula differs. A mask of 1/2 counts as dark: double_blend shows in the mean error and in the shaded
// picture, hardly in wrong pixels.
/// Casters projected onto one plane by one light.
struct Projection : PlaneProjection {
  std::uint32_t index;  ///< of the receiver plane
  /// Neither behind the plane nor behind the light, and whose shadow may fall on a receiver.
  std::vector<std::uint32_t> casters = {};
  /// Of these the closed ones that nothing clips, whose lit side casts all of their shadow, and the others.
  std::vector<std::uint32_t> one_sided = {}, two_sided = {};
};

/// Receiver planes differ by depths that float32 represents exactly. There are at most 1000: each has its share of the area.
constexpr float depth_step = 0x1p-16f;

class PlanarProjected final : public Technique {
  Number<double> min_share =
      Number<double>(this, "min_share", 0.01, {.min = 0.001, .max = 1, .log = true}, Stage::build,
                     "Least share of the receiving area that makes a set of coplanar faces a receiver plane.");
  Flag unclipped{this, "unclipped", false, Stage::relight,
                 "Textbook artefact: casters are divided by w and none is clipped, so that those behind the light or the plane "
                 "cast, too."};
  Flag double_blend{
      this, "double_blend", false, Stage::resolve,
      "Textbook artefact: every projected triangle halves what is there, so that shadows darken where they overlap."};

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("casters are projected from one point: lights with area have none");
    if (const Support enough = within_limits(PlaneLookup::needs(scene)); !enough) return enough;
    return support_on_planes(find_receiver_planes(scene, min_share), min_share);
  }

  void setup() override {
    for (int k = 0; k < 2; ++k)
      made_->receivers_programs[k] = pass_program("planar_projected receivers", receivers_constants,
                                                  fmt::format("#define PLANES_FACE {}\n", k) + receivers_fragment);
    made_->shadow_programs = ShadowPrograms("planar_projected shadow", projection_vertex);
    made_->unclipped_programs = ShadowPrograms("planar_projected unclipped shadow", unclipped_vertex);
    made_->framebuffer = make_framebuffer();
    const Artefacts chosen{unclipped, double_blend};
    const auto choose = [&](const Artefacts& artefacts) {
      unclipped.set(artefacts.unclipped ? "true" : "false");
      double_blend.set(artefacts.double_blend ? "true" : "false");
    };
    for (const bool clips : {false, true})
      for (const bool blends : {false, true}) {
        choose({!clips, blends});
        warm_up(*this, true);
      }
    choose(chosen);
  }

  void build(const Scene& scene) override {
    made_->scene = &scene;
    scene_buffers(scene);
    made_->shadow_programs.fit(scene);
    made_->unclipped_programs.fit(scene);
    made_->lookup.build(scene, min_share);
    made_->extent = scene.bounds().extent();
    made_->bounds.clear();
    made_->casters.clear();
    made_->glass.clear();
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      made_->bounds.emplace_back().add(scene.meshes[m].positions);
      if (!scene.meshes[m].casts) continue;
      made_->casters.push_back(static_cast<std::uint32_t>(m));
      if (scene.meshes[m].transmission) made_->glass.push_back(static_cast<std::uint32_t>(m));
    }

    // Triangles on the plane must stay below what the shader finds to be their height.
    made_->clip_tolerance = made_->lookup.planes().tolerance + height_rounding(scene);
  }

  void relight(const Light& light) override {
    light_ = light;
    artefacts_.unclipped = unclipped;
    projections_.clear();
    const glm::dvec4 l = homogeneous(light);
    const double tolerance = made_->clip_tolerance;
    planes_face_ = !std::holds_alternative<SpotLight>(light.kind);
    const double slack = std::max(4 * tolerance, 0x1p-20 * made_->extent);
    for (std::uint32_t i = 0; i < made_->lookup.planes().planes.size(); ++i) {
      glm::dvec4 plane = made_->lookup.planes().planes[i].plane;
      if (glm::dot(plane, l) < 0) plane = -plane;
      const double light_height = glm::dot(plane, l);  // of a directional light: per unit of its direction
      // A light in the plane, as far as float32 can tell, faces none of it.
      if (light_height <= (l.w != 0 ? tolerance : 0x1p-24 * glm::length(l))) continue;
      planes_face_ = planes_face_ && light_height > 0x1p-19 * farthest(l, made_->lookup.bounds()[i]);
      Projection projection{PlaneProjection(plane, l), i};
      for (const std::uint32_t m : made_->casters) {
        const glm::dvec3 middle = (glm::dvec3(made_->bounds[m].min) + glm::dvec3(made_->bounds[m].max)) / 2.0;
        const glm::dvec3 half = (glm::dvec3(made_->bounds[m].max) - glm::dvec3(made_->bounds[m].min)) / 2.0;
        const double height = glm::dot(plane, glm::dvec4(middle, 1)), reach = glm::dot(glm::abs(glm::dvec3(plane)), half);
        const bool behind_plane = height + reach <= tolerance;
        const bool behind_light = l.w != 0 && height - reach >= light_height;
        if (behind_plane || behind_light || !projection.may_reach(made_->bounds[m], made_->lookup.bounds()[i], slack)) continue;
        projection.casters.push_back(m);
        if (made_->scene->meshes[m].transmission) continue;
        const bool is_clipped = height - reach < 2 * tolerance || (l.w != 0 && height + reach >= 0.99 * light_height);
        (made_->scene->meshes[m].is_closed() && !is_clipped ? projection.one_sided : projection.two_sided).push_back(m);
      }
      if (!projection.casters.empty() || unclipped) projections_.push_back(std::move(projection));
    }
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    artefacts_.double_blend = double_blend;
    differs_.clear();
    receivers_.fit(GL_DEPTH_COMPONENT32F, gbuffer.width, gbuffer.height);
    begin_pass(0, GL_ALWAYS);
    bind_gbuffer(gbuffer_textures(gbuffer, *made_->scene));
    made_->lookup.bind(gbuffer.truth);
    const Program& program = made_->receivers_programs[planes_face_];
    set_light(program, light_);
    program.set("depth_step", depth_step);
    glUseProgram(program.name());
    draw_full_screen();
    work_ = draw_shadows(mask.texture(), artefacts_);
    glFinish();
  }

  Counts counts() const override {
    const std::size_t shared_bytes = made_->lookup.bytes() + (made_->casters.size() + made_->glass.size()) * 4;
    double bytes = static_cast<double>(receivers_.bytes) + made_.own(static_cast<double>(shared_bytes));
    for (const Projection& projection : projections_) bytes += double(sizeof(projection) + 2 * projection.casters.size() * 4);
    return {{"planes", double(work_.planes), ""},
            {"casters", double(work_.casters), ""},
            {"triangles", double(work_.triangles), ""},
            {"bytes", bytes, "byte"}};
  }

  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    const std::uint32_t plane = made_->lookup.plane_of(*gbuffer_, index);
    why.covered = plane != no_plane;
    if (!why.covered) return why;
    why.element = plane;
    why.formula_differs = artefacts_differ(index);
    return why;
  }

  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &PlanarProjected::made_); }

 private:
  /// The settings that the last stages ran with.
  struct Artefacts {
    bool unclipped = false, double_blend = false;
  };
  struct Work {
    std::size_t planes = 0, casters = 0, triangles = 0;
  };
  /// Attaches a texture, or none for 0, and the planes of the pixels as depths. Leaves state for a StateGuard.
  void begin_pass(GLuint color, GLenum depth_test) const {
    const GLuint framebuffer = made_->framebuffer.name();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, gbuffer_->width, gbuffer_->height);
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, receivers_.name(), 0);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(depth_test);
  }

  /// Fills a texture of the picture's size with 1, and with the shadows. Leaves state for a StateGuard.
  Work draw_shadows(GLuint texture, const Artefacts& artefacts) const {
    const GBuffer& gbuffer = *gbuffer_;
    begin_pass(texture, GL_EQUAL);
    const float lit[] = {1, 0, 0, 0};
    glClearNamedFramebufferfv(made_->framebuffer.name(), GL_COLOR, 0, lit);
    glDepthMask(GL_FALSE);
    if (artefacts.double_blend) {
      glEnable(GL_BLEND);
      glBlendFunc(GL_ZERO, GL_SRC_COLOR);  // halving is exact in float32, in whatever order the triangles come
    }
    if (!artefacts.unclipped) {
      glEnable(GL_CLIP_DISTANCE0);
      glEnable(GL_CLIP_DISTANCE1);
    }
    const SceneBuffers& buffers = scene_buffers(*made_->scene);
    const glm::dmat4 clip = clip_from_world(gbuffer, *made_->scene);
    const ShadowPrograms& p = artefacts.unclipped ? made_->unclipped_programs : made_->shadow_programs;
    p.set("tolerance", static_cast<float>(made_->clip_tolerance));
    p.opaque.set("darkened", artefacts.double_blend ? 0.5f : 0.0f);
    Work work;
    for (const Projection& projection : projections_) {
      const std::vector<std::uint32_t>& casters = artefacts.unclipped ? made_->casters : projection.casters;
      // Seen from behind, the plane shows its unlit side.
      if (casters.empty() || glm::dot(projection.plane, glm::dvec4(glm::dvec3(gbuffer.view.eye), 1)) <= 0) continue;
      if (artefacts.unclipped) {
        p.set("clip_from_world", glm::mat4(clip));
        p.set("projected", glm::mat4(projection.projected));
      } else {
        p.set("clip_from_world", glm::mat4(clip * projection.projected));
        p.set("per_light_height", static_cast<float>(projection.per_light_height));
      }
      p.set("plane", glm::vec4(projection.plane));
      // The share's own rounding error: shadows of casters so near to the light's height reach infinity anyway.
      p.set("least_share", static_cast<float>(0x1p-22 + made_->clip_tolerance * projection.per_light_height));
      const double depth = (projection.index + 1) * double(depth_step);
      glDepthRange(depth, depth);
      if (artefacts.unclipped) {
        std::vector<std::uint32_t> opaque;
        std::ranges::set_difference(casters, made_->glass, std::back_inserter(opaque));
        buffers.draw(opaque, p.opaque);
      } else {
        buffers.draw(projection.two_sided, p.opaque);
        if (!artefacts.double_blend) glEnable(GL_CULL_FACE);
        buffers.draw(projection.one_sided);  // bodies: none has holes
        glDisable(GL_CULL_FACE);
      }
      std::vector<std::uint32_t> glass;
      std::ranges::set_intersection(casters, made_->glass, std::back_inserter(glass));
      if (!glass.empty()) {
        p.draw_glass(buffers, glass);
        if (!artefacts.double_blend) glDisable(GL_BLEND);
      }
      ++work.planes;
      work.casters += casters.size();
      for (const std::uint32_t m : casters) work.triangles += buffers.meshes[m].triangle_count;
    }
    return work;
  }

  /// Draws the picture again, with and without the artefacts, at the first call after a resolve.
  bool artefacts_differ(std::size_t pixel) const {
    if (!artefacts_.unclipped && !artefacts_.double_blend) return false;
    if (differs_.empty()) {
      VisibilityMask spoiled(gbuffer_->width, gbuffer_->height), exact(gbuffer_->width, gbuffer_->height);
      const auto draw = [&](VisibilityMask& mask, const Artefacts& artefacts) {
        const StateGuard guard;
        draw_shadows(mask.texture(), artefacts);
      };
      draw(spoiled, artefacts_);
      draw(exact, {});
      const std::span<const float> a = spoiled.read(), b = exact.read();
      const float enough = made_->scene->has_transmission() ? 1.0f / 20 : 0.5f;
      for (std::size_t i = 0; i < a.size(); ++i) differs_.push_back(std::abs(a[i] - b[i]) > enough);
    }
    return differs_[pixel] != 0;
  }

  struct Made {
    std::array<Program, 2> receivers_programs;  // that test whether a pixel faces the light: every one, or none
    ShadowPrograms shadow_programs, unclipped_programs;
    Framebuffer framebuffer;
    const Scene* scene = nullptr;
    PlaneLookup lookup;
    std::vector<Bounds> bounds;
    double extent = 0;  // largest coordinate of the scene
    double clip_tolerance = 0;
    std::vector<std::uint32_t> casters;
    std::vector<std::uint32_t> glass;  // of them
  };

  Shared<Made> made_;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  std::vector<Projection> projections_;
  bool planes_face_ = false;  // every plane that is lit at all faces the light with all of its receivers
  Artefacts artefacts_;
  Texture receivers_;  // planes as depths
  Work work_;
  mutable std::vector<std::uint8_t> differs_;  // of each pixel; made by the first `explain`
};

}  // namespace

GNOMON_TECHNIQUE(planar_projected, PlanarProjected, about)
