#pragma once
#include <gnomon/kit/across.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace sphere_volume {
using namespace gnomon;

/// What stands for a circle of the outline: a polygon inside, of equal area, around it; `exact` decides at the pixel's point.
enum Fit { inscribed, equal_area, circumscribed, exact };

/// A point of a polygon that stands for a circle of radius 1: at `angle`, `radius` from the center.
struct Corner {
  double angle, radius;
};

/// Factor on the radius of a regular polygon of `count` sides.
inline double radius_factor(Fit fit, int count) {
  const double step = 2 * std::numbers::pi / count;
  return fit == inscribed ? 1 : fit == equal_area ? std::sqrt(step / std::sin(step)) : 1 / std::cos(step / 2);
}

inline std::vector<Corner> full_circle(Fit fit, int count) {
  std::vector<Corner> corners;
  const double radius = radius_factor(fit, count);
  for (int k = 0; k < count; ++k) corners.push_back({2 * std::numbers::pi * k / count, radius});
  return corners;
}

/// An arc of a circle that `count` sides go around (fewer here, none longer). Both ends stay on the circle, so that tangents
/// meet it there. The polygon around it touches the arc at its ends and between corners; for equal area the same corners are
/// drawn in to the radius k that makes the fan from the center as large as the sector:
///   (n - 1) k^2 sin s + 2 k sin(s / 2) = n s,  s the step, n the number of inner corners.
inline std::vector<Corner> arc(Fit fit, double from, double to, int count) {
  const int n = std::max(1, static_cast<int>(std::ceil(count * std::abs(to - from) / (2 * std::numbers::pi) - 1e-9)));
  const double step = (to - from) / n, s = std::abs(step), half = std::sin(s / 2);
  std::vector<Corner> corners{{from, 1}};
  if (fit == inscribed) {
    for (int k = 1; k < n; ++k) corners.push_back({from + k * step, 1});
  } else if (s > 0) {
    const double radius =
        fit == equal_area ? n * s / (half + std::sqrt(half * half + (n - 1) * n * s * std::sin(s))) : 1 / std::cos(s / 2);
    for (int k = 0; k < n; ++k) corners.push_back({from + (k + 0.5) * step, radius});
  }
  corners.push_back({to, 1});
  return corners;
}

/// Outline of a convex body as the light sees it, in double. From here on, points are counter-clockwise seen from the light.
struct Contour {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> away;  ///< where light that passes each point goes on; of a directional light all the same
  glm::dvec3 hub{0};             ///< of the light cap: a point inside the body
};

/// Where the tangents from the light touch a sphere, by the seed's names: P = `center`, and Q at the angle b is
/// P + cos b v + sin b u, clockwise seen from the light. A directional light's touch the great circle across it.
struct TangencyCircle {
  glm::dvec3 center, axis;  ///< unit, away from the light
  glm::dvec3 u, v;          ///< unit: the seed's have the length of the radius
  double to_center = INFINITY, radius, cos_alpha = 1, sin_alpha = 0;

  glm::dvec3 point(double angle, double factor = 1) const { return center + factor * radius * arm(angle); }
  glm::dvec3 arm(double angle) const { return std::cos(angle) * v + std::sin(angle) * u; }
};

/// The light must not be inside the sphere. r = R sqrt(LC^2 - R^2) / LC: the difference LC^2 - R^2 - PL^2 of squares cancels
/// for small far spheres. On the surface itself r = 0, and the tangents are all that cross the axis at a right angle.
inline TangencyCircle tangency_circle(const Sphere& sphere, const glm::dvec4& light) {
  TangencyCircle circle;
  const glm::dvec3 c = sphere.center, to_sphere = light.w * c - glm::dvec3(light);
  const double radius = sphere.radius, distance = glm::length(to_sphere);
  circle.axis = to_sphere / distance;
  circle.center = c, circle.radius = radius;
  if (light.w != 0) {
    const double lc = distance / light.w;
    circle.sin_alpha = std::min(1.0, radius / lc);
    circle.cos_alpha = std::sqrt(std::max(0.0, (lc - radius) * (lc + radius))) / lc;
    circle.to_center = lc * circle.cos_alpha * circle.cos_alpha;
    circle.radius = radius * circle.cos_alpha;
    circle.center = glm::dvec3(light) / light.w + circle.to_center * circle.axis;
  }
  // Perpendicular to the axis, without its smallest component.
  const glm::dvec3 d = to_sphere, a = glm::abs(d);
  const glm::dvec3 across = a.x <= a.y && a.x <= a.z ? glm::dvec3(0, -d.z, d.y)
                            : a.y <= a.z             ? glm::dvec3(-d.z, 0, d.x)
                                                     : glm::dvec3(-d.y, d.x, 0);
  circle.u = glm::normalize(across);
  circle.v = glm::normalize(glm::cross(across, d));
  return circle;
}

