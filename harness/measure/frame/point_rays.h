#pragma once
#include <gnomon/kit/rays/gbuffer_maker.h>

namespace gnomon {

/// Shadow rays to a light without area from points that the eye sees anywhere in the picture, by the recipe of the reference.
class PointRays {
 public:
  /// All must outlive it.
  PointRays(const Scene& scene, const RayScene& casters, const Light& light)
      : scene_(scene), casters_(casters), light_(light) {}

  struct Shares {
    std::uint32_t faces = 0;  ///< bit k: point k has an answer
    std::array<float, ray_lanes> share{};
  };
  /// What part of the light arrives at up to sixteen points. A point without a surface has no answer, and neither has one that
  /// does not face the light, as faces_light says it of a pixel. `crossings` is memory, kept from one call to the next.
  Shares ask(std::span<const SurfacePoint> points, std::span<Crossings, ray_lanes> crossings) const;

 private:
  const Scene& scene_;
  const RayScene& casters_;
  const Light& light_;
  glm::dvec4 l_ = homogeneous(light_);
};

}  // namespace gnomon
