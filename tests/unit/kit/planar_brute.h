#pragma once
#include <gnomon/kit/geometry/shapes.h>

#include "small_world.h"

// Whether a shape blocks the way from a point to the light, by intersection in double with the shape itself: no flat parts, no
// projection and nothing of the kit's rays. `grown` is the shape scaled about its middle.
namespace planar_brute {
using namespace gnomon;

struct Ray {
  glm::dvec3 origin, to;
  double end;  ///< ray parameter of the light; from infinity of a point beyond everything
};

inline Ray ray_to(const glm::dvec3& point, const glm::dvec4& light) {
  return {point, to_light(light, point), light.w != 0 ? 1.0 / light.w : 1e9 / glm::length(glm::dvec3(light))};
}

inline bool meets(const Sphere& sphere, double grown, const Ray& ray) {
  const glm::dvec3 center(sphere.center);
  const double t = glm::dot(center - ray.origin, ray.to) / glm::dot(ray.to, ray.to);
  return glm::distance(ray.origin + std::clamp(t, 0.0, ray.end) * ray.to, center) <= grown * sphere.radius;
}

/// Between base and peak the solid is where the distance from the axis, squared, minus that of the surface is not positive: of
/// a quadratic function the least value, at an end or at its stationary point.
inline bool meets(const Cone& cone, double grown, const Ray& ray) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis));
  const double h = grown * cone.height, r = grown * cone.radius;
  const glm::dvec3 base = glm::dvec3(cone.base) - 0.25 * (h - cone.height) * axis, x = ray.origin - base;
  const double along = glm::dot(x, axis), rate = glm::dot(ray.to, axis);
  double from = 0, to = ray.end;
  if (rate == 0 && (along < 0 || along > h)) return false;
  if (rate != 0) {
    from = std::max(from, std::min(-along / rate, (h - along) / rate));
    to = std::min(to, std::max(-along / rate, (h - along) / rate));
  }
  if (from > to) return false;
  const auto excess = [&](double t) {
    const glm::dvec3 p = x + t * ray.to;
    const double a = glm::dot(p, axis);
    return glm::length(p - a * axis) - r * (1 - a / h);
  };
  if (excess(from) <= 0 || excess(to) <= 0) return true;
  const glm::dvec3 x_off = x - along * axis, to_off = ray.to - rate * axis;
  const double slope = r / h, surface = r - slope * along;
  const double a = glm::dot(to_off, to_off) - slope * slope * rate * rate;
  const double b = glm::dot(x_off, to_off) + surface * slope * rate;
  return a > 0 && -b / a > from && -b / a < to && excess(-b / a) <= 0;
}

inline bool meets(const Disc& disc, double grown, const Ray& ray) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(disc.normal)), center(disc.center);
  const double t = glm::dot(normal, center - ray.origin) / glm::dot(normal, ray.to);
  return t > 0 && t < ray.end && glm::distance(ray.origin + t * ray.to, center) <= grown * disc.radius;
}

inline bool meets(const Box& box, double grown, const Ray& ray) {
  double from = 0, to = ray.end;
  for (int k = 0; k < 3; ++k) {
    const double middle = 0.5 * (double(box.min[k]) + box.max[k]), half = 0.5 * grown * (double(box.max[k]) - box.min[k]);
    const double low = middle - half - ray.origin[k], high = middle + half - ray.origin[k];
    if (ray.to[k] == 0 && (low > 0 || high < 0)) return false;
    if (ray.to[k] == 0) continue;
    from = std::max(from, std::min(low / ray.to[k], high / ray.to[k]));
    to = std::min(to, std::max(low / ray.to[k], high / ray.to[k]));
  }
  return from <= to;
}

/// Flat shapes are their triangles, with the corners as the tessellation rounds them.
inline bool meets_triangles(const Shape& shape, double grown, const Ray& ray) {
  const Mesh mesh = tessellate(shape, default_segments, "flat");
  glm::dvec3 middle(0);
  for (const glm::vec3& p : mesh.positions) middle += glm::dvec3(p) / double(mesh.positions.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const auto corner = [&](unsigned i) { return middle + grown * (glm::dvec3(mesh.positions[i]) - middle); };
    const double hit = small_world::intersect(ray.origin, ray.to, corner(t.x), corner(t.y), corner(t.z));
    if (hit > 0 && hit < ray.end) return true;
  }
  return false;
}
inline bool meets(const Triangle& triangle, double grown, const Ray& ray) { return meets_triangles(triangle, grown, ray); }
inline bool meets(const Plane& plane, double grown, const Ray& ray) { return meets_triangles(plane, grown, ray); }

inline bool meets(const Shape& shape, double grown, const Ray& ray) {
  return std::visit([&](const auto& s) { return meets(s, grown, ray); }, shape);
}

inline bool is_solid(const Shape& shape) {
  return std::holds_alternative<Sphere>(shape) || std::holds_alternative<Cone>(shape) || std::holds_alternative<Box>(shape);
}

/// Whether the point is in the solid grown by the share `margin`, or within `margin` meters of the plane of a flat shape.
inline bool holds(const Shape& shape, double margin, const glm::dvec3& point) {
  if (is_solid(shape)) return meets(shape, 1 + margin, {point, {0, 1, 0}, 0});
  const Mesh mesh = tessellate(shape, default_segments, "flat");
  const glm::dvec3 a(mesh.positions[0]), b(mesh.positions[1]), c(mesh.positions[2]);
  return std::abs(glm::dot(glm::normalize(glm::cross(b - a, c - a)), point - a)) <= margin;
}

enum class Answer { lit, dark, unsure };

/// Unsure: with the shape grown or shrunk by the share `margin` the answer changes, or the point is in the solid or on its
/// surface, or in the plane of a flat shape.
inline Answer answer(const Shape& shape, const glm::dvec4& light, const glm::dvec3& point, double margin = 1e-7) {
  if (holds(shape, 10 * margin, point)) return Answer::unsure;
  const Ray ray = ray_to(point, light);
  const bool is_dark = meets(shape, 1 - margin, ray);
  if (is_dark != meets(shape, 1 + margin, ray)) return Answer::unsure;
  return is_dark ? Answer::dark : Answer::lit;
}

}  // namespace planar_brute
