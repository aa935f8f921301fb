#pragma once
#include <span>

#include "contour.h"

namespace sphere_volume {

/// A casting mesh with a curved shape.
struct Body {
  std::uint32_t mesh;
  Shape shape;
};

/// Radius of a ball about the middle that holds the body.
inline double reach(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* disc = std::get_if<Disc>(&shape)) return disc->radius;
  const auto& cone = std::get<Cone>(shape);
  return std::max(std::hypot(cone.radius, cone.height / 4.0), 0.75 * cone.height);
}

/// A point inside the body.
inline glm::dvec3 middle(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->center;
  if (const auto* disc = std::get_if<Disc>(&shape)) return disc->center;
  const auto& cone = std::get<Cone>(shape);
  return glm::dvec3(cone.base) + cone.height / 4.0 * glm::normalize(glm::dvec3(cone.axis));
}

/// Whether `point` lies on a cone or disc, to a millionth of their size: no outline is seen from there.
inline bool is_on_surface(const Shape& shape, const glm::dvec3& point) {
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const double height = cone->height, slack = 1e-6 * std::max<double>(height, cone->radius);
    const auto [along, off] = ConePlace(*cone, point);
    return along > -slack && along < height + slack && off < slack && (along < slack || off > -slack);
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const glm::dvec3 x = point - glm::dvec3(disc->center), normal = glm::normalize(glm::dvec3(disc->normal));
    const double slack = 1e-6 * disc->radius;
    return std::abs(glm::dot(x, normal)) < slack && glm::length(x) < disc->radius + slack;
  }
  return false;
}

/// How far the outlines of polygons may be off at `point`, meters across the light's ray: the largest over the bodies whose
/// shadow the point is in or beside.
inline double outline_error(std::span<const Body> bodies, const glm::dvec4& light, const glm::dvec3& point, Fit fit,
                            int segments) {
  const double outward = radius_factor(fit, segments) - 1;
  const double inward = 1 - radius_factor(fit, segments) * std::cos(std::numbers::pi / segments);
  const double share = std::max(outward, inward);
  const glm::dvec3 to = to_light(light, point), direction = glm::normalize(to);
  double error = 0;
  for (const Body& body : bodies) {
    const glm::dvec3 center = middle(body.shape), off = center - point;
    const double along = glm::dot(off, direction), aside = glm::length(off - along * direction), ball = reach(body.shape);
    if (along < -ball || aside > (1 + share) * ball * (1 + 1e-9)) continue;
    const double left = light.w != 0 ? glm::length(to_light(light, center)) : 1, whole = light.w != 0 ? glm::length(to) : 1;
    if (left > 0) error = std::max(error, share * ball * whole / left);
  }
  return error;
}

/// How much wider than the body a bounding volume is: the rasterizer may lose what is thinner than 1/256 pixel.
inline constexpr double bounding_margin = 0.02;

/// Sides around an outline that only has to find pixels.
inline constexpr int bounding_segments = 8;

/// Under a directional light: the contour, wider, on a plane before the body.
inline void widen_across(Contour& contour, const glm::dvec3& center, const glm::dvec3& axis, double nearest) {
  const double along = glm::dot(center, axis), start = nearest - bounding_margin * (along - nearest);
  const auto place = [&](const glm::dvec3& p, double grow) {
    const glm::dvec3 off = p - center;
    return center + (off - glm::dot(off, axis) * axis) * grow + (start - along) * axis;
  };
  for (glm::dvec3& p : contour.points) p = place(p, 1 + bounding_margin);
  contour.hub = place(center, 1);
}

/// Under a light at a finite point: wider in angle, away from the axis, also where that leads backward; and the points on a
/// plane before the body.
inline void widen_angle(Contour& contour, const glm::dvec3& light, const glm::dvec3& axis, double nearest) {
  bool has_plane = true;
  for (glm::dvec3& away : contour.away) {
    away = glm::normalize(away);
    const double along = glm::dot(away, axis);
    const glm::dvec3 across = away - along * axis;
    away = along > 0 ? along * axis + (1 + bounding_margin) * across : (1 + bounding_margin) * along * axis + across;
    has_plane = has_plane && along > 0.05;
  }
  const double start = has_plane ? std::max(0.0, (1 - bounding_margin) * (nearest - glm::dot(light, axis))) : 0;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
    contour.points[i] = light + contour.away[i] * (start > 0 ? start / glm::dot(contour.away[i], axis) : 0);
  contour.hub = light + start * axis;
}

/// Outline of a volume that holds the body's shadow volume with a margin: from a plane before the body (from the light itself
/// where it is too near for one), around the body.
inline Contour bounding_contour(const Shape& shape, const glm::dvec4& light) {
  Contour contour = contour_of(shape, light, circumscribed, bounding_segments);
  if (contour.points.empty()) return contour;
  const glm::dvec3 center = middle(shape), axis = glm::normalize(light.w * center - glm::dvec3(light));
  const double nearest = heights_over(shape, glm::dvec4(axis, 0)).first;
  if (light.w == 0)
    widen_across(contour, center, axis, nearest);
  else
    widen_angle(contour, glm::dvec3(light), axis, nearest);
  return contour;
}

}  // namespace sphere_volume
