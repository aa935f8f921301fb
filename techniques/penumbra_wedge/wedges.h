#pragma once
#include <gnomon/kit/geometry/beam.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/light.h>

#include <span>
#include <vector>

namespace gnomon::penumbra_wedge {

/// A convex body that holds a light with area: all that is within a radius of the hull of some corners. Of a rectangle its
/// corners, of a disc those of a polygon around it, of a sphere its center and radius.
struct LightHull {
  std::vector<glm::dvec3> corners;
  glm::dvec3 center{0};
  double radius = 0;
  Bounds box;  ///< around it, wider by what rounding may have cut off
};

LightHull hull_of(const Light& light);

/// The points that see an edge of the outline before the light, or a few more: behind up to four planes. The front and the back
/// plane go through the edge and touch the light, the left and the right one go through an end of it.
struct Wedge {
  std::uint32_t low, high;  ///< vertices of the adjacency
  std::int32_t count;       ///< as SilhouetteEdge::count
  std::uint32_t part;
  /// Inside is where dot(plane, (point, 1)) <= 0, with the slack of rounding in it. All zero: there is no such plane, since the
  /// edge's line meets the light or an end of it is too close.
  glm::dvec4 planes[4];

  bool holds(const glm::dvec3& point) const {
    bool is_outside = false;
    for (const glm::dvec4& plane : planes) is_outside |= glm::dot(glm::dvec3(plane), point) + plane.w > 0;
    return !is_outside;
  }
  /// Whether some of a box may be inside; never a false no.
  bool meets(const glm::dvec3& middle, const glm::dvec3& half) const {
    bool is_outside = false;
    for (const glm::dvec4& plane : planes) {
      const glm::dvec3 normal(plane);
      is_outside |= glm::dot(normal, middle) + plane.w > glm::dot(glm::abs(normal), half);
    }
    return !is_outside;
  }
};

/// The wedges of an outline, in a tree of their edges. Queries may run on many threads.
class Wedges {
 public:
  void make(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const LightHull& light, double scene_extent);
  std::span<const Wedge> all() const { return wedges_; }
  /// Wedges that some of the points may be in, whose way to the light is in the beam.
  void find(const Beam& beam, const Bounds& points, std::vector<std::uint32_t>& found) const;
  /// The same for a part of these points.
  void narrow(const Bounds& points, std::span<const std::uint32_t> wide, std::vector<std::uint32_t>& found) const;
  std::size_t bytes() const { return bytes_of(wedges_) + tree_.bytes(); }

 private:
  std::vector<Wedge> wedges_;  // in the order of the tree
  BoxTree tree_;
};

}  // namespace gnomon::penumbra_wedge
