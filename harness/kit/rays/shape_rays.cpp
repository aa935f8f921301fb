#include "kit/rays/shape_rays.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace gnomon {

namespace {

/// Keeps the smallest parameter within the interval.
struct Nearest {
  double tnear, tfar;
  ShapeHit best;
  bool wants(double t) const { return t >= tnear && t <= tfar && (!best.found || t < best.t); }
  void offer(double t, const glm::dvec3& normal) {
    if (wants(t)) best = {true, t, normal};
  }
};

/// Real roots of a t^2 + 2 b t + c in ascending order, computed without cancellation; false when there are none.
bool roots(double a, double b, double c, double& t0, double& t1) {
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0) || (a == 0 && b == 0)) return false;
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  t0 = a == 0 ? c / q : q / a;
  t1 = q == 0 ? t0 : c / q;
  if (t0 > t1) std::swap(t0, t1);
  return true;
}

void hit(const Sphere& sphere, const glm::dvec3& o, const glm::dvec3& d, Nearest& nearest) {
  const glm::dvec3 center = sphere.center;
  // About the point nearest the center: the discriminant is then radius^2 minus the squared distance of the line, and does
  // not cancel for a far origin.
  const double dd = glm::dot(d, d), closest = glm::dot(center - o, d) / dd;
  const glm::dvec3 offset = o + closest * d - center;
  const double half = (static_cast<double>(sphere.radius) * sphere.radius - glm::dot(offset, offset)) / dd;
  if (!(half >= 0)) return;
  for (const double t : {closest - std::sqrt(half), closest + std::sqrt(half)})
    nearest.offer(t, (o + t * d - center) / static_cast<double>(sphere.radius));
}

void hit_disc(const glm::dvec3& center, const glm::dvec3& normal, double radius, const glm::dvec3& o, const glm::dvec3& d,
              Nearest& nearest) {
  const double slope = glm::dot(normal, d);
  if (slope == 0) return;
  const double t = glm::dot(normal, center - o) / slope;
  const glm::dvec3 offset = o + t * d - center;
  if (glm::dot(offset, offset) <= radius * radius) nearest.offer(t, normal);
}

void hit(const Disc& disc, const glm::dvec3& o, const glm::dvec3& d, Nearest& nearest) {
  hit_disc(disc.center, glm::normalize(glm::dvec3(disc.normal)), disc.radius, o, d, nearest);
}

void hit(const Cone& cone, const glm::dvec3& o, const glm::dvec3& d, Nearest& nearest) {
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), base = cone.base;
  const double height = cone.height, radius = cone.radius;
  hit_disc(base, -axis, radius, o, d, nearest);
  // Lateral surface about the peak: |x|^2 - (x.axis)^2 = k^2 (x.axis)^2, x = point - peak, k = radius / height.
  const glm::dvec3 peak = base + height * axis, x = o - peak;
  const double k2 = 1 + radius * radius / (height * height), xa = glm::dot(x, axis), da = glm::dot(d, axis);
  double t[2];
  if (!roots(glm::dot(d, d) - k2 * da * da, glm::dot(x, d) - k2 * xa * da, glm::dot(x, x) - k2 * xa * xa, t[0], t[1])) return;
  for (const double root : t) {
    const glm::dvec3 point = x + root * d;
    const double along = glm::dot(point, axis);
    if (along > 0 || along < -height || !nearest.wants(root)) continue;
    // Gradient of the quadric; at the peak itself the axis is as good as any.
    const glm::dvec3 gradient = point - k2 * along * axis;
    nearest.offer(root, glm::dot(gradient, gradient) > 0 ? glm::normalize(gradient) : axis);
  }
}

void hit(const auto&, const glm::dvec3&, const glm::dvec3&, Nearest&) { assert(!"flat shapes are their triangles"); }

}  // namespace

ShapeHit first_hit(const Shape& shape, const glm::dvec3& origin, const glm::dvec3& direction, double tnear, double tfar) {
  Nearest nearest{tnear, tfar, {}};
  std::visit([&](const auto& s) { hit(s, origin, direction, nearest); }, shape);
  return nearest.best;
}

Bounds shape_bounds(const Shape& shape) {
  const auto disc_half = [](const glm::vec3& normal, double radius) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal));
    return radius * glm::sqrt(glm::max(glm::dvec3(0), 1.0 - n * n));
  };
  Bounds box;
  const auto add = [&](const glm::dvec3& c, const glm::dvec3& h) {
    // A float32 rounding is at most 2^-24 of the value: widen by 2^-22 of what is largest.
    const double slack = 0x1p-22 * std::max({glm::length(c), glm::length(h), 1e-30});
    box.add(glm::vec3(c - h - slack));
    box.add(glm::vec3(c + h + slack));
  };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) add(sphere->center, glm::dvec3(sphere->radius));
  if (const auto* disc = std::get_if<Disc>(&shape)) add(disc->center, disc_half(disc->normal, disc->radius));
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    add(cone->base, disc_half(cone->axis, cone->radius));
    add(glm::dvec3(cone->base) + static_cast<double>(cone->height) * glm::normalize(glm::dvec3(cone->axis)), glm::dvec3(0));
  }
  return box;
}

}  // namespace gnomon
