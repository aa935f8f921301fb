#pragma once
#include <gnomon/scene.h>

namespace gnomon {

/// What flattens casters onto a plane along the light's rays (Blinn 1988), in homogeneous form, so that point and directional
/// lights are one case: with the plane P = (n, d), n toward the light L, the matrix (P.L) I - L P^T. The image of a caster's
/// point p has w = P.L - (light's w) P.p: positive between the plane and the light, zero at the light's height.
struct PlaneProjection {
  glm::dvec4 plane{0};      ///< turned toward the light
  glm::dmat4 projected{1};  ///< that matrix over P.L: w is the share of the way from the light, 1 on the plane
  double per_light_height = 0;

  PlaneProjection() = default;
  /// The light's height over the plane must be above 0.
  PlaneProjection(const glm::dvec4& the_plane, const glm::dvec4& light)
      : plane(the_plane),
        projected(glm::dmat4(1) - glm::outerProduct(light, the_plane) / glm::dot(the_plane, light)),
        per_light_height(light.w / glm::dot(the_plane, light)) {}

  /// Whether the shadow of what is in a box may reach receivers in another one: by the box around the images of its corners,
  /// which have none from the light's height on. `slack` meters are forgiven, and what float32 may be off where they lie.
  bool may_reach(const Bounds& caster, const Bounds& receivers, double slack) const {
    Bounds image;
    for (int k = 0; k < 8; ++k) {
      const glm::dvec4 corner(k & 1 ? caster.max.x : caster.min.x, k & 2 ? caster.max.y : caster.min.y,
                              k & 4 ? caster.max.z : caster.min.z, 1);
      const glm::dvec4 at = projected * corner;
      if (!(at.w > 0x1p-20)) return true;
      image.add(glm::vec3(glm::dvec3(at) / at.w));
    }
    const auto off = static_cast<float>(slack + 0x1p-20 * image.extent());
    return glm::all(glm::lessThanEqual(image.min - off, receivers.max)) &&
           glm::all(glm::greaterThanEqual(image.max + off, receivers.min));
  }
};

/// An upper bound of the length of to_light from anywhere in a box: a plane over which the light's height is more than 2^-21 of
/// it faces the light also in float32 (see faces_light_snippet).
inline double farthest(const glm::dvec4& light, const Bounds& box) {
  if (light.w == 0) return glm::length(glm::dvec3(light));
  const glm::dvec3 low = box.min, high = box.max;
  return glm::length(glm::max(glm::abs(glm::dvec3(light) - low), glm::abs(glm::dvec3(light) - high)));
}

/// Vertex shader that draws casters flattened: `clip_from_world` holds the projection as well, `plane` is turned to the light.
/// What is below `tolerance` over the plane is clipped, and what is nearer to the light's height than `least_share` of the way.
extern const std::string projection_vertex;

}  // namespace gnomon
