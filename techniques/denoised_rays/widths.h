#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/denoise/filters.h>

#include "pixel_rays.h"

namespace gnomon::denoised_rays {

/// How far each pixel is to be spread, by the width of the penumbra that the light and the mean distance of casters around it
/// make (Mehta et al. 2012).
class Widths {
 public:
  /// Spreads `rays.distance` and `rays.dark` in place. A pixel takes the mean distance of the dark rays of the smallest
  /// neighborhood that has enough of them, so that a contact keeps its own width beside a wide penumbra.
  void make(const FilterGuides& guides, const GBuffer& gbuffer, const Light& light, int rays_per_pixel, GuidedFilter& filter,
            RayPlanes& rays);
  /// Pixels, row-major; 0 where no dark ray is around, or none but dark ones.
  std::span<const float> sigma() const { return sigma_; }
  std::size_t bytes() const { return bytes_of(sigma_, strength_, found_, found_beside_); }

 private:
  /// In `strength_` 1 at pixels with both lit and dark rays within reach of the filters, elsewhere 0: what all rays around
  /// agree on no width changes.
  void find_edges(const GBuffer& gbuffer, const RayPlanes& rays);

  UnsetVector<float> sigma_, strength_;
  UnsetVector<std::uint8_t> found_, found_beside_;  ///< of each tile, see find_edges
};

/// The width in pixels that leads to a sigma: the inverse of sigma_of_width.
double width_of_sigma(double sigma);

/// What the width of a penumbra depends on, of a light with area seen from a point: the distance of its center, and half of its
/// width across the way there, of a rectangle the mean of both directions (of equal area).
struct LampSize {
  double distance, half_width;
};
LampSize lamp_size(const Light& light, const glm::dvec3& point);

}  // namespace gnomon::denoised_rays
