#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/geometry/exact.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace gnomon::shadow_volume_tree {

// Each caster brings four nodes into the tree: its shadow planes through the edges ab, bc, ca, then its capping plane. They are
// made, and queried, together.

/// One float for each node of a caster.
using Four = float __attribute__((vector_size(16)));
using FourFlags = std::int32_t __attribute__((vector_size(16)));

/// Bit k is flag k.
inline unsigned bits(FourFlags flags) {
#if defined(__SSE__)
  return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(flags)));
#else
  return (flags[0] & 1u) | (flags[1] & 2u) | (flags[2] & 4u) | (flags[3] & 8u);
#endif
}

/// A casting triangle, its corners counter-clockwise seen from the light once it is in the tree.
struct Caster {
  glm::vec3 points[3];
  std::uint32_t mesh;      ///< no_mesh where it has holes or transmission: it never makes another triangle needless
  std::uint32_t triangle;  ///< counted over the scene
  float steepness = 0;     ///< see Wedges; set with the order of the corners
};

/// Which way a caster or a point goes from the nodes of another one. A query on several ways pushes them in this order, and
/// follows the last one first.
enum Way : unsigned {
  crosses_plane = 0,  ///< + 2 k: the caster lies on both sides of shadow plane k
  outside_plane = 1,  ///< + 2 k: inside the planes before, and outside this one or on it
  crosses_cap = 6,    ///< inside all three, and on both sides of the capping plane
  behind_cap = 7,
  before_cap = 8,  ///< on the light's side of it or on it
  way_count = 9,
  no_way = 9  ///< the other one shades all that the caster shades
};

/// Signs that float32 left open.
struct SignCounts {
  std::uint64_t in_double = 0;  ///< of these, double decided all but `exact`
  SignTally exact;
  SignCounts& operator+=(const SignCounts& other) { return add_up(*this, other, &SignCounts::in_double, &SignCounts::exact); }
};

/// Square of the length of a triangle's longest edge.
inline double longest_edge_squared(const glm::vec3* corners) {
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 edge = glm::dvec3(corners[(k + 1) % 3]) - glm::dvec3(corners[k]);
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return longest;
}

/// The light, and the place around which float32 is used.
struct Frame {
  glm::dvec4 light{0};
  glm::vec3 center{0};
  float reach = 0;  ///< largest coordinate of a caster from the center
  glm::dvec3 along{0};
  double light_distance = 0;

  Frame() = default;
  Frame(const glm::dvec4& homogeneous_light, const Bounds& bounds) : light(homogeneous_light) {
    if (!bounds.empty()) center = 0.5f * bounds.min + 0.5f * bounds.max;
    for (const glm::vec3& p : {bounds.min - center, bounds.max - center})
      if (!bounds.empty()) reach = std::max(reach, largest(p));
    const glm::dvec3 l(light);
    if (light.w == 0) along = -l / glm::length(l);
    if (light.w != 0) light_distance = glm::length(to_light(light, center));
  }

  static float largest(const glm::vec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

  /// A point as its distance from the light, or for a directional light how far along its way, up to a constant: upper and
  /// lower bound.
  float farthest(const glm::vec3& p) const { return std::nextafter(static_cast<float>(depth(p) + slack(p)), INFINITY); }
  /// A caster's point X = i A + j B + k C, i + j + k = 1, at a point light L has
  ///   |X - L|^2 = i |A - L|^2 + j |B - L|^2 + k |C - L|^2 - (ij |A - B|^2 + jk |B - C|^2 + ki |C - A|^2),
  /// and ij + jk + ki <= 1/3: so it is at least the nearest corner's square less a third of the longest edge's.
  float nearest(const Caster& caster) const {
    const glm::vec3* p = caster.points;
    double least = INFINITY, error = 0;
    for (int k = 0; k < 3; ++k) {
      least = std::min(least, depth(p[k]));
      error = std::max(error, slack(p[k]));
    }
    if (light.w != 0) {
      const double distance = least + light_distance;
      least = std::sqrt(std::max(0.0, distance * distance * (1 - 0x1p-40) - longest_edge_squared(p) / 3)) - light_distance;
    }
    return std::nextafter(static_cast<float>(least - error), -INFINITY);
  }

  /// What makes a shadow plane's value the same all along a way from the light: one over the distance from a point light, 1 for
  /// a directional light. Of a point; for a caster an upper bound.
  float steepness(const glm::vec3& p) const {
    return light.w == 0 ? 1.0f : static_cast<float>(1 / glm::length(to_light(light, p)));
  }
  float steepness(const Caster& caster) const {
    if (light.w == 0) return 1;
    const double distance = nearest(caster) + light_distance * (1 - 0x1p-40);
    return distance > 0 ? std::nextafter(static_cast<float>(1 / distance), INFINITY) : INFINITY;
  }

 private:
  double depth(const glm::vec3& p) const {
    if (light.w == 0) return glm::dot(along, glm::dvec3(p) - glm::dvec3(center));
    return glm::length(to_light(light, p)) - light_distance;
  }
  /// Of what is rounded in double.
  double slack(const glm::vec3& p) const {
    const glm::dvec3 away = glm::abs(glm::dvec3(p) - glm::dvec3(center));
    return 0x1p-40 * (away.x + away.y + away.z + light_distance);
  }
};

/// Values of the four planes of a caster, scaled so that the normal's components sum to 1 without signs: at a point p from the
/// center, x p.x + y p.y + z p.z + offset, positive inside the shadow planes and on the light's side of the capping plane.
///
/// The error of a value, with e = 2^-24 and R the largest coordinate, from the center, of the point or a caster: rounding the
/// normal, the offset (at most R, as the plane goes through a caster) and the point to float32 costs e R each, the products and
/// sums at most 4 e each of the sum of all terms without signs, which is at most 2 R; the normal in double, see below, e R / 4.
/// Together less than 12 e R; what underflows is below 2^-100.
struct Planes {
  Four x{}, y{}, z{}, offset{};

