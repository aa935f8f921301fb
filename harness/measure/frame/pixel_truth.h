#pragma once
#include <gnomon/kit/rays/rays.h>

#include <atomic>

namespace gnomon {

/// Eye rays through the square of each pixel.
inline constexpr int pixel_rays = 64;
/// A pixel that keeps fewer of them is not tested by the truth over the pixel: its center does not show what the pixel shows.
inline constexpr std::uint8_t least_kept_rays = pixel_rays / 2;

/// The truth over the pixel, for every pixel that faces the light.
struct PixelShares {
  std::vector<float> mean;         ///< of what part of the light arrives at the points that are kept; 1 where none is
  std::vector<float> error;        ///< its standard error
  std::vector<float> half;         ///< by half of the rays alone: at every pixel as far from the mean as that is from the truth
  std::vector<std::uint8_t> kept;  ///< how many of the rays count; 0 where the pixel does not face the light
};

/// Under a light without area. Eye rays go through places of the pixel's square by eight scrambles of one sequence (Scramble,
/// the pixel's index for seed). A ray is kept whose first hit is on the mesh that the center shows, at most the width of a
/// pixel at the center's depth from the tangent plane there, and faces the light. A shadow ray goes from each hit by the recipe
/// of the reference (PointRays).
///
/// The eight scrambles are independent, so their spread is the standard error of the mean, as a ratio of sums. To its square
/// comes that of 1 / kept, what one ray more or less makes, for the scrambles may agree by chance. Same arguments, same answer.
/// `everything` holds all meshes under the truth of the G-buffer. `done` counts pixels as they are finished, for whoever shows
/// progress.
PixelShares trace_pixels(const Scene& scene, const RayScene& everything, const RayScene& casters, const GBuffer& gbuffer,
                         const Light& light, std::atomic<std::size_t>* done = nullptr);

}  // namespace gnomon
