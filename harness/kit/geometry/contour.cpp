#include <gnomon/kit/geometry/contour.h>

#include <algorithm>

namespace gnomon {

/// (1 - s) (1 + s) instead of 1 - s^2, which cancels for a small far sphere.
TangencyCircle tangency_circle(const Sphere& sphere, const glm::dvec4& light) {
  const glm::dvec3 center = sphere.center, to_sphere = light.w * center - glm::dvec3(light);
  const double radius = sphere.radius, distance = glm::length(to_sphere);
  TangencyCircle circle;
  circle.axis = to_sphere / distance;
  circle.sin_alpha = std::min(1.0, light.w * radius / distance);
  circle.cos_alpha = std::sqrt((1 - circle.sin_alpha) * (1 + circle.sin_alpha));
  circle.center = center - radius * circle.sin_alpha * circle.axis;
  circle.radius = radius * circle.cos_alpha;
  const Across frame(circle.axis);
  circle.u = frame.u;
  circle.v = -frame.v;
  return circle;
}

ConeOutline::ConeOutline(const Cone& cone, const glm::dvec4& light)
    : base(cone.base), axis(glm::normalize(glm::dvec3(cone.axis))), height(cone.height), radius(cone.radius), frame(axis) {
  const glm::dvec3 to = glm::dvec3(light) - light.w * base;
  const double along = glm::dot(to, axis), x = glm::dot(to, frame.u), y = glm::dot(to, frame.v);
  const double reach = height * std::hypot(x, y), limit = radius * (light.w * height - along);
  base_faces = along < 0;
  is_circle = limit <= -reach || limit >= reach;
  if (is_circle) return;
  side = std::atan2(y, x);
  half = std::acos(limit / reach);
}

ConePlace::ConePlace(const Cone& cone, const glm::dvec3& point) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), x = point - glm::dvec3(cone.base);
  const double height = cone.height, radius = cone.radius;
  along = glm::dot(x, axis);
  off = (glm::length(x - along * axis) * height - radius * (height - along)) / std::hypot(height, radius);
}

bool contains(const Shape& shape, const glm::dvec3& point) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return glm::distance(point, glm::dvec3(sphere->center)) < double(sphere->radius);
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const auto [along, off] = ConePlace(*cone, point);
    return along > 0 && off < 0;
  }
  return false;
}

std::pair<double, double> heights_over(const Shape& shape, const glm::dvec4& plane) {
  const glm::dvec3 up(plane);
  const auto height = [&](const glm::dvec3& p) { return glm::dot(plane, glm::dvec4(p, 1)); };
  const auto circle = [&](const glm::vec3& center, const glm::vec3& axis, double radius) {
    const double slope = glm::dot(glm::normalize(glm::dvec3(axis)), up), middle = height(center);
    const double half = radius * std::sqrt(std::max(0.0, 1 - slope * slope));
    return std::pair(middle - half, middle + half);
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const double middle = height(sphere->center);
    return {middle - sphere->radius, middle + sphere->radius};
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) return circle(disc->center, disc->normal, disc->radius);
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const auto [low, high] = circle(cone->base, cone->axis, cone->radius);
    const double peak = height(glm::dvec3(cone->base) + double(cone->height) * glm::normalize(glm::dvec3(cone->axis)));
    return {std::min(low, peak), std::max(high, peak)};
  }
  std::pair<double, double> range(INFINITY, -INFINITY);
  const auto add = [&](const glm::dvec3& p) {
    range.first = std::min(range.first, height(p));
    range.second = std::max(range.second, height(p));
  };
  if (const auto* triangle = std::get_if<Triangle>(&shape))
    for (const glm::vec3& p : triangle->points) add(p);
  if (const auto* rectangle = std::get_if<Plane>(&shape))
    for (const double u : {-1.0, 1.0})
      for (const double v : {-1.0, 1.0})
        add(glm::dvec3(rectangle->center) + u * glm::dvec3(rectangle->half_u) + v * glm::dvec3(rectangle->half_v));
  if (const auto* box = std::get_if<Box>(&shape))
    for (int i = 0; i < 8; ++i)
      add({(i & 1 ? box->max : box->min).x, (i & 2 ? box->max : box->min).y, (i & 4 ? box->max : box->min).z});
  return range;
}

}  // namespace gnomon
