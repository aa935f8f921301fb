#pragma once
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/scene.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

namespace gnomon::alias_free_map {

/// The light's faces: one across parallel rays; or a cube whose own frame looks at the casters, or along the cone of a spot.
/// Every frame is right-handed. The computed axes are taken for what they are, some invertible linear map: they need not be
/// exactly orthogonal for the sign of a determinant to mean the same before and after. What counts is how exactly the map is
/// applied (kit/maps/light_space.h).
LightSpace space_of(const Light& light, const Bounds& casters);

/// A box of places on a face that holds all that a caster may shade there, and a z below that of every point in its shadow.
struct Footprint {
  float x0, x1, y0, y1, z0;
  std::uint32_t caster;
};

/// Margins of a footprint: the computed places of caster and samples are off by 2^-40, and float32 by 2^-24, of what they are
/// widened by here.
constexpr double place_margin = 0x1p-20;
/// How far beyond its border a face looks, as a factor of z: a sample this close to it may be on either face.
constexpr double face_margin = 1 + 0x1p-10;

inline double norm1(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

struct FaceFootprint {
  int face;
  Footprint footprint;
};
/// Finds the faces that the shadow of a triangle may touch, and returns how many. `extent`: largest distance of anything from
/// the light, or for parallel rays from the origin, as `norm1` has it.
int find_footprints(const LightSpace& space, const glm::vec3* corners, double extent, std::uint32_t caster,
                    FaceFootprint (&found)[6]);

}  // namespace gnomon::alias_free_map
