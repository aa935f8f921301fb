#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/scene.h>

#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::viewer {

// How large a light with area is: drawn, dragged, set. Pure, like moves.h; pixels are of the picture.

/// A length of a light that a person may set.
struct LightLength {
  std::string_view name, words;  ///< as scenes spell it, and as the panel does
  double meters = 0;
};
/// half_u and half_v of a rectangle, the radius of a disc or sphere; none of lights without area.
std::vector<LightLength> light_lengths(const Light& light);
/// The light with that length; a rectangle keeps its directions. The very same light where there is no such length, or `check`
/// refuses it.
Light with_length(const Light& light, std::size_t which, double meters);

/// The outline in segments: the sides of a rectangle, a disc's rim, the rim of a sphere as the eye sees it (none from inside).
std::vector<std::pair<glm::dvec3, glm::dvec3>> light_outline(const Light& light, const glm::dvec3& eye);

/// A point of the outline that changes a length when it is dragged.
struct SizeHandle {
  glm::dvec3 place;
  std::size_t which = 0;  ///< of light_lengths
};
/// Two a length, on both sides of the center: the middles of a rectangle's sides; of a disc its points in the direction that is
/// to the right in the picture, as far as its plane has one; of a sphere the points to the right and left.
std::vector<SizeHandle> size_handles(const Camera& camera, const Light& light);
/// The light with handle `k` of `size_handles` dragged to the pixel: where the line from the center through it comes nearest to
/// the pixel's ray, a hundredth of the length at least. The very same light where they do not meet before the eye.
Light drag_size(const Camera& camera, const Light& light, std::size_t k, glm::dvec2 pixel);

}  // namespace gnomon::viewer
