#pragma once
#include <gnomon/kit/geometry/clip.h>

#include <optional>

#include "light_body.h"

namespace gnomon::area_svbsp {

/// Visible points are rounded to float32, and so off their triangle by up to 600 epsilon. Penumbra volumes are larger by more
/// than that on all sides, umbra volumes smaller, so that a point next to a fragment gets a right answer there, too.
inline constexpr double rounding = 1000;

/// The part of space in which a polygon that casts hides something of the light, the penumbra volume, and the part of that in
/// which it hides all of it, the umbra volume. Both are convex: what is on the positive side of all their planes.
struct Volume {
  std::uint32_t polygon;
  std::uint32_t first;  ///< plane: first those of the penumbra, then those of the umbra
  std::uint8_t penumbra_count, umbra_count;
  std::int8_t light_side;  ///< of the plane of a flat light, for receivers there; of a body 0
  bool is_whole;           ///< made of all of the polygon, with its own plane as the first: no flat light's plane cuts it
  bool is_turned_away;     ///< the light is on the side of the polygon where it runs clockwise
};

/// What is on the positive side of planes, or not.
enum class Relation { outside, across, inside };

/// How a convex polygon lies to what is inside all planes. Corners within epsilon of a plane may be on either side of it.
/// `crossing` becomes the number of planes that the polygon crosses.
Relation relation(std::span<const ClipPlane> planes, std::span<const Corner> polygon, double epsilon, int& crossing);

/// Makes planes of volumes. Where coordinates say too little about a plane it is left out of a penumbra volume, which grows by
/// that, and an umbra volume is left out whole: both stay on the safe side.
class PlaneMaker {
 public:
  /// `epsilon` in meters: what is as near to a plane counts as on it.
  PlaneMaker(const LightBody& light, double epsilon) : light_(light), epsilon_(epsilon), least_edge_(1e4 * epsilon) {}

  /// The planes of the penumbra volume of a polygon, or what of them can be told. `light` may be a part of the light.
  void add_penumbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const;
  /// The planes of its umbra volume, and whether there is one. Without the polygon's own plane.
  bool add_umbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const;
  /// Planes that have both a polygon and the light on their positive side: what is between the two is on that side, too.
  void add_shaft(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const;

 private:
  std::optional<ClipPlane> plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const;
  /// Turns a plane so that the polygon is on its positive side and the light on the side `light_sign`; says whether both are on
  /// one side of it.
  bool turn(ClipPlane& plane, std::span<const Corner> polygon, int light_sign) const;
  /// Planes through an edge of one and a corner of the other, one for each edge, that `turn` turns. Returns whether each edge
  /// of the polygon has one.
  bool add_of_edges(std::span<const Corner> polygon, int light_sign, std::vector<ClipPlane>& planes) const;
  /// The same with edges of the light; planes from `first` on are not said twice.
  void add_of_light_edges(std::span<const Corner> polygon, int light_sign, std::size_t first,
                          std::vector<ClipPlane>& planes) const;

  const LightBody& light_;
  double epsilon_, least_edge_;
};

/// Where a flat or solid body lies from a plane.
Lies lies_of(const LightBody& light, const ClipPlane& plane, double epsilon);

/// The plane of a polygon, unit, positive on the side where it runs counter-clockwise; nothing where its corners are too near
/// to a line to tell.
std::optional<ClipPlane> plane_of(std::span<const Corner> polygon);

}  // namespace gnomon::area_svbsp
