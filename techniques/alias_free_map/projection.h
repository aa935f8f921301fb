#pragma once
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace gnomon::alias_free_map {

/// What the light looks through: one plane for a directional light; the six faces of a cube around any other, turned so that
/// the cube's face 4 looks at the casters or along the cone of a spot. A point is seen as (x, y, z) with z along the axis of a
/// face, away from the light; its place on the face is (x, y), or (x / z, y / z) in a cube. Every face is a right-handed frame.
///
/// The computed axes are taken for what they are, some invertible linear map: they need not be exactly orthogonal for the sign
/// of a determinant to mean the same before and after. What counts is how exactly the map is applied. With e = 2^-53, a point's
/// difference to the origin rounds once, and each of its products with an axis takes 4 e of the point's length: the point that
/// is seen is off by less than 9 e of its distance.
class Projection {
 public:
  Projection() = default;
  Projection(const Light& light, const Bounds& casters) {
    const glm::dvec4 l = homogeneous(light);
    const glm::dvec3 center = casters.empty() ? glm::dvec3(0) : (glm::dvec3(casters.min) + glm::dvec3(casters.max)) / 2.0;
    is_parallel_ = l.w == 0;
    origin_ = is_parallel_ ? glm::vec3(center) : glm::vec3(l);
    glm::dvec3 away = is_parallel_ ? -glm::dvec3(l) : center - glm::dvec3(l);
    if (const auto* spot = std::get_if<SpotLight>(&light.kind)) away = spot->direction;
    const double length = glm::length(away);
    away = length > 0 ? away / length : glm::dvec3(0, -1, 0);
    const glm::dvec3 size = glm::abs(away);
    const int smallest = size.x <= size.y && size.x <= size.z ? 0 : size.y <= size.z ? 1 : 2;
    glm::dvec3 beside(0);
    beside[smallest] = 1;
    axes_[0] = glm::normalize(glm::cross(beside, away));
    axes_[1] = glm::cross(away, axes_[0]);
    axes_[2] = away;
    for (int face = 0; face < 6; ++face)
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 component = in_face(face, {axes_[0][k], axes_[1][k], axes_[2][k]});
        for (int row = 0; row < 3; ++row) face_axes_[face][row][k] = component[row];
      }
  }

  bool is_parallel() const { return is_parallel_; }
  int face_count() const { return is_parallel_ ? 1 : 6; }

  /// A direction, and a point, in the frame of the axes.
  glm::dvec3 turned(const glm::dvec3& d) const { return {glm::dot(axes_[0], d), glm::dot(axes_[1], d), glm::dot(axes_[2], d)}; }
  glm::dvec3 seen(const glm::vec3& p) const { return turned(glm::dvec3(p) - origin_); }
  /// The same in the frame of a face, bit for bit as `in_face` makes them of those.
  glm::dvec3 turned(int face, const glm::dvec3& d) const {
    const glm::dvec3* const axes = face_axes_[face];
    return {glm::dot(axes[0], d), glm::dot(axes[1], d), glm::dot(axes[2], d)};
  }
  glm::dvec3 seen(int face, const glm::vec3& p) const { return turned(face, glm::dvec3(p) - origin_); }

  /// The face that a point other than the light falls on; face 2 k looks along axis k, face 2 k + 1 against it.
  int face_of(const glm::dvec3& p) const {
    if (is_parallel_) return 0;
    const glm::dvec3 size = glm::abs(p);
    const int k = size.z >= size.x && size.z >= size.y ? 2 : size.x >= size.y ? 0 : 1;
    return 2 * k + (p[k] < 0);
  }
  glm::dvec3 in_face(int face, const glm::dvec3& p) const {
    if (is_parallel_) return p;
    const int k = face / 2, next = (k + 1) % 3, last = (k + 2) % 3;
    return face % 2 == 0 ? glm::dvec3(p[next], p[last], p[k]) : glm::dvec3(p[last], p[next], -p[k]);
  }
  /// Place on the face of a point in its frame.
  glm::dvec2 place(const glm::dvec3& p) const { return is_parallel_ ? glm::dvec2(p) : glm::dvec2(p) / p.z; }

 private:
  bool is_parallel_ = false;
  glm::dvec3 origin_{0}, axes_[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  glm::dvec3 face_axes_[6][3] = {};
};

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

/// Calls visit(face, footprint) for each face that the shadow of a triangle may touch; its corners are given in the frame of
/// the axes. `extent`: largest distance of anything in that frame.
template <class Visit>
void project(const Projection& projection, const glm::dvec3 (&corners)[3], double extent, std::uint32_t caster, Visit&& visit) {
  const auto emit = [&](int face, const glm::dvec3& low, const glm::dvec3& high, double margin) {
    visit(face, Footprint{static_cast<float>(low.x - margin), static_cast<float>(high.x + margin),
                          static_cast<float>(low.y - margin), static_cast<float>(high.y + margin),
                          static_cast<float>(low.z - place_margin * std::abs(low.z) - (projection.is_parallel() ? margin : 0)),
                          caster});
  };
  if (projection.is_parallel()) {
    const glm::dvec3 &a = corners[0], &b = corners[1], &c = corners[2];
    return emit(0, glm::min(a, glm::min(b, c)), glm::max(a, glm::max(b, c)), place_margin * extent);
  }
  // Most triangles lie clearly within one face.
  int only = projection.face_of(corners[0]);
  for (const glm::dvec3& corner : corners) {
    const glm::dvec3 p = projection.in_face(only, corner);
    if (!(std::max(std::abs(p.x), std::abs(p.y)) * face_margin < p.z)) only = -1;
    if (only < 0) break;
  }
  for (int face = only < 0 ? 0 : only; face <= (only < 0 ? 5 : only); ++face) {
    glm::dvec3 polygon[2][8];
    int count = 3;
    bool in_front = true;
    for (int k = 0; k < 3; ++k) {
      polygon[0][k] = projection.in_face(face, corners[k]);
      in_front &= polygon[0][k].z > 0x1p-10 * norm1(polygon[0][k]);
    }
    const glm::dvec3* shape = polygon[0];
    // The part of a triangle around the plane of the light that a slightly wider face sees. Where that comes so close to the
    // light that its place is lost in rounding, it may be anywhere. A point of the true part lies inside the wider face by
    // 2^-10 of its z, far more than a clip rounds.
    if (!in_front) {
      int from = 0;
      for (int side = 0; side < 4 && count > 0; ++side) {
        const int axis = side / 2;
        const double sign = side % 2 ? 1 : -1;
        const auto inside = [&](const glm::dvec3& p) { return face_margin * p.z + sign * p[axis]; };
        int kept = 0;
        for (int k = 0; k < count; ++k) {
          const glm::dvec3 &p = polygon[from][k], &q = polygon[from][(k + 1) % count];
          const double dp = inside(p), dq = inside(q);
          if (dp >= 0) polygon[1 - from][kept++] = p;
          if ((dp >= 0) != (dq >= 0)) polygon[1 - from][kept++] = p + dp / (dp - dq) * (q - p);
        }
        count = kept, from = 1 - from;
      }
      shape = polygon[from];
      if (count == 0) continue;
    }
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (int k = 0; k < count; ++k) {
      const glm::dvec3& p = shape[k];
      const glm::dvec3 place(p.x / p.z, p.y / p.z, p.z);
      low = glm::min(low, place), high = glm::max(high, place);
      if (!in_front && !(p.z > 0x1p-28 * extent)) {
        low = {-2, -2, 0}, high = {2, 2, 0};
        break;
      }
    }
    if (low.x > face_margin || high.x < -face_margin || low.y > face_margin || high.y < -face_margin) continue;
    emit(face, glm::max(low, glm::dvec3(-2, -2, 0)), glm::min(high, glm::dvec3(2, 2, INFINITY)), 2 * place_margin);
  }
}

}  // namespace gnomon::alias_free_map
