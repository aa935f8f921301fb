#pragma once
#include <gnomon/kit/rays/rays.h>

namespace gnomon {

/// Two unit vectors across a unit axis and across each other: the ways that a ray along the axis is moved aside. The classes of
/// pixels and the causes of errors depend on the choice, so it stays.
std::array<glm::dvec3, 2> across(const glm::dvec3& axis);

/// What brings a point that made this move away from a plane with normal `n` back onto the plane along the unit `ray`; zero
/// where the ray runs so flat along the plane (0.06 degrees) that it would go out of sight.
glm::dvec3 back_to_plane(const glm::dvec3& move, const glm::dvec3& ray, const glm::dvec3& n);

/// What is between points and one light, for the causes of errors. Rays follow the ray recipe, except that the nearest and the
/// farthest caster come from closest-hit rays. Texels that let all light through are no casters, but are among the surfaces
/// that a map may have drawn.
class LightRays {
 public:
  LightRays(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light);

  /// Unit, from `point` toward the light.
  glm::dvec3 toward_light(const glm::dvec3& point) const { return glm::normalize(to_light(light_, point)); }
  /// No caster is farther than this from `point`.
  double beyond_everything(const glm::dvec3& point) const;
  /// How far float32 may move a point of this picture: 16 * 2^-24 * extent, as in class U.
  double rounding() const { return rounding_; }

  struct CasterHit {
    std::uint32_t mesh = no_mesh;
    double distance = INFINITY;  ///< meters from the pixel's point
  };
  /// The caster of pixel i that is nearest to its point; no_mesh and infinity when there is none.
  CasterHit nearest(std::size_t i) const;
  /// Meters from the point of pixel i to its caster nearest to the light; infinity when there is none.
  double farthest(std::size_t i) const;

  /// A point on the tangent plane of pixel `pixel` whose ray to the light ignores hits closer than `ignored` meters.
  struct Start {
    std::size_t pixel;
    glm::dvec3 point;
    double ignored;
  };
  /// What part of the light arrives: 1 where nothing is on the way, 0 where something blocks.
  std::vector<float> shares(std::span<const Start> starts) const;

  /// Whether the triangles of the scene leave the way from `start` to the light free where its exact shapes block it. Only the
  /// triangles of shapes on the way are tested.
  bool triangles_let_through(const Start& start) const;

  /// Whether a move by `aside` meters and rounding to float32 decide what the way from `start` to the light meets: at an alpha
  /// mask both holes and solid texels are within reach of it, and nothing that is solid beyond doubt is on the way.
  bool is_at_hole_border(const Start& start, double aside) const;

  struct Surface {
    std::uint32_t mesh = no_mesh;
    double off = INFINITY;  ///< meters from the point along the line
    bool is_shape = false;  ///< an exact curved shape
  };
  /// The surface of a caster nearest to `point` on the line through it along the unit vector `direction`, both ways. The
  /// triangles of an exact shape may lie off the surface found.
  Surface surface_at(const glm::dvec3& point, const glm::dvec3& direction) const;

  /// The mesh with an alpha mask that the line through `point` along the unit vector `direction` meets nearest to it and within
  /// `reach` meters, in a hole, too; no_mesh where there is none.
  std::uint32_t masked_mesh_at(const glm::dvec3& point, const glm::dvec3& direction, double reach) const;

  /// The surface nearest to the light on the line from `point` along the unit vector `to_light`; meters from `point`, negative
  /// behind it, minus infinity when the line meets nothing.
  double farthest_along(const glm::dvec3& point, const glm::dvec3& to_light) const;

 private:
  using ClosestHit = RayScene::Hit (RayScene::*)(const glm::dvec3&, const glm::dvec3&) const;
  double to_farthest(const glm::dvec3& point, const glm::dvec3& to_light, ClosestHit closest) const;
  bool is_own(std::size_t i, const RayScene::Hit& hit, const glm::dvec3& direction) const;

  const Scene& scene_;
  const RayScene& casters_;
  const GBuffer& gbuffer_;
  glm::dvec4 light_;
  glm::dvec3 center_;
  double radius_, extent_, rounding_;
};

/// Mesh of the nearest caster of every pixel that faces the light and is dark in `reference`; no_mesh elsewhere. In a scene
/// with transmission dark is where full light would be wrong.
std::vector<std::uint32_t> find_nearest_casters(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer,
                                                const Light& light, std::span<const float> reference);

}  // namespace gnomon
