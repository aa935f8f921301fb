#pragma once
#include <gnomon/kit/area/area_rays.h>

#include <atomic>

#include "measure/frame/classify.h"

namespace gnomon {

/// The answer that counts under a light with area, for every pixel; 1 and 0 errors where it does not face the light.
struct SoftReference {
  std::vector<float> area, irradiance;              ///< shares seen, see LightShares
  std::vector<float> area_error, irradiance_error;  ///< standard errors
  std::vector<float> area_half, irradiance_half;    ///< by half of their rays, see SampledShares
  std::vector<std::uint32_t> rays;                  ///< that the shares are made of, without the pilot
  /// Meters to the caster, the mean of a few ways to the light that are blocked or dimmed; 0 where the point sees all of the
  /// light or none.
  std::vector<float> caster_distance;
  std::vector<PixelClass> classes;
};

/// By rays to places of the light that are drawn anew for every pixel, as many as the target needs (sample_shares). A place
/// behind transmission is seen by the part of its light that passes. Same arguments, same answer. Classes are those of hard
/// shadows with these words for F, G and U:
///   F  nothing of the light is above the horizon, or the point is in its plane, or inside it
///   G  its highest place is less than 2 degrees above the horizon
///   U  the target is missed at the cap; or a share moves by more than 4 targets when the point moves by rho along a tangent,
///      when the light does, or when rays start at the point itself; or the scene is not resolved
/// `silhouettes` are as of classify. `done` counts pixels as they are finished, for whoever shows progress.
SoftReference trace_soft(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                         std::span<const std::uint8_t> silhouettes, const AreaTarget& target,
                         std::atomic<std::size_t>* done = nullptr);

}  // namespace gnomon
