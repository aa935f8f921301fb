#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/scene.h>

namespace gnomon {

// Signs without epsilon, for any finite float32 input. Three tiers, each exact or silent: a double determinant with a proven
// error bound; 128-bit integers, where the coordinates share a lattice; GMP integers for the rest.
//
// A homogeneous point is what `homogeneous` gives for a light: floats, widened; w = 1 is a point, w = 0 a direction.

/// How many signs the double filter could not decide, by the tier that did.
struct SignTally {
  std::uint64_t lattice = 0;  ///< 128-bit integers
  std::uint64_t big = 0;      ///< GMP
  SignTally& operator+=(const SignTally& other) { return add_up(*this, other, &SignTally::lattice, &SignTally::big); }
};

/// +1 when a, b, c are counter-clockwise seen from d, -1 when clockwise, 0 when all four are coplanar: the sign of
/// ((b - a) x (c - a)) . (d - a), for a direction of ((b - a) x (c - a)) . d. Every swap of two points flips it.
int orient3d_sign(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, SignTally* tally = nullptr);
int orient3d_sign(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::dvec4& d, SignTally* tally = nullptr);

/// Whether four points lie in a plane.
bool coplanar(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d);

/// Whether the three corners of another triangle lie in the plane of a triangle.
bool coplanar(const Triangle& triangle, const glm::vec3* other);

/// From a receiver's point to a homogeneous light: a segment, or a ray toward a directional light.
struct Segment {
  glm::vec3 point;
  glm::dvec4 light;
};

/// `degenerate`: through an edge or a vertex, exactly.
enum class Crossing { none, crosses, degenerate };

/// Whether the segment crosses the closed triangle strictly between its ends. A triangle whose plane contains the point or
/// the light is not crossed. Neither winding nor the order of the corners matters.
Crossing crosses(const Segment& segment, const Triangle& triangle, SignTally* tally = nullptr);

}  // namespace gnomon
