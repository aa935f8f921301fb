#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

// From distances along a ray to a share of the light.
namespace gnomon::distance_field {

enum class Formula { disc, smoothstep, ratio };

/// The share of the light that is seen past one caster whose outline passes `s` radii of the light's cone beside the ray: -1
/// the cone is hidden, 1 it is free.
///   disc        what a straight line leaves of a disc
///   smoothstep  a cubic for it, off by at most 0.0394
///   ratio       s itself, and nothing of the light where the ray is within the caster: mean error 1/4 over -1 .. 1
inline double share_seen(Formula formula, double s) {
  switch (formula) {
    case Formula::disc:
      return 0.5 + (std::asin(s) + s * std::sqrt(1 - s * s)) / std::numbers::pi;
    case Formula::smoothstep:
      return (1 + s) * (1 + s) * (2 - s) / 4;
    case Formula::ratio:
      break;
  }
  return std::max(s, 0.0);
}

/// Where between two steps of a ray it comes nearest to a caster.
struct Approach {
  double distance;  ///< meters from the caster
  double along;     ///< meters from the start of the ray
};

/// A step of `before` meters, the distance where it began, led to `along`, where the distance is `now`, below 2^0.5 times that.
/// The circles of these radii meet between both ends, in one point at each side of the ray: all of the caster is as far from
/// the ray as they are, or farther. Exact for a caster that is a point.
inline Approach closest_approach(double before, double now, double along) {
  const double back = now * now / (2 * before);
  return {std::sqrt(std::max(now * now - back * back, 0.0)), along - back};
}

}  // namespace gnomon::distance_field
