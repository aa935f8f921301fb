#pragma once
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/light.h>
#include <gnomon/scene.h>

#include <array>
#include <cmath>
#include <optional>

namespace gnomon::area_svbsp {

/// A convex body with corners that contains all of a light with area: a rectangle itself, a polygon of eight corners around a
/// disc, an icosahedron around a sphere. Both answers of the body are on the safe side: a point that sees all of the body sees
/// all of the light, and one that sees none of the body sees none of the light.
struct LightBody {
  std::vector<Corner> corners;
  std::vector<std::array<std::uint32_t, 2>> edges;
  bool is_flat = false;       ///< corners and edges then run around a polygon
  bool is_one_sided = false;  ///< a flat one that sends light to the positive side of its plane only
  ClipPlane plane;            ///< of a flat one, unit, positive in front; zero where it has no area

  /// A flat body with these corners.
  void set_corners(std::span<const Corner> polygon);
  /// The plane of a flat body, positive in front for side 1 and behind for side -1.
  ClipPlane plane_toward(int side) const { return side > 0 ? plane : -plane; }
};

LightBody body_of(const Light& light);

/// The two halves of a flat body, across its longest edge.
std::array<LightBody, 2> halves(const LightBody& body);

inline std::array<Corner, 3> corners_of(const Triangle& triangle) {
  const auto& [a, b, c] = triangle.points;
  return {Corner{glm::dvec3(a)}, Corner{glm::dvec3(b)}, Corner{glm::dvec3(c)}};
}

/// The least and the greatest value of some corners at a plane.
struct Values {
  double low = INFINITY, high = -INFINITY;
};
inline Values values_of(std::span<const Corner> corners, const ClipPlane& plane) {
  Values values;
  for (const Corner& corner : corners) {
    const double value = plane.at(corner.at);
    values.low = std::min(values.low, value);
    values.high = std::max(values.high, value);
  }
  return values;
}

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

/// Makes planes of volumes. A plane that its coordinates do not determine is left out of a penumbra volume, which grows by
/// that; an umbra volume that lacks such a plane is left out whole: both stay on the safe side.
class PlaneMaker {
 public:
  /// `epsilon` in meters: what is as near to a plane counts as on it.
  PlaneMaker(const LightBody& light, double epsilon) : light_(light), epsilon_(epsilon), least_edge_(1e4 * epsilon) {}

  /// The planes of the penumbra volume of a polygon, as far as they can be determined. `light` may be a part of the light.
  void add_penumbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const { add_all(polygon, -1, planes); }
  /// The planes of its umbra volume, and whether there is one. Without the polygon's own plane.
  bool add_umbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const {
    return add_of_edges(polygon, 1, planes);
  }
  /// Planes that have both a polygon and the light on their positive side: what is between the two is on that side, too.
  void add_shaft(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const { add_all(polygon, 1, planes); }

 private:
  std::optional<ClipPlane> plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const;
  /// Turns a plane so that the polygon is on its positive side and the light on the side `light_sign`; says whether both are on
  /// one side of it.
  bool turn(ClipPlane& plane, std::span<const Corner> polygon, int light_sign) const;
  /// Planes through an edge of the polygon and a corner of the light, one for each edge, that `turn` turns. Returns whether
  /// each edge has one.
  bool add_of_edges(std::span<const Corner> polygon, int light_sign, std::vector<ClipPlane>& planes) const;
  /// These, and those through an edge of the light and a corner of the polygon; no plane twice.
  void add_all(std::span<const Corner> polygon, int light_sign, std::vector<ClipPlane>& planes) const;

  const LightBody& light_;
  double epsilon_, least_edge_;
};

/// Where a flat or solid body lies from a plane.
Lies lies_of(const LightBody& light, const ClipPlane& plane, double epsilon);

/// The plane of a polygon, unit, positive on the side where it runs counter-clockwise; nothing where its corners are too near
/// to a line to tell.
std::optional<ClipPlane> plane_of(std::span<const Corner> polygon);

}  // namespace gnomon::area_svbsp
