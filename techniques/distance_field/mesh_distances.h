#pragma once
#include <gnomon/kit/geometry/box_tree.h>

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::distance_field {

/// The square of the distance from a point to a box, given by its lower and upper corner; 0 inside.
inline double square_to_box(const glm::dvec3& p, const float* lower, const float* upper) {
  const auto off = [&](int k) { return std::max(std::max(lower[k] - p[k], 0.0), p[k] - upper[k]); };
  const double x = off(0), y = off(1), z = off(2);
  return x * x + y * y + z * z;
}

/// A triangle made ready for distances in double. One without area, or higher by less than 1e-8 than long, counts as its sides.
class MeasuredTriangle {
 public:
  explicit MeasuredTriangle(const Triangle& triangle);
  const Triangle& corners() const { return corners_; }
  /// The square of the distance from a point; infinity where the triangle's plane is at `least` or farther, squared.
  double square_below(double least, const glm::dvec3& p) const;

 private:
  Triangle corners_;
  glm::dvec3 normal_{0};    ///< unit; 0: counts as its sides
  glm::dvec3 inverses_{0};  ///< of the squares of the sides' lengths; side k starts at corner k
};

/// The cut of a triangle by a plane of constant z, as places (x, y): from the side that rises through the plane to the side
/// that falls. A vertex in the plane counts as below it, and the place on a side depends on its ends alone, whichever of its
/// triangles is cut. So the cuts of a closed mesh are closed polygons, without gap or overlap.
struct Cut {
  glm::dvec2 from, to;
};
std::optional<Cut> cut_at(const Triangle& triangle, double z);

/// Where a cut meets the line of one y, and by how much the winding number of the places beyond it differs.
struct Passage {
  double x;
  int winding;
};
std::optional<Passage> passage_at(const Cut& cut, double y);

/// Distances to the triangles of one mesh by a tree over them, without a grid.
class MeshDistances {
 public:
  explicit MeshDistances(const Mesh& mesh);

  /// To the nearest triangle, meters; exact but for rounding of double. `near` is any place of the tree, best that of a
  /// triangle nearby, and becomes that of the nearest one.
  double to_nearest(const glm::dvec3& p, std::uint32_t& near) const;
  /// The places of the triangles that are nearest to points within `radius` of p, and of some more: false where these are more
  /// than `most`, and `places` then are of no use. `near` as above.
  bool find_near(const glm::dvec3& p, double radius, std::size_t most, std::vector<std::uint32_t>& places,
                 std::uint32_t& near) const;
  /// To the nearest of the triangles at these places.
  double to_nearest_of(std::span<const std::uint32_t> places, const glm::dvec3& p) const;
  /// Winding number of a closed mesh around a point: 0 outside, whatever the orientation of the mesh.
  int winding(const glm::dvec3& p) const;
  /// Calls visit(triangle) for all of them.
  template <class Visit>
  void each(const Visit& visit) const {
    for (const MeasuredTriangle& triangle : triangles_) visit(triangle.corners());
  }

 private:
  BoxTree tree_;
  std::vector<MeasuredTriangle> triangles_;  ///< by place of the tree
};

}  // namespace gnomon::distance_field
