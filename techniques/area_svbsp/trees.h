#pragma once
#include "division.h"

namespace gnomon::area_svbsp {

/// One side of a receiving triangle, or the part of that on one side of a flat light's plane.
struct Side {
  std::uint32_t triangle;  ///< counted over the scene
  std::int8_t side;        ///< 1 where it runs counter-clockwise, -1
  std::int8_t light_side;  ///< of the plane of a flat light; of a solid one 0
};

/// The trees of a light: one for each side of a receiving triangle that is turned to the light. The inner sides of closed
/// meshes with the light outside have none, since no eye outside sees them.
class Trees {
 public:
  /// On all threads; the outcome does not depend on their number. What `lighting` names outlives the trees. `most_tests` bounds
  /// the work: it is shared out among the sides by how many volumes each meets.
  void grow(const Lighting& lighting, const Rules& rules, std::uint64_t most_tests);

  /// The tree of a side; null where it has none.
  const Tree* find(const Side& side) const;
  std::size_t count() const { return trees_.size(); }
  const Work& work() const { return work_; }
  std::size_t node_count() const;
  std::size_t bytes() const;

 private:
  std::vector<Side> sides_;
  std::vector<Tree> trees_;
  std::vector<std::uint32_t> first_of_;  // of each triangle's trees
  Work work_;
};

/// The polygons that may hide some of a light from a point, without those that never shade the receiver: for points that have
/// no tree.
void find_between(const Casters& casters, const Receiver& receiver, const LightFigure& figure,
                  std::vector<std::uint32_t>& found);

/// How many casting triangles lie before a light, at most, from a receiving point: the mean over 64 places that see it, spread
/// over the receiving triangles by area, on the side that sees it whatever the winding.
double casters_before(const Scene& scene, const Light& light);

/// The part of a triangle that lies on one side of a flat light's plane; all of it under a solid light.
std::vector<Corner> part_of(const Triangle& triangle, const LightBody& light, int light_side, double epsilon);

}  // namespace gnomon::area_svbsp
