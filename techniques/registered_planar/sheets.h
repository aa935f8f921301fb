#pragma once
#include <gnomon/kit/gl/gl_planes.h>

#include <span>
#include <vector>

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

/// Projects casters into the textures of sheets, and looks pixels up in them: programs, and what is known of a scene.
class SheetPainter {
 public:
  void setup();
  void build(const Scene& scene, double min_share);
  LitSheets sheets_for(const Light& light, std::span<const glm::vec3> points, int resolution) const;
  /// These two leave state for a StateGuard.
  void draw_sums(const LitSheets& lit, std::span<const glm::vec3> points, Sums& sums) const;
  /// With texels shown, pixels on a sheet are 2 and more, see the shader.
  void look_up(const LitSheets& lit, const Sums& sums, const GBuffer& gbuffer, VisibilityMask& mask,
               bool shows_texels = false) const;

  const Scene& scene() const { return *scene_; }
  const PlaneLookup& lookup() const { return lookup_; }
  std::size_t bytes() const;

 private:
  Sheet sheet_of(std::uint32_t plane, double side, int resolution) const;
  /// Whether a point of the light is before a plane, as far as float32 can tell.
  bool is_before(const glm::dvec4& plane, const glm::vec3& point) const {
    return glm::dot(plane, glm::dvec4(point, 1)) > clip_tolerance_;
  }
  std::size_t points_before(const glm::dvec4& plane, std::span<const glm::vec3> points) const;
  void draw_points(const LitSheets& lit, const Sheet& sheet, std::span<const glm::vec3> points, Sums& sums) const;
  std::size_t draw_casters(const Sheet& sheet, const glm::vec3& point) const;

  Program add_program_, all_program_, look_up_program_;
  Framebuffer framebuffer_;
  const Scene* scene_ = nullptr;
  PlaneLookup lookup_;
  std::vector<Bounds> bounds_;                                 // of each mesh
  std::vector<std::pair<glm::dvec2, glm::dvec2>> rectangles_;  // around what lies on each plane, along its Across
  std::vector<std::uint32_t> casters_;
  double clip_tolerance_ = 0, extent_ = 0;
};

}  // namespace registered_planar
