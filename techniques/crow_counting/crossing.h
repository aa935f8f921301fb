#pragma once
#include <gnomon/kit/exact.h>

namespace gnomon::crow_counting {

// Whether the way from a start to a point crosses a polygon of a shadow volume, by signs alone.
//
// The point is meant a vanishing step nearer to the light than it is. That puts it on the light's side of every triangle whose
// plane holds it, so that such a triangle, first of all the point's own, does not shade it; and it settles every way that goes
// through the line of a caster's edge, for side quad and light cap alike, as if it passed on the light's side. What no such
// step can settle is a point on the border of a volume itself, and a way that goes through a side quad's border elsewhere: the
// second is a matter of the start.

enum class Meeting {
  none,
  crosses,
  touches,  ///< the point lies on the side quad: its way to the light goes through the edge or one of its ends
  unclear,  ///< ask again from another start
};

/// Which way a side quad or a light cap is crossed at all follows from the side that the start is on: what crossing adds to the
/// number of volumes around. `side_of_from`: orient3d of (from, low, high, light), or of the triangle's corners and `from`.
inline int step_through_side(int side_of_from, int count) { return -side_of_from * count; }
inline int step_through_cap(int side_of_from, int facing) { return side_of_from * facing; }

/// The side quad of an edge a b: all points X whose way to the light meets the edge. The start must not lie on it.
///
/// With [U V W X] for orient3d, e and p for the start and the point, Cramer's rule gives, for the point X where the way meets
/// the plane of a, b and the light l,
///
///   ([p a b l] - [e a b l]) X = -[e p b l] a + [e p a l] b - [e p a b] l.
///
/// X lies behind the edge when a and b have positive shares and l a negative one. So, if p is on the positive side and e on the
/// negative one, the way crosses the quad when [e p b l] < 0, [e p a l] > 0 and [e p a b] > 0; on exchanged sides all signs
/// are turned. With the point nearer to the light, a zero of the last becomes the sign of [e l a b] = [e a b l]: no crossing.
inline Meeting meet_side(const glm::vec3& from, const glm::vec3& to, const glm::vec3& a, const glm::vec3& b,
                         const glm::dvec4& light) {
  const int of_from = orient3d_sign(from, a, b, light), of_to = orient3d_sign(to, a, b, light);
  if (of_from == 0) return of_to == 0 ? Meeting::unclear : Meeting::none;
  if (of_to == of_from) return Meeting::none;
  const int turn = -of_from;
  const int behind = turn * orient3d_sign(from, to, a, b);
  if (behind <= 0) return Meeting::none;
  const int beside_a = turn * orient3d_sign(from, to, a, light), beside_b = -turn * orient3d_sign(from, to, b, light);
  if (beside_a < 0 || beside_b < 0) return Meeting::none;
  if (of_to == 0) return Meeting::touches;
  return beside_a == 0 || beside_b == 0 ? Meeting::unclear : Meeting::crosses;
}

/// A triangle that the light sees: facing +1 counter-clockwise, -1 clockwise. The start must not lie on it.
///
/// A point on its plane moves to the light's side, which is `facing`; a way through the line of edge a b becomes one on the
/// side of [e l a b] = [e a b l].
inline Meeting meet_cap(const glm::vec3& from, const glm::vec3& to, const Triangle& triangle, const glm::dvec4& light,
                        int facing) {
  const glm::vec3* corners = triangle.points;
  const int of_from = orient3d_sign(corners[0], corners[1], corners[2], from);
  int of_to = orient3d_sign(corners[0], corners[1], corners[2], to);
  if (of_to == 0) of_to = facing;
  if (of_from == 0 || of_from == of_to) return Meeting::none;
  bool unclear = false;
  for (int k = 0; k < 3; ++k) {
    const glm::vec3 &a = corners[k], &b = corners[(k + 1) % 3];
    int inside = of_to * orient3d_sign(from, to, a, b);
    if (inside == 0) inside = of_to * orient3d_sign(from, a, b, light);
    if (inside < 0) return Meeting::none;
    unclear |= inside == 0;
  }
  return unclear ? Meeting::unclear : Meeting::crosses;
}

}  // namespace gnomon::crow_counting
