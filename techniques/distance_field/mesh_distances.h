#pragma once
#include <gnomon/kit/geometry/box_tree.h>

#include <optional>
#include <vector>

namespace gnomon::distance_field {

/// The square of the distance from a point to a triangle, in double. One without area counts as its sides.
double square_to_triangle(const glm::dvec3& p, const Triangle& triangle);
/// To a box, given by its lower and upper corner; 0 inside.
double square_to_box(const glm::dvec3& p, const float* lower, const float* upper);

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
  /// Winding number of a closed mesh around a point: 0 outside, whatever the orientation of the mesh.
  int winding(const glm::dvec3& p) const;
  /// Calls visit(triangle) for all of them.
  template <class Visit>
  void each(const Visit& visit) const {
    for (const Triangle& triangle : triangles_) visit(triangle);
  }

 private:
  BoxTree tree_;
  std::vector<Triangle> triangles_;  ///< by place of the tree
};

}  // namespace gnomon::distance_field