  Planes() = default;
  /// A normal that loses more than 24 of 53 bits to cancellation is left at zero, and so are all values of that plane, so that
  /// no sign is taken from them. The others err by 4 * 2^-53 * 2^24 < e / 8 of their sum.
  Planes(const Caster& caster, const Frame& frame) {
    const glm::dvec3 a[] = {caster.points[0], caster.points[1], caster.points[2]};
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 from = a[k % 3];
      const glm::dvec3 u = k < 3 ? to_light(frame.light, from) : a[1] - from, v = (k < 3 ? a[(k + 1) % 3] : a[2]) - from;
      const glm::dvec3 normal = glm::cross(u, v), au = glm::abs(u), av = glm::abs(v);
      const double permanent = au.y * av.z + au.z * av.y + au.z * av.x + au.x * av.z + au.x * av.y + au.y * av.x;
      const double sum = std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z);
      if (!(sum > 0 && sum * 0x1p24 >= permanent)) continue;
      x[k] = static_cast<float>(normal.x / sum);
      y[k] = static_cast<float>(normal.y / sum);
      z[k] = static_cast<float>(normal.z / sum);
      offset[k] = static_cast<float>(-glm::dot(normal, from - glm::dvec3(frame.center)) / sum);
    }
  }

  Four at(const glm::vec3& p) const { return x * p.x + y * p.y + z * p.z + offset; }
  /// Values beyond it have the right sign.
  static float error(float reach) { return reach < 0x1p100f ? 0x1p-20f * reach + 0x1p-100f : INFINITY; }
};

/// Sign of a point at a node of a caster, exact.
inline int exact_sign(const Caster& caster, unsigned node, const glm::vec3& point, const Frame& frame, SignCounts& counts) {
  const glm::vec3* p = caster.points;
  ++counts.in_double;
  if (node == 3) return orient3d_sign(p[0], p[1], p[2], point, &counts.exact);
  return orient3d_sign(p[node], p[(node + 1) % 3], point, frame.light, &counts.exact);
}

/// How far to either side of a shadow plane the casters that cross it reach, as their values times their steepness: a point
/// farther from the plane is not in their shadow, if errors are finite. On the way from the light through a point X of a caster
/// the value grows as the distance from the light does; X's value is at most the largest of the corners', its distance at least
/// the caster's least.
struct Wedges {
  Four low = Four{} + INFINITY, high = Four{} - INFINITY;

  /// For a caster's values at a plane that it crosses: less than `error` above zero, and below.
  void add(unsigned plane, float lowest, float highest, float error, float steepness) {
    low[plane] = std::min(low[plane], (lowest - error) * steepness * (1 + 0x1p-20f));
    high[plane] = std::max(high[plane], (highest + error) * steepness * (1 + 0x1p-20f));
  }
  void add(const Wedges& other) {
    low = low < other.low ? low : other.low;
    high = high > other.high ? high : other.high;
  }
  /// Bit k: a point with these values may be in the shadow of a caster that crosses plane k.
  unsigned hold(Four values, float error, float steepness) const {
    const Four least = (values - error) * steepness, most = (values + error) * steepness;
    return bits((most >= low) & (least <= high));
  }
};

/// Which way `caster` goes from the nodes of `other`. Never the wrong one: what lies beyond a caster, seen from the light, is
/// on the same sides of a shadow plane as the caster, and only what is behind the capping plane is beyond what is behind it.
inline Way way_of(const Caster& caster, const Caster& other, const Planes& planes, const Frame& frame, float error,
                  Wedges& wedges, SignCounts& counts) {
  const Four a = planes.at(caster.points[0] - frame.center), b = planes.at(caster.points[1] - frame.center),
             c = planes.at(caster.points[2] - frame.center);
  const Four ab_low = a < b ? a : b, ab_high = a < b ? b : a;
  const Four low = ab_low < c ? ab_low : c, high = ab_high < c ? c : ab_high;
  const unsigned inside = bits(low > error), outside = bits(high < -error), crossing = bits((low < -error) & (high > error));
  for (unsigned left = ~inside & 15u; left != 0; left &= left - 1) {
    const auto k = static_cast<unsigned>(std::countr_zero(left));
    bool is_out = outside >> k & 1, is_crossing = crossing >> k & 1;
    if (!is_out && !is_crossing) {
      int lowest = 1, highest = -1;
      for (const glm::vec3& p : caster.points) {
        // A corner in common is the usual reason.
        const bool is_corner = p == other.points[k % 3] || p == other.points[(k + 1) % 3] || (k == 3 && p == other.points[2]);
        const int sign = is_corner ? 0 : exact_sign(other, k, p, frame, counts);
        lowest = std::min(lowest, sign);
        highest = std::max(highest, sign);
      }
      if (k == 3 && lowest == 0 && highest == 0)
        return caster.mesh == other.mesh && other.mesh != no_mesh ? no_way : before_cap;
      is_out = lowest < 0 && highest <= 0;
      is_crossing = lowest < 0 && highest > 0;
    }
    if (is_crossing) {
      wedges.add(k, low[k], high[k], error, caster.steepness);
      return static_cast<Way>(crosses_plane + 2 * k);
    }
    if (is_out) return k == 3 ? behind_cap : static_cast<Way>(outside_plane + 2 * k);
  }
  return before_cap;
}

}  // namespace gnomon::shadow_volume_tree
