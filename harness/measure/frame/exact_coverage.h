#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/geometry/camera.h>

#include <vector>

namespace gnomon {

/// The truth over a pixel without rays, where one triangle fills it: the share of the pixel's square that a light without area
/// reaches. Shares no code with the ray tracer. Casters are the scene's triangles, opaque and without holes.
///
/// The light is hidden at points behind a caster's plane and within the planes through the light and its edges. An eye ray r
/// through the square meets the receiver's plane at X = E + r h / (n.r), with n its normal, h = n.(A - E) and A a point of it.
/// Where n.r < 0, a point lies on the positive side of a plane, q.X + d > 0, where (q.E + d) n.r + h q.r < 0. r is linear in
/// the place in the picture, and so each such plane cuts the square in a line: what a caster hides is a convex polygon, and the
/// share is the area that no caster's polygon covers. A caster in the plane of the receiver hides nothing of it.
class ExactCoverage {
 public:
  /// All must outlive it. The G-buffer is of mesh truth.
  ExactCoverage(const Scene& scene, const GBuffer& gbuffer, const Light& light);

  /// Whether the square of pixel i lies in the pixel's triangle, as the eye sees that, and in the cone of a spot light. The
  /// pixel must face the light. Whether anything hides a part of the square from the eye is not tested.
  bool is_within(std::size_t i) const;
  /// Of such a pixel. Takes time for each casting triangle of the scene.
  double share(std::size_t i) const;

 private:
  using Polygon = std::vector<glm::dvec2>;  ///< in the pixel's square, 0 .. 1 both ways
  struct Square;

  Square square(std::size_t i) const;
  const Scene& scene_;
  const GBuffer& gbuffer_;
  const Light& light_;
  Camera camera_{gbuffer_.view, gbuffer_.width, gbuffer_.height};
  glm::dvec4 l_;  ///< homogeneous, from the eye
};

}  // namespace gnomon
