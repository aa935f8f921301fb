#pragma once
#include <gnomon/gbuffer.h>

namespace gnomon {

/// The ways from the lit points of a picture to the light, as the light sees them: how far the farthest one reaches, in cells
/// of six faces around a light at a place, or of one plane across a directional one. What lies behind them all touches none.
class LitWays {
 public:
  /// `reach`: meters to all sides within which a way counts as touched.
  LitWays(const GBuffer& gbuffer, const glm::dvec4& light, std::span<const float> reference, double reach);

  /// Whether the segment from `a` to `b` may come within reach of a way. True more often than it does, never false where it
  /// does.
  bool may_touch(const glm::dvec3& a, const glm::dvec3& b) const;

 private:
  static constexpr int side = 512;  ///< cells of a face in a row

  int face_count() const { return light_.w != 0 ? 6 : 1; }
  /// x and y across the face as the light sees them, in -1 .. 1 within it, and the distance along its axis.
  glm::dvec3 seen(int face, const glm::dvec3& from_light) const;
  glm::dvec3 from_light(const glm::dvec3& point) const;
  bool may_touch(int face, glm::dvec3 a, glm::dvec3 b) const;

  glm::dvec4 light_;
  double reach_;
  glm::dvec3 axes_[3] = {};         ///< of a directional light: across it, and along it from the light on
  glm::dvec2 middle_{0}, half_{1};  ///< of what it lights, along the first two
  std::vector<float> farthest_;     ///< of each cell, face after face; minus infinity where no way is
};

}  // namespace gnomon
