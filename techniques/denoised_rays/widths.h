#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/denoise/filters.h>

#include <optional>

#include "pixel_rays.h"

namespace gnomon::denoised_rays {

/// How far each pixel is to be spread, by the width of the penumbra that the light and the mean distance of casters around it
/// make (Mehta et al. 2012).
class Widths {
 public:
  /// Spreads `rays.distance` and `rays.dark` in place. A pixel takes the mean distance of the dark rays of the smallest
  /// neighborhood that has enough of them, so that a contact keeps its own width beside a wide penumbra. Neighborhoods beyond
  /// the first are of 2x2 pixels together.
  void make(const FilterGuides& guides, const GBuffer& gbuffer, const Light& light, int rays_per_pixel, GuidedFilter& filter,
            RayPlanes& rays);
  /// Pixels, row-major; 0 where no dark ray is around, or none but dark ones.
  std::span<const float> sigma() const { return sigma_; }
  std::size_t bytes() const {
    return bytes_of(sigma_, strength_, found_, found_beside_, half_.dark, half_.distance, half_.strength) +
           half_.guides.bytes() + half_.filter.bytes();
  }

 private:
  /// In `strength_` 1 at pixels with both lit and dark rays within reach of the filters, elsewhere 0: what all rays around
  /// agree on no width changes.
  void find_edges(const GBuffer& gbuffer, const RayPlanes& rays);

  /// Planes of half the size both ways, spread like those of the pixels.
  struct Half {
    FilterGuides guides;
    GuidedFilter filter;
    UnsetVector<float> dark, distance, strength;

    /// Means of the pixels that join the one that guides.
    void make(const FilterGuides& fine, const RayPlanes& rays, std::span<const float> fine_strength);
    /// The place whose sums stand for a fine pixel's: its own, else one beside it; nothing where none joins it.
    std::optional<std::size_t> place_of(const FilterGuides& fine, int x, int y) const;
  };

  UnsetVector<float> sigma_, strength_;
  Half half_;
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
