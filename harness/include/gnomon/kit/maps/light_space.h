#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

namespace gnomon {

// Light space: a scene as a light sees it.
//
// A light looks through faces: a directional light and a narrow spot through one, a point light through the six faces of a cube
// around it. A face is an orthonormal frame around an origin, in meters: x and y run across it, z along its axis, away from the
// light. The origin is the light itself; for parallel rays any point will do, and one in the middle of the scene keeps
// coordinates small.
//
// The place of a point on its face: (x, y) in meters where rays are parallel, the tangents (x / z, y / z) where they start at
// the light. Two points with one place lie on one ray, and the one with the larger z is farther from the light. A cube's face
// sees the pyramid |x| <= z, |y| <= z.
//
// Exactness, with e = 2^-53: a point's difference to the origin rounds once, and each of its products with an axis takes 4 e of
// the point's length, so a point in light space is off by less than 9 e of its distance. Along the axes of the world nothing
// but the difference rounds.

/// How a cube's faces that look against an axis differ from those that look along it, beside their z.
enum class OppositeFaces {
  mirrored,  ///< x and y are the same: a left-handed frame
  turned,    ///< y is reversed: right-handed
  swapped,   ///< x and y are exchanged: right-handed
};

/// From the own frame of a cube to that of one of its faces: components change their places and signs, nothing is rounded.
struct CubeTurn {
  int axis = 2;  ///< of the cube, along which the face looks, or against it
  bool is_against = false;
  OppositeFaces layout = OppositeFaces::mirrored;

  bool operator==(const CubeTurn&) const = default;
  int face() const { return 2 * axis + is_against; }
  glm::dvec3 operator()(const glm::dvec3& d) const {
    const glm::dvec3 p = axis == 0 ? glm::dvec3(d.y, d.z, d.x) : axis == 1 ? glm::dvec3(d.z, d.x, d.y) : d;
    if (!is_against) return p;
    if (layout == OppositeFaces::swapped) return {p.y, p.x, -p.z};
    return {p.x, layout == OppositeFaces::turned ? -p.y : p.y, -p.z};
  }
};

/// One face.
struct LightSpaceFace {
  glm::dvec3 origin{0};
  glm::dmat3 light_from_world{1};  ///< its rows are x, y, z
  bool is_perspective = true;
  bool is_along_world = false;  ///< `from_cube` says all of `light_from_world`, with less work
  CubeTurn from_cube{};         ///< from the own frame of its cube: bit for bit as `turned` has it

  bool operator==(const LightSpaceFace&) const = default;
  glm::dvec3 axis(int k) const { return {light_from_world[0][k], light_from_world[1][k], light_from_world[2][k]}; }
  /// A direction, and a point, of the world in the frame of the face.
  glm::dvec3 turned(const glm::dvec3& direction) const {
    return is_along_world ? from_cube(direction) : light_from_world * direction;
  }
  glm::dvec3 seen(const glm::dvec3& point) const { return turned(point - origin); }
  glm::dvec3 to_world(const glm::dvec3& q) const { return origin + q * light_from_world; }
  /// Of a point in the frame of the face; under perspective of one with z > 0.
  glm::dvec2 place(const glm::dvec3& q) const { return is_perspective ? glm::dvec2(q) / q.z : glm::dvec2(q); }
  glm::dvec2 place_of(const glm::dvec3& point) const { return place(seen(point)); }
};

/// The frame with these axes, as `LightSpaceFace` holds it.
inline glm::dmat3 frame_of(const glm::dvec3& x, const glm::dvec3& y, const glm::dvec3& z) {
  return glm::transpose(glm::dmat3(x, y, z));
}

/// All faces of a light. Of a cube's, face 2 k looks along axis k of its frame and face 2 k + 1 against it: +x -x +y -y +z -z.
/// Face 2 k has axis k + 1 for x and axis k + 2 for y (cyclically); so face 4 has the cube's own frame.
class LightSpace {
 public:
  LightSpace() = default;
  explicit LightSpace(const LightSpaceFace& only) : face_count_(1) { faces_[0] = only; }
  /// A cube around a light. A point exactly between faces falls on the one whose axis comes first, counted cyclically from
  /// `first_axis`: with 0 in the order x, y, z, with 2 in the order z, x, y; there is no order with 1.
  LightSpace(const glm::dvec3& light, const glm::dmat3& frame, OppositeFaces opposite, int first_axis)
      : face_count_(6), first_axis_(first_axis) {
    for (int face = 0; face < 6; ++face) {
      const CubeTurn turn{face / 2, face % 2 != 0, opposite};
      faces_[face] = {light, {turn(frame[0]), turn(frame[1]), turn(frame[2])}, true, frame == glm::dmat3(1), turn};
    }
  }

  bool operator==(const LightSpace&) const = default;
  int face_count() const { return face_count_; }
  const LightSpaceFace& operator[](int face) const { return faces_[face]; }
  /// The one face, or the one with the cube's own frame.
  const LightSpaceFace& main() const { return faces_[face_count_ == 6 ? 4 : 0]; }
  bool is_parallel() const { return !faces_[0].is_perspective; }

  /// The face that sees a point: of a cube the one along whose axis it is farthest from the light. A component that is zero
  /// counts as positive.
  int face_of(const glm::dvec3& point) const { return face_count_ < 6 ? 0 : turn_at(in_cube(point)).face(); }
  /// The same, and the point in the frame of that face.
  std::pair<int, glm::dvec3> seen(const glm::dvec3& point) const {
    if (face_count_ < 6) return {0, faces_[0].seen(point)};
    const glm::dvec3 q = in_cube(point);
    const CubeTurn turn = turn_at(q);
    return {turn.face(), turn(q)};
  }

  /// A point in the own frame of a cube, and the face that sees it there.
  glm::dvec3 in_cube(const glm::dvec3& point) const {
    return faces_[4].is_along_world ? point - faces_[4].origin : faces_[4].seen(point);
  }
  CubeTurn turn_at(const glm::dvec3& q) const {
    const double x = std::abs(q.x), y = std::abs(q.y), z = std::abs(q.z);
    const int k = first_axis_ == 0 ? (z > std::max(x, y) ? 2 : y > x ? 1 : 0) : (y > std::max(z, x) ? 1 : x > z ? 0 : 2);
    return {k, (k == 0 ? q.x : k == 1 ? q.y : q.z) < 0, faces_[4].from_cube.layout};
  }

 private:
  std::array<LightSpaceFace, 6> faces_{};
  int face_count_ = 0, first_axis_ = 0;
};

}  // namespace gnomon
