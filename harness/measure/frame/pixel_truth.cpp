#include "measure/frame/pixel_truth.h"

#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/parallel.h>

#include <bit>
#include <cmath>

#include "measure/frame/point_rays.h"

namespace gnomon {

namespace {

/// What the rays of each scramble found: how many are kept, and the sum of what arrives.
struct ScrambleSums {
  std::array<double, ray_replicas> kept{}, arrives{};
};

struct PixelShare {
  double mean = 1, error = 0, half = 1;
  int kept = 0;
};

PixelShare share_of(const ScrambleSums& sums) {
  constexpr int replicas = ray_replicas, half_count = replicas / 2;
  double kept = 0, arrives = 0, half_kept = 0, half_arrives = 0;
  for (int k = 0; k < replicas; ++k) {
    kept += sums.kept[k];
    arrives += sums.arrives[k];
    if (k >= half_count) continue;
    half_kept += sums.kept[k];
    half_arrives += sums.arrives[k];
  }
  if (kept == 0) return {};
  PixelShare share{.mean = arrives / kept, .kept = static_cast<int>(kept)};
  share.half = half_kept > 0 ? half_arrives / half_kept : share.mean;
  // Of a ratio of sums, to first order: what each scramble has more than its part (Cochran 1977).
  double squares = 0;
  for (int k = 0; k < replicas; ++k) {
    const double more = sums.arrives[k] - share.mean * sums.kept[k];
    squares += more * more;
  }
  const double spread = squares * replicas / (replicas - 1);
  share.error = std::sqrt(spread + 1) / kept;
  return share;
}

/// The rays of the pixels of one picture.
struct PixelRays {
  const Scene& scene;
  const RayScene& everything;
  const GBuffer& gbuffer;
  PointRays shadow_rays;
  Camera camera{gbuffer.view, gbuffer.width, gbuffer.height};

  PixelShare trace(std::size_t i, std::span<Crossings, ray_lanes> crossings) const {
    const double x = static_cast<double>(i % gbuffer.width), y = static_cast<double>(i / gbuffer.width);
    const glm::dvec3 center = gbuffer.position(i), normal = gbuffer.normal(i);
    const double width = 2 * camera.tan_y * glm::dot(center - camera.eye, camera.forward) / camera.height;
    const Scramble scramble(i);
    std::array<SurfacePoint, ray_lanes> points;
    ScrambleSums sums;
    for (std::uint32_t round = 0; round < pixel_rays / ray_lanes; ++round) {
      const Squares squares = scramble.of_each(round);
      for (std::size_t k = 0; k < points.size(); ++k) {
        points[k] = surface_through(scene, everything, camera, gbuffer.truth, x + squares.x[k], y + squares.y[k]);
        const bool is_near = std::abs(glm::dot(normal, glm::dvec3(points[k].position) - center)) <= width;
        if (points[k].mesh != gbuffer.mesh[i] || !is_near) points[k].mesh = no_mesh;
      }
      const PointRays::Shares found = shadow_rays.ask(points, crossings);
      for (std::uint32_t left = found.faces; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        sums.kept[k % ray_replicas] += 1;
        sums.arrives[k % ray_replicas] += found.share[k];
      }
    }
    return share_of(sums);
  }
};

}  // namespace

PixelShares trace_pixels(const Scene& scene, const RayScene& everything, const RayScene& casters, const GBuffer& gbuffer,
                         const Light& light, std::atomic<std::size_t>* done) {
  const std::size_t size = gbuffer.size();
  PixelShares result{.mean = std::vector(size, 1.0f),
                     .error = std::vector(size, 0.0f),
                     .half = std::vector(size, 1.0f),
                     .kept = std::vector<std::uint8_t>(size)};
  const PixelRays rays{scene, everything, gbuffer, {scene, casters, light}};
  for_blocks(size, 64, [&](std::size_t begin, std::size_t end) {
    std::array<Crossings, ray_lanes> crossings;
    for (std::size_t i = begin; i < end; ++i) {
      if (!faces_light(scene, gbuffer, light, i)) continue;
      const PixelShare share = rays.trace(i, crossings);
      result.mean[i] = static_cast<float>(share.mean);
      result.error[i] = static_cast<float>(share.error);
      result.half[i] = static_cast<float>(share.half);
      result.kept[i] = static_cast<std::uint8_t>(share.kept);
    }
    if (done) *done += end - begin;
  });
  return result;
}

}  // namespace gnomon
