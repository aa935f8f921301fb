#pragma once
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/scene.h>

namespace gnomon::alias_free_map {

/// The light's faces: one across parallel rays; or a cube whose own frame looks at the casters, or along the cone of a spot.
/// Every frame is right-handed. The computed axes are taken for what they are, some invertible linear map: they need not be
/// exactly orthogonal for the sign of a determinant to mean the same before and after. What counts is how exactly the map is
/// applied (kit/maps/light_space.h).
inline LightSpace space_of(const Light& light, const Bounds& casters) {
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 center = casters.empty() ? glm::dvec3(0) : (glm::dvec3(casters.min) + glm::dvec3(casters.max)) / 2.0;
  const bool is_parallel = l.w == 0;
  glm::dvec3 away = is_parallel ? -glm::dvec3(l) : center - glm::dvec3(l);
  if (const auto* spot = std::get_if<SpotLight>(&light.kind)) away = spot->direction;
  const double length = glm::length(away);
  away = length > 0 ? away / length : glm::dvec3(0, -1, 0);
  const auto [u, v] = Across(away);
  const glm::dmat3 frame = frame_of(u, v, away);
  if (!is_parallel) return {glm::dvec3(l), frame, OppositeFaces::swapped, 2};
  return LightSpace(LightSpaceFace{glm::dvec3(glm::vec3(center)), frame, false});
}

/// A box of places on a face that contains all that a caster may shade there, and a z below that of every point in its shadow.
struct Footprint {
  float x0, x1, y0, y1, z0;
  std::uint32_t caster;
};
struct FaceFootprint {
  int face;
  Footprint footprint;
};

/// Margins of a footprint: the computed places of caster and samples are off by 2^-40, and float32 by 2^-24, of what they are
/// widened by here.
constexpr double place_margin = 0x1p-20;
/// How far beyond its border a face looks, as a factor of z: a sample this close to it may be on either face.
constexpr double face_margin = 1 + 0x1p-10;

inline double norm1(const glm::dvec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); }

/// Places on a face, and z.
struct PlaceBox {
  glm::dvec3 low{INFINITY}, high{-INFINITY};
  void add(const glm::dvec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
};

/// All places of a cube's face, and more.
constexpr PlaceBox anywhere{{-2, -2, 0}, {2, 2, 0}};

/// The place on a cube's face of a point in its frame, and its z.
inline glm::dvec3 projected(const glm::dvec3& p) { return {p.x / p.z, p.y / p.z, p.z}; }

inline Footprint footprint_of(const PlaceBox& box, double margin, double z_margin, std::uint32_t caster) {
  const glm::vec2 low(glm::dvec2(box.low) - margin), high(glm::dvec2(box.high) + margin);
  const double z0 = box.low.z - place_margin * std::abs(box.low.z) - z_margin;
  return {low.x, high.x, low.y, high.y, static_cast<float>(z0), caster};
}

/// Whether all corners, in its frame, lie clearly within a face of a cube.
inline bool is_within_face(const glm::dvec3 (&corners)[3]) {
  return std::ranges::all_of(corners,
                             [](const glm::dvec3& p) { return std::max(std::abs(p.x), std::abs(p.y)) * face_margin < p.z; });
}

/// Nearer to the light than this, of the extent, the place of a point that a clip makes is lost in rounding.
constexpr double lost = 0x1p-28;

/// Whether a triangle meets the cube around the light that is `near` to it on every side.
inline bool comes_near(const glm::dvec3 (&corners)[3], double near) {
  thread_local Clipper clipper;
  clipper.start();
  for (const glm::dvec3& p : corners) clipper.add({p});
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) {
      glm::dvec3 inward(0);
      inward[axis] = sign;
      if (clipper.keep_positive({inward, near}, 0) == Lies::negative) return false;
    }
  return true;
}

/// Places and z of what a cube's face, or a slightly wider one, sees of a triangle: a box around them; none if it sees nothing.
/// Where the triangle comes so close to the light that its place is lost in rounding, it may be anywhere. A point of the true
/// part lies inside the wider face by 2^-10 of its z, far more than a clip rounds.
inline bool find_box(const glm::dvec3 (&corners)[3], double extent, PlaceBox& box) {
  thread_local Clipper clipper;
  clipper.start();
  for (const glm::dvec3& p : corners) clipper.add({p});
  const bool is_in_front = std::ranges::all_of(corners, [](const glm::dvec3& p) { return p.z > 0x1p-10 * norm1(p); });
  if (!is_in_front)
    for (const glm::dvec3& side : {glm::dvec3(-1, 0, face_margin), glm::dvec3(1, 0, face_margin),
                                   glm::dvec3(0, -1, face_margin), glm::dvec3(0, 1, face_margin)})
      if (clipper.keep_positive({side, 0}, 0) == Lies::negative) return false;
  for (const Corner& corner : clipper.corners()) {
    if (!is_in_front && !(corner.at.z > lost * extent)) {
      box = anywhere;
      break;
    }
    box.add(projected(corner.at));
  }
  return box.low.x <= face_margin && box.high.x >= -face_margin && box.low.y <= face_margin && box.high.y >= -face_margin;
}

/// Finds the faces that the shadow of a triangle may touch, and returns how many. `extent`: largest distance of anything from
/// the light, or for parallel rays from the origin, measured by `norm1`.
inline int find_footprints(const LightSpace& space, const glm::vec3* corners, double extent, std::uint32_t caster,
                           FaceFootprint (&found)[6]) {
  const LightSpaceFace& own = space.main();
  const glm::dvec3 seen[3] = {own.seen(corners[0]), own.seen(corners[1]), own.seen(corners[2])};
  if (space.is_parallel()) {
    PlaceBox box;
    for (const glm::dvec3& p : seen) box.add(p);
    const double margin = place_margin * extent;
    found[0] = {0, footprint_of(box, margin, margin, caster)};
    return 1;
  }
  int count = 0;
  const auto add = [&](int face, const PlaceBox& box) {
    const PlaceBox near{glm::max(box.low, glm::dvec3(-2, -2, 0)), glm::min(box.high, glm::dvec3(2, 2, INFINITY))};
    found[count++] = {face, footprint_of(near, 2 * place_margin, 0, caster)};
  };
  const auto in_face = [&](int face, glm::dvec3(&turned)[3]) {
    for (int k = 0; k < 3; ++k) turned[k] = space[face].from_cube(seen[k]);
  };
  // Most triangles lie clearly within one face.
  glm::dvec3 turned[3];
  const int first = space.turn_at(seen[0]).face();
  in_face(first, turned);
  if (is_within_face(turned)) {
    PlaceBox box;
    for (const glm::dvec3& p : turned) box.add(projected(p));
    add(first, box);
    return count;
  }
  // Of a triangle that almost contains the light a clip may leave nothing on a face that it fills: its part there is too near.
  const bool is_too_near = comes_near(seen, 2 * lost * extent);
  for (int face = 0; face < 6; ++face) {
    PlaceBox box;
    in_face(face, turned);
    if (is_too_near || find_box(turned, extent, box)) add(face, is_too_near ? anywhere : box);
  }
  return count;
}

}  // namespace gnomon::alias_free_map
