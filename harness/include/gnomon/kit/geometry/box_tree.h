#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/exact.h>

#include <limits>

namespace gnomon {

/// Half of the area of a box's sides, square meters; 0 of an empty one.
double half_area(const Bounds& box);

/// A segment or ray made ready for box tests. The way to the light is rounded to double, the point is not.
struct SegmentSlabs {
  glm::dvec3 origin, inverse;  ///< 1 / (light - point); infinite where that is zero
  double end;                  ///< the light's parameter: 1, or infinity
  int upper[3];                ///< 1 where the segment runs down, so that it enters by the upper side

  explicit SegmentSlabs(const Segment& segment)
      : origin(segment.point),
        inverse(1.0 / to_light(segment.light, origin)),
        end(segment.light.w != 0 ? 1.0 : std::numeric_limits<double>::infinity()),
        upper{inverse.x < 0, inverse.y < 0, inverse.z < 0} {}

  /// Whether it meets a box, grown by `reach` on all sides; sometimes also where it passes by. `side` is the lower and the
  /// upper corner.
  bool meets(const float (&side)[2][3], double reach) const;
};

/// Why it never misses, with e = 2^-53. Let the segment truly meet the box, at parameters from `near` to `far`, both within
/// 0 .. end. Per axis, the distance to a side, the way to the light, its inverse and their product each round once, so a
/// computed parameter is the true one times at most four factors (1 + d), |d| <= e (differences of floats do not underflow,
/// and all values lie within 2^-278 .. 2^278). The larger and the smaller of such numbers, cut to 0 .. end, keep that
/// bound: computed near <= near (1 + 4.1 e) <= far (1 + 4.1 e) <= computed far (1 + 9 e), below the factor 1 + 16 e used
/// here. Along an axis without extent `inverse` is infinite, and a product is minus infinity where the point is on the inner
/// side, plus infinity on the outer one (the other way about for leaving), and not a number for a point on the side itself;
/// as the left operand of a comparison that is then false, it leaves near and far as they are.
inline bool SegmentSlabs::meets(const float (&side)[2][3], double reach) const {
  double near = 0, far = end;
  for (int k = 0; k < 3; ++k) {
    const double grow = upper[k] ? reach : -reach;
    const double enter = (side[upper[k]][k] + grow - origin[k]) * inverse[k];
    const double leave = (side[1 - upper[k]][k] - grow - origin[k]) * inverse[k];
    near = enter > near ? enter : near;
    far = leave < far ? leave : far;
  }
  return near <= far * (1 + 0x1p-49);
}

/// Boxes over boxes in one flat array, in depth-first order: a box that is missed is skipped together with all it holds, by one
/// index, so a query needs neither recursion nor stack. Queries only ever err by giving too many items.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const Bounds> items);

  /// order()[place] is the item at a place. Leaves hold consecutive places: who stores items in this order reads them in a row.
  std::span<const std::uint32_t> order() const { return order_; }

  /// Calls visit(place) for every item whose box, grown by `reach` on all sides, meets the segment (and for some more), until
  /// one returns true; says whether one did. `reach` may shrink on the way. With reach 0 no item is ever missed.
  template <class Visit>
  bool any(const SegmentSlabs& segment, const double& reach, Visit&& visit) const {
    return walk([&](const Node& node) { return segment.meets(node.side, reach); }, visit);
  }

  /// Calls visit(place) for every item in a box for which meets(lower corner, upper corner) holds, and in all boxes around it;
  /// until `visit` returns true.
  template <class Meets, class Visit>
  void each(const Meets& meets, const Visit& visit) const {
    walk([&](const Node& node) { return meets(node.side[0], node.side[1]); }, visit);
  }

  /// Items have moved: bounds_at(place) is where each is now. Their places stay; boxes are exact as at build, for they have
  /// coordinates of vertices.
  template <class BoundsAt>
  void refit(const BoundsAt& bounds_at);

  Bounds bounds() const { return nodes_.empty() ? Bounds() : nodes_[0].bounds(); }
  /// Sum of the half areas of the boxes, a leaf once more for each of its items. Over half the area of bounds() it is what a
  /// ray that meets them takes on the mean, in boxes and items (Goldsmith and Salmon 1987).
  double weighted_area() const;
  /// That ratio; 0 where bounds() have no area.
  double cost() const;

  std::size_t bytes() const { return bytes_of(nodes_, order_); }

 private:
  struct Node {
    float side[2][3];            ///< lower and upper corner; exact, since they are coordinates of vertices
    std::uint32_t skip;          ///< the node after this one's last descendant
    std::uint32_t first, count;  ///< places of a leaf; count 0 otherwise

    Bounds bounds() const { return {{side[0][0], side[0][1], side[0][2]}, {side[1][0], side[1][1], side[1][2]}}; }
    void set(const Bounds& box) {
      for (int k = 0; k < 3; ++k) {
        side[0][k] = box.min[k];
        side[1][k] = box.max[k];
      }
    }
  };
  struct Builder;

  /// Calls visit(place) for the items of the boxes for which is_met(node), until one returns true; says whether one did.
  template <class IsMet, class Visit>
  bool walk(const IsMet& is_met, Visit& visit) const {
    for (std::uint32_t i = 0; i < nodes_.size();) {
      const Node& node = nodes_[i];
      if (!is_met(node)) {
        i = node.skip;
        continue;
      }
      for (std::uint32_t place = node.first; place < node.first + node.count; ++place)
        if (visit(place)) return true;
      ++i;
    }
    return false;
  }

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;
};

template <class BoundsAt>
void BoxTree::refit(const BoundsAt& bounds_at) {
  // Children come after their parent: the one next to it, and the one that this one skips to.
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    Node& node = nodes_[i];
    Bounds box;
    if (node.count > 0) {
      for (std::uint32_t place = node.first; place < node.first + node.count; ++place) box.add(bounds_at(place));
    } else {
      box = nodes_[i + 1].bounds();
      box.add(nodes_[nodes_[i + 1].skip].bounds());
    }
    node.set(box);
  }
}

}  // namespace gnomon
