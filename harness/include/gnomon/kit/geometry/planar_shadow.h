#pragma once
#include <gnomon/scene.h>

#include <array>

namespace gnomon {

// The shadow of one simple shape on one plane in closed form: its outline, and whether a point is in it. It requires no scene,
// no picture and no OpenGL.
//
//   const PlanarShadow shadow(Sphere{.center = {0, 3, 0}, .radius = 1}, {4, 9, 0, 1}, {0, 1, 0, 0});
//   shadow.contains({-4, 0, 0});
//   for (const std::vector<glm::dvec4>& loop : shadow.outlines(64)) draw(loop);
//
// Source: Pljaskovic et al., Sphere and cone composite realtime shadows; the exact forms are derived in docs/planar_shadow.md.
// Lights are homogeneous: (position, 1), or (-direction, 0) where direction is the way light travels. A plane is (unit normal,
// offset): dot(plane, (p, 1)) is the height of p over it; the normal must point to the light's side.

/// Whose formulas.
enum class ShadowForm {
  printed,  ///< equations 1 to 9 and the points of the text as printed
  paper,    ///< what they evidently mean: the base of a triangle moves with its shadow
  exact,    ///< conic sections, and tangents to them
};

/// A flat convex part of a shape, or of its image on the plane: a disc, or a polygon of three or four corners. The shape's
/// shadow is the union of the shadows of its parts.
struct FlatPart {
  int corner_count = 0;  ///< 0: a disc
  /// The corners in order; of a disc the center and two points of its rim, seen from the center at a right angle.
  std::array<glm::dvec3, 4> points;

  bool is_disc() const { return corner_count == 0; }
  double radius() const { return glm::distance(points[0], points[1]); }
};

/// Where the shadow of a flat part is: a set of signs. Of a point p let x = p - anchor and f(row) = dot(row.xyz, x) + row.w.
/// p is in the shadow when f(beyond) > 0 and
///   of a disc     f(rows[0])^2 + f(rows[1])^2 <= f(rows[2])^2 and f(rows[2]) > 0
///                 (ellipse, parabola and hyperbola alike: the second condition chooses the branch);
///   of a polygon  f(rows[i]) >= 0 for all four.
/// The test of an exact part is valid for every point outside the solid, on the plane or not; that of an image on the plane.
/// The anchor is near the part and exact in float32, so that float32 suffices to evaluate it.
struct ShadowTest {
  bool is_disc = false;
  glm::dvec3 anchor{0};
  glm::dvec4 beyond{0, 0, 0, 1};
  std::array<glm::dvec4, 4> rows;

  bool contains(const glm::dvec3& point) const;
};

class PlanarShadow {
 public:
  /// There must be no objection to it. Parts that the light sees edge-on cast nothing, and neither do those that lie in the
  /// plane or behind it, as far as float32 coordinates can tell: they are left out.
  PlanarShadow(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form = ShadowForm::exact);

  /// Why a form cannot tell this shadow; empty when it can. Exact: the light is inside the shape or on its surface. The others
  /// have formulas for discs parallel to the plane, spheres, upright cones and upright isosceles triangles (`paper`: any
  /// triangle), wholly on the light's side of the plane, and below the light.
  static std::string objection(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form);

  /// Whether a point of the plane, outside the shape, is in the shadow.
  bool contains(const glm::dvec3& point) const;

  /// Parts of the shape (exact) or of its image (other forms), three at most.
  std::span<const FlatPart> parts() const { return {parts_.data(), count_}; }
  /// The tests of the parts, in the same order.
  std::span<const ShadowTest> tests() const { return {tests_.data(), count_}; }

  /// Loops of homogeneous points in world space, convex, counter-clockwise seen from the light's side, w >= 0: what the light's
  /// horizon bounds ends in points with w = 0, at infinity. Circles get `segments` (3 or more) points. Exact: one loop, or
  /// none; other forms: a loop for each part, which overlap.
  std::vector<std::vector<glm::dvec4>> outlines(int segments) const;

 private:
  void add(const FlatPart& part, bool is_image);

  glm::dvec4 light_, plane_;
  ShadowForm form_;
  std::size_t count_ = 0;
  std::array<FlatPart, 3> parts_;
  std::array<ShadowTest, 3> tests_;
};

/// The way from the light through a point to the plane: homogeneous, w > 0 where the point is below the light as the plane sees
/// it, and then the point itself is xyz / w. w = 0: the image is at infinity; w < 0: the point casts no shadow (anti-shadow).
inline glm::dvec4 image_on_plane(const glm::dvec3& point, const glm::dvec4& light, const glm::dvec4& plane) {
  const double height = glm::dot(plane, glm::dvec4(point, 1)), light_height = glm::dot(plane, light);
  return light_height * glm::dvec4(point, 1) - height * light;
}

/// Keeps the points of a convex polygon where dot(half_space, (p, 1)) >= 0.
std::vector<glm::dvec3> clipped(std::span<const glm::dvec3> polygon, const glm::dvec4& half_space);

}  // namespace gnomon
