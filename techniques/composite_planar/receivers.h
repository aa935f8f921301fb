#pragma once
#include <gnomon/kit/planes.h>

#include <array>
#include <optional>

namespace composite_planar {
using namespace gnomon;

/// A receiver plane with the rectangle that what lies on it fills or lies in.
struct Receiver {
  glm::dvec4 plane{0};
  std::array<glm::dvec4, 4> sides;  ///< of the rectangle: half-spaces, dot(side, (p, 1)) >= 0 inside
  /// Unit normals of what lies on the plane are this near its own. It keeps apart what crosses the plane at a small angle.
  double turn = 0;
};

/// The planes on which shadows are answered. Curved shapes are none, whatever their triangles say.
struct ReceiverSet {
  std::vector<Receiver> planes;
  double tolerance = 0;      ///< points up to this far off a plane lie on it, meters
  double covered_share = 0;  ///< of the receiving area
};

ReceiverSet find_receivers(const Scene& scene, double min_share);

/// The receiver turned toward the light; nothing for a light in the plane, as far as float32 can tell.
std::optional<Receiver> facing(const Receiver& receiver, const glm::dvec4& light, double tolerance);

/// Whether some of the shape lies over the plane and below the light.
bool may_cast(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, double tolerance);

}  // namespace composite_planar
