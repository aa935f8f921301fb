#pragma once
#include <gnomon/scene.h>

#include <algorithm>
#include <vector>

namespace planar_projected {

/// Casters projected onto one plane by one light.
struct Projection {
  std::uint32_t index;   ///< of the receiver plane
  glm::dvec4 plane;      ///< turned toward the light
  glm::dmat4 projected;  ///< M / (P.L)
  double per_light_height;
  /// Neither behind the plane nor behind the light, and whose shadow may fall on a receiver.
  std::vector<std::uint32_t> casters;
  /// Of these the closed ones that nothing clips, whose lit side casts all of their shadow, and the others.
  std::vector<std::uint32_t> one_sided, two_sided;

  /// Whether the shadow of what is in a box may reach receivers in another one: by the box around the images of its corners,
  /// which have none from the light's height on. `slack` meters are forgiven, and what float32 may be off where they lie.
  bool may_reach(const gnomon::Bounds& caster, const gnomon::Bounds& receivers, double slack) const {
    gnomon::Bounds image;
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
inline double farthest(const glm::dvec4& light, const gnomon::Bounds& box) {
  if (light.w == 0) return glm::length(glm::dvec3(light));
  const glm::dvec3 low = box.min, high = box.max;
  return glm::length(glm::max(glm::abs(glm::dvec3(light) - low), glm::abs(glm::dvec3(light) - high)));
}

}  // namespace planar_projected
