#pragma once
#include <gnomon/kit/geometry/receiver.h>

#include "measure/frame/outline.h"

namespace gnomon {

/// Traces again with the point or the light moved by rho, sixteen pixels at a time, and exact signs where float32
/// cannot decide.
class MovedRays {
 public:
  MovedRays(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const glm::dvec4& light, double extent,
            std::span<const float> reference);

  /// Bit k: the answer of pixel indices[k], which the reference gives it, changes within rounding.
  std::uint32_t unstable(std::span<const std::size_t> indices) const;

 private:
  /// Up to sixteen pixels, and the light that the reference gives them; bit k is pixel k.
  struct Pixels;

  double rho() const { return 16 * 0x1p-24 * extent_; }
  bool is_on_shape(std::size_t i) const {
    return gbuffer_.truth == Truth::shape && scene_.meshes[gbuffer_.mesh[i]].has_curved_shape();
  }
  glm::dvec3 toward(std::size_t i) const { return glm::normalize(to_light(light_, gbuffer_.position(i))); }

  /// Returns the way to the light, or a direction toward it.
  glm::dvec3 aim(ShadowPacket& packet, int k, const Pixels& pixels, int shift) const;
  std::uint32_t unstable_from_the_point(const Pixels& pixels) const;
  ShadowPacket short_rays(const Pixels& pixels, const glm::dvec2& aside, double reach) const;
  std::uint32_t touching(const Pixels& pixels) const;
  std::uint32_t touching_beside(const Pixels& pixels, std::uint32_t lanes) const;
  bool is_in_plane_at_start(std::size_t i) const;
  bool is_shaded_on_the_way(std::size_t i) const;
  bool is_shaded_at_an_end(std::size_t i, bool is_touching, bool is_touching_beside) const;
  bool is_at_own_border(std::size_t i) const;
  bool is_at_hole_border(std::size_t i) const;
  bool is_clearly_inside(const Triangle& triangle, const glm::dvec3& point, const glm::dvec3& way) const;
  bool is_shaded_by_any(std::size_t i, std::span<const RayScene::Met> casters) const;

  const Scene& scene_;
  const RayScene& casters_;
  const GBuffer& gbuffer_;
  glm::dvec4 light_;
  double extent_;
  std::span<const float> reference_;
  Outline outline_{casters_, light_, rho() / 2, LitWays(gbuffer_, light_, reference_, 8 * rho())};
  std::vector<RayScene::Met> at_light_;  ///< the casters within rho of a light at a place, and perhaps a few more
};

}  // namespace gnomon
