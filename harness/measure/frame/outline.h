#pragma once
#include <gnomon/kit/rays/rays.h>

#include "measure/frame/lit_ways.h"

namespace gnomon {

/// The outline that a light sees of the triangles of casters, as a band of `radius` meters to both sides and beyond both ends
/// of each edge, square to the light. A way to the light that passes an edge of the outline within the radius goes through its
/// band. Edges that no way of interest comes near have none.
class Outline {
 public:
  Outline(const RayScene& casters, const glm::dvec4& light, double radius, const LitWays& ways);
  Outline(const Outline&) = delete;
  Outline& operator=(const Outline&) = delete;

  /// Bit k: ray k, which must end at the light or go toward it, meets a band.
  std::uint32_t met(std::uint32_t valid, ShadowPacket& packet) const;

 private:
  Scene bands_;
  std::optional<RayScene> rays_;
};

}  // namespace gnomon
