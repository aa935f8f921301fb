#pragma once
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/plane_projection.h>
#include <gnomon/kit/gl/gl_planes.h>
#include <gnomon/kit/gl/projected_shadows.h>

#include <algorithm>
#include <span>
#include <vector>

#include "shaders.h"

namespace registered_planar {
using namespace gnomon;

/// One side of a receiver plane, and where its texture lies: a rectangle around what lies on the plane.
struct Sheet {
  glm::dvec4 plane;         ///< turned to that side
  std::uint32_t index;      ///< of the plane
  glm::dvec3 corner, x, y;  ///< of its first texel; along the sides, meters
};

/// The sides of receiver planes that some of a light's points are before.
struct LitSheets {
  Light light;
  std::vector<Sheet> sheets;
  int resolution = 0;  ///< texels of a texture's side
  Buffer planes;       ///< for the look-up: which sheets each plane has
};

/// What is hidden of some points of the light, a layer for each sheet: red; of a sphere in green what all of them count.
struct Sums {
  Texture texture;
  Buffer sheets;              ///< for the look-up
  std::size_t triangles = 0;  ///< that were drawn for it
  std::size_t bytes() const { return texture.bytes + sheets.bytes; }
};

/// Triangles that may wait to be drawn. A software driver sets up those of all points before it draws the first, and keeps the
/// room that this takes: 40 MiB where 64 points draw 12,800 each.
inline constexpr std::size_t most_waiting = 1 << 16;

/// Projects casters into the textures of sheets, and looks pixels up in them: programs, and what is made of a scene.
class SheetPainter {
 public:
  void setup() {
    add_programs_ = CasterPrograms("registered_planar casters", projection_vertex, add_fragment);
    shadow_programs_ = ShadowPrograms("registered_planar shadow", projection_vertex);
    add_shares_program_ = Program("registered_planar shares", full_screen_vertex, add_shares_fragment);
    all_program_ = Program("registered_planar weights", full_screen_vertex, add_fragment);
    look_up_program_ = pass_program("registered_planar look-up", look_up_constants, look_up_fragment);
    framebuffer_ = make_framebuffer();
  }
  void build(const Scene& scene, double min_share) {
    scene_ = &scene;
    scene_buffers(scene);
    add_programs_.fit(scene);
    shadow_programs_.fit(scene);
    lookup_.build(scene, min_share);
    extent_ = scene.bounds().extent();
    bounds_.clear();
    casters_.clear();
    has_glass_ = scene.has_transmission();
    const ReceiverPlanes& on = lookup_.planes();
    rectangles_.assign(on.planes.size(), {glm::dvec2(INFINITY), glm::dvec2(-INFINITY)});
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      if (scene.meshes[m].casts) casters_.push_back(static_cast<std::uint32_t>(m));
      bounds_.emplace_back().add(scene.meshes[m].positions);
      for (std::size_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
        const std::uint32_t plane = on.plane_of[on.first_triangle[m] + t];
        if (plane == no_plane) continue;
        const auto [u, v] = Across(glm::dvec3(on.planes[plane].plane));
        auto& [low, high] = rectangles_[plane];
        for (const glm::dvec3 corner : scene.meshes[m].corners(t).points) {
          const glm::dvec2 at(glm::dot(u, corner), glm::dot(v, corner));
          low = glm::min(low, at);
          high = glm::max(high, at);
        }
      }
    }
    clip_tolerance_ = on.tolerance + height_rounding(scene);
  }
  LitSheets sheets_for(const Light& light, std::span<const glm::vec3> points, int resolution) const {
    LitSheets lit{light, {}, resolution, {}};
    std::vector<PlaneData> planes;
    for (std::uint32_t i = 0; i < lookup_.planes().planes.size(); ++i) {
      const glm::dvec4 plane = lookup_.planes().planes[i].plane;
      PlaneData& data = planes.emplace_back(PlaneData{glm::vec4(plane), glm::uvec4(no_plane)});
      for (const int side : {0, 1}) {
        const double sign = side == 0 ? 1 : -1;
        if (points_before(sign * plane, points) == 0) continue;
        data.sheets[side] = static_cast<std::uint32_t>(lit.sheets.size());
        lit.sheets.push_back(sheet_of(i, sign, resolution));
      }
    }
    lit.planes = Buffer(planes.data(), planes.size() * sizeof(PlaneData));
    return lit;
  }
  /// These two leave state for a StateGuard.
  void draw_sums(const LitSheets& lit, std::span<const glm::vec3> points, Sums& sums) const {
    const bool sphere = has_far_side(lit.light);
    const int side = lit.resolution;
    sums.texture.fit(sphere ? GL_RG32F : GL_R32F, side, side, std::max(1, static_cast<int>(lit.sheets.size())));
    sums.triangles = 0;
    const Texture depth(GL_DEPTH_COMPONENT32F, side, side);
    const Texture shares = has_glass_ ? Texture(GL_R32F, side, side) : Texture();
    const GLuint framebuffer = framebuffer_.name();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth.name(), 0);
    glViewport(0, 0, side, side);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glDepthFunc(GL_GREATER);
    std::vector<SheetData> data;
    for (std::size_t layer = 0; layer < lit.sheets.size(); ++layer) {
      const Sheet& sheet = lit.sheets[layer];
      glNamedFramebufferTextureLayer(framebuffer, GL_COLOR_ATTACHMENT0, sums.texture.name(), 0, static_cast<GLint>(layer));
      const float nothing[] = {0, 0, 0, 0};
      glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, nothing);
      glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, nothing);
      if (has_glass_)
        draw_points_with_glass(lit, sheet, points, shares, sums, layer);
      else
        draw_points(lit, sheet, points, sums);
      const float count = sphere ? 0.0f : static_cast<float>(points_before(sheet.plane, points));
      const double across = side / glm::dot(sheet.x, sheet.x), down = side / glm::dot(sheet.y, sheet.y);
      data.push_back({glm::vec4(sheet.corner, count), glm::vec4(across * sheet.x, 0), glm::vec4(down * sheet.y, 0)});
    }
    glDisable(GL_BLEND);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, 0, 0);
    sums.sheets = Buffer(data.data(), data.size() * sizeof(SheetData));
  }
  /// With texels shown, pixels on a sheet are 2 and more, see the shader.
  void look_up(const LitSheets& lit, const Sums& sums, const GBuffer& gbuffer, VisibilityMask& mask,
               bool shows_texels = false) const {
    const GBufferTextures& textures = gbuffer_textures(gbuffer, *scene_);
    glViewport(0, 0, gbuffer.width, gbuffer.height);
    begin_mask(framebuffer_, mask.texture(), textures);
    bind_gbuffer(textures);
    lookup_.bind(gbuffer.truth);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, lit.planes.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, sums.sheets.name());
    glBindTextureUnit(4, sums.texture.name());
    const LightShape shape(lit.light);
    glm::dvec4 front(0), round(0, 0, 0, -1);
    if (shape.is_one_sided) front = glm::dvec4(shape.front(), -glm::dot(shape.front(), shape.center));
    if (!shape.is_flat()) round = glm::dvec4(shape.center, shape.radius);
    const Program& p = look_up_program_;
    p.set("front", glm::vec4(front));
    p.set("round", glm::vec4(round));
    p.set("shows_texels", shows_texels ? 1.0f : 0.0f);
    glUseProgram(p.name());
    draw_receivers(textures);
  }

  const Scene& scene() const { return *scene_; }
  const PlaneLookup& lookup() const { return lookup_; }
  std::size_t bytes() const { return lookup_.bytes() + bytes_of(bounds_, rectangles_, casters_); }

 private:
  Sheet sheet_of(std::uint32_t plane, double side, int resolution) const {
    const glm::dvec4 on = lookup_.planes().planes[plane].plane;
    const auto [u, v] = Across(glm::dvec3(on));
    const auto [low, high] = rectangles_[plane];
    // A texel around, so that bilinear look-ups at the rim are between texels.
    const glm::dvec2 texel = glm::max(high - low, glm::dvec2(0x1p-20 * extent_)) / (resolution - 2.0), first = low - texel;
    return {.plane = side * on,
            .index = plane,
            .corner = first.x * u + first.y * v - on.w * glm::dvec3(on),
            .x = resolution * texel.x * u,
            .y = resolution * texel.y * v};
  }
  /// Whether a point of the light is before a plane, as far as float32 can tell.
  bool is_before(const glm::dvec4& plane, const glm::vec3& point) const {
    return glm::dot(plane, glm::dvec4(point, 1)) > clip_tolerance_;
  }
  std::size_t points_before(const glm::dvec4& plane, std::span<const glm::vec3> points) const {
    return static_cast<std::size_t>(std::ranges::count_if(points, [&](const glm::vec3& p) { return is_before(plane, p); }));
  }
  // A texel counts a point of the light once, however many triangles hide it: they are drawn at a depth of the point's own,
  // each point nearer than the one before, so that the first triangle leaves its depth and the others fail.
  void draw_points(const LitSheets& lit, const Sheet& sheet, std::span<const glm::vec3> points, Sums& sums) const {
    const bool sphere = has_far_side(lit.light);
    set_sheet(add_programs_, lit, sheet, {1, 0});
    set_sheet(all_program_, lit, sheet, {0, 1});
    std::size_t waiting = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (!is_before(sheet.plane, points[k])) continue;
      if (sphere) {
        all_program_.set("light_point", points[k]);
        glUseProgram(all_program_.name());
        draw_full_screen();
      }
      const double own_depth = static_cast<double>(k + 1) * 0x1p-13;
      const std::vector<std::uint32_t> casters = casters_before(sheet, points[k]);
      const std::size_t drawn = triangles_of(casters);
      sums.triangles += drawn;
      glEnable(GL_DEPTH_TEST);
      glEnable(GL_CLIP_DISTANCE0);
      glEnable(GL_CLIP_DISTANCE1);
      glDepthRange(own_depth, own_depth);
      if (!casters.empty()) {
        set_projection(add_programs_, sheet, points[k]);
        add_programs_.set("light_point", points[k]);
        scene_buffers(*scene_).draw(casters, add_programs_);
      }
      glDepthRange(0, 1);
      glDisable(GL_CLIP_DISTANCE1);
      glDisable(GL_CLIP_DISTANCE0);
      glDisable(GL_DEPTH_TEST);
      waiting += drawn;
      if (waiting < most_waiting) continue;
      glFinish();
      waiting = 0;
    }
  }
  // What casters let through of a point is multiplied in a picture of its own, and what they hide of it is added.
  void draw_points_with_glass(const LitSheets& lit, const Sheet& sheet, std::span<const glm::vec3> points,
                              const Texture& shares, Sums& sums, std::size_t layer) const {
    set_sheet(add_shares_program_, lit, sheet, {1, 1});
    shadow_programs_.opaque.set("darkened", 0.0f);
    const GLuint framebuffer = framebuffer_.name();
    const SceneBuffers& buffers = scene_buffers(*scene_);
    glBindTextureUnit(0, shares.name());
    for (const glm::vec3& point : points) {
      if (!is_before(sheet.plane, point)) continue;
      const std::vector<std::uint32_t> casters = casters_before(sheet, point);
      sums.triangles += triangles_of(casters);
      std::vector<std::uint32_t> opaque, glass;
      for (const std::uint32_t m : casters) (scene_->meshes[m].transmission ? glass : opaque).push_back(m);
      glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, shares.name(), 0);
      const float all[] = {1, 0, 0, 0};
      glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, all);
      glEnable(GL_CLIP_DISTANCE0);
      glEnable(GL_CLIP_DISTANCE1);
      set_projection(shadow_programs_, sheet, point);
      glDisable(GL_BLEND);
      buffers.draw(opaque, shadow_programs_.opaque);
      shadow_programs_.draw_glass(buffers, glass);
      glDisable(GL_CLIP_DISTANCE1);
      glDisable(GL_CLIP_DISTANCE0);
      glNamedFramebufferTextureLayer(framebuffer, GL_COLOR_ATTACHMENT0, sums.texture.name(), 0, static_cast<GLint>(layer));
      glBlendFunc(GL_ONE, GL_ONE);
      add_shares_program_.set("light_point", point);
      glUseProgram(add_shares_program_.name());
      draw_full_screen();
    }
  }
  /// What adding needs of a sheet; `adds` as add_fragment has it.
  static void set_sheet(const auto& program, const LitSheets& lit, const Sheet& sheet, const glm::vec2& adds) {
    const auto* const sphere = has_far_side(lit.light) ? std::get_if<SphereLight>(&lit.light.kind) : nullptr;
    program.set("corner", glm::vec3(sheet.corner));
    program.set("step_x", glm::vec3(sheet.x / double(lit.resolution)));
    program.set("step_y", glm::vec3(sheet.y / double(lit.resolution)));
    program.set("sphere", sphere ? glm::vec4(sphere->center, 1 / sphere->radius) : glm::vec4(0));
    program.set("adds", adds);
  }
  std::size_t triangles_of(const std::vector<std::uint32_t>& meshes) const {
    std::size_t triangles = 0;
    for (const std::uint32_t m : meshes) triangles += scene_->meshes[m].triangles.size();
    return triangles;
  }
  /// Those whose shadow from a point may fall on what lies on a sheet's plane.
  std::vector<std::uint32_t> casters_before(const Sheet& sheet, const glm::vec3& point) const {
    const glm::dvec4 light(glm::dvec3(point), 1);
    const PlaneProjection projection(sheet.plane, light);
    const double slack = std::max(4 * clip_tolerance_, 0x1p-20 * extent_);
    std::vector<std::uint32_t> casters;
    for (const std::uint32_t m : casters_) {
      const Bounds& box = bounds_[m];
      const glm::dvec3 highest =
          glm::mix(glm::dvec3(box.min), glm::dvec3(box.max), glm::greaterThan(glm::dvec3(sheet.plane), glm::dvec3(0)));
      if (glm::dot(sheet.plane, glm::dvec4(highest, 1)) <= clip_tolerance_) continue;
      if (projection.may_reach(box, lookup_.bounds()[sheet.index], slack)) casters.push_back(m);
    }
    return casters;
  }
  /// Of programs with projection_vertex.
  void set_projection(const auto& p, const Sheet& sheet, const glm::vec3& point) const {
    const PlaneProjection projection(sheet.plane, glm::dvec4(glm::dvec3(point), 1));
    // The place corner + s x + t y of the plane is at the shares s and t of the texture; in clip space y runs up.
    const auto row = [&](const glm::dvec3& along, double sign) {
      const glm::dvec3 per = 2.0 * sign * along / glm::dot(along, along);
      return glm::dvec4(per, -glm::dot(per, sheet.corner) - sign);
    };
    const glm::dmat4 texture_from_world =
        glm::transpose(glm::dmat4(row(sheet.x, 1), row(sheet.y, -1), glm::dvec4(0, 0, 0, 0.5), glm::dvec4(0, 0, 0, 1)));
    p.set("clip_from_world", glm::mat4(texture_from_world * projection.projected));
    p.set("plane", glm::vec4(sheet.plane));
    p.set("tolerance", static_cast<float>(clip_tolerance_));
    p.set("per_light_height", static_cast<float>(projection.per_light_height));
    // The share's own rounding error: casters that near to the light's height go to infinity anyway.
    p.set("least_share", static_cast<float>(0x1p-22 + clip_tolerance_ * projection.per_light_height));
  }

  CasterPrograms add_programs_;
  ShadowPrograms shadow_programs_;
  Program all_program_, add_shares_program_, look_up_program_;
  Framebuffer framebuffer_;
  const Scene* scene_ = nullptr;
  PlaneLookup lookup_;
  std::vector<Bounds> bounds_;                                 // of each mesh
  std::vector<std::pair<glm::dvec2, glm::dvec2>> rectangles_;  // around what lies on each plane, along its Across
  std::vector<std::uint32_t> casters_;
  bool has_glass_ = false;
  double clip_tolerance_ = 0, extent_ = 0;
};

}  // namespace registered_planar