inline Contour contour_of(const Sphere& sphere, const glm::dvec4& light, Fit fit, int segments) {
  const TangencyCircle circle = tangency_circle(sphere, light);
  Contour contour{.points = {}, .away = {}, .hub = circle.center};
  for (const Corner& c : full_circle(fit, segments)) {
    contour.points.push_back(circle.point(-c.angle, c.radius));
    const glm::dvec3 tangent = circle.cos_alpha * circle.axis + c.radius * circle.sin_alpha * circle.arm(-c.angle);
    contour.away.push_back(light.w == 0 ? -glm::dvec3(light) : tangent);
  }
  return contour;
}

inline glm::dvec3 on_circle(const glm::dvec3& center, double radius, const Across& frame, const Corner& c) {
  return center + radius * c.radius * (std::cos(c.angle) * frame.u + std::sin(c.angle) * frame.v);
}

inline void add_away(Contour& contour, const glm::dvec4& light) {
  for (const glm::dvec3& p : contour.points) contour.away.push_back(light.w * p - glm::dvec3(light));
}

/// The light must not be inside the cone or on its lateral surface. A generator at angle b off the light's side faces the light
/// when h e cos b > r (h L_w - l), with l the light's height over the base and e its distance from the axis: base angle
/// acos(r / |B - C|), B where the line from the light through the peak cuts the base plane, but with no case for a light at or
/// above the peak's height. The base faces a light below it.
inline Contour contour_of(const Cone& cone, const glm::dvec4& light, Fit fit, int segments) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), base = cone.base;
  const double h = cone.height, r = cone.radius;
  const Across frame(axis);
  const glm::dvec3 to = glm::dvec3(light) - light.w * base;
  const double along = glm::dot(to, axis), x = glm::dot(to, frame.u), y = glm::dot(to, frame.v), across = std::hypot(x, y);
  const double limit = r * (light.w * h - along), reach = h * across;
  const bool base_faces = along < 0;
  Contour contour{.points = {}, .away = {}, .hub = base + h / 4 * axis};
  if (limit <= -reach || limit >= reach) {
    // The lateral surface alone, or the base alone: the outline is the base's circle, turned the one way or the other.
    for (const Corner& c : full_circle(fit, segments))
      contour.points.push_back(on_circle(base, r, frame, {base_faces ? -c.angle : c.angle, c.radius}));
  } else {
    const double side = std::atan2(y, x), half = std::acos(limit / reach), full = 2 * std::numbers::pi;
    contour.points.push_back(base + h * axis);
    // With the base lit, the lit part ends at the far arc, else at the near one.
    for (const Corner& c :
         base_faces ? arc(fit, side - half, side + half - full, segments) : arc(fit, side - half, side + half, segments))
      contour.points.push_back(on_circle(base, r, frame, c));
  }
  add_away(contour, light);
  return contour;
}

/// No points where the light sees the disc edge-on: it casts nothing then.
inline Contour contour_of(const Disc& disc, const glm::dvec4& light, Fit fit, int segments) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(disc.normal)), center = disc.center;
  const double height = glm::dot(normal, glm::dvec3(light) - light.w * center);
  const Across frame(normal);
  Contour contour{.points = {}, .away = {}, .hub = center};
  if (height == 0) return contour;
  for (const Corner& c : full_circle(fit, segments))
    contour.points.push_back(on_circle(center, disc.radius, frame, {height < 0 ? -c.angle : c.angle, c.radius}));
  add_away(contour, light);
  return contour;
}

inline Contour contour_of(const auto&, const glm::dvec4&, Fit, int) { return {}; }  // flat: its triangles cast

}  // namespace sphere_volume
