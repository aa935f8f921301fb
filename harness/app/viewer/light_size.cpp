// Outlines and sizes of lights with area.
#include "app/viewer/light_size.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/viewer/moves.h"

namespace gnomon::viewer {

namespace {

using Segments = std::vector<std::pair<glm::dvec3, glm::dvec3>>;

/// A circle about `center` whose plane is across the unit `normal`, as chords.
Segments circle(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
  constexpr int chords = 72;
  const glm::dvec3 aside =
      glm::normalize(glm::cross(normal, std::abs(normal.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 ahead = glm::cross(normal, aside);
  const auto at = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / chords;
    return center + radius * (std::cos(angle) * aside + std::sin(angle) * ahead);
  };
  Segments segments;
  for (int k = 0; k < chords; ++k) segments.emplace_back(at(k), at(k + 1));
  return segments;
}

/// A light without area has none.
Segments outline(const auto&, const glm::dvec3&) { return {}; }
Segments outline(const RectLight& rect, const glm::dvec3&) {
  const glm::dvec3 c(rect.center), u(rect.half_u), v(rect.half_v);
  const glm::dvec3 corners[] = {c - u - v, c + u - v, c + u + v, c - u + v};
  Segments segments;
  for (int k = 0; k < 4; ++k) segments.emplace_back(corners[k], corners[(k + 1) % 4]);
  return segments;
}
Segments outline(const DiscLight& disc, const glm::dvec3&) {
  return circle(disc.center, glm::normalize(glm::dvec3(disc.normal)), disc.radius);
}
/// Rays from the eye touch a sphere along a circle nearer than its center, in the plane that the radius across them ends in.
Segments outline(const SphereLight& sphere, const glm::dvec3& eye) {
  const glm::dvec3 to_eye = eye - glm::dvec3(sphere.center);
  const double distance = glm::length(to_eye), r = sphere.radius;
  if (!(distance > r)) return {};
  const glm::dvec3 toward = to_eye / distance;
  return circle(glm::dvec3(sphere.center) + r * r / distance * toward, toward,
                r * std::sqrt(1 - r * r / (distance * distance)));
}

/// Where a length begins at the center, and goes.
struct Arm {
  glm::dvec3 direction;  ///< unit
  std::size_t which;
};
std::vector<Arm> arms(const Camera& camera, const Light& light) {
  if (const auto* rect = std::get_if<RectLight>(&light.kind))
    return {{glm::normalize(glm::dvec3(rect->half_u)), 0}, {glm::normalize(glm::dvec3(rect->half_v)), 1}};
  if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(disc->normal));
    const auto flat = [&](const glm::dvec3& way) { return way - glm::dot(way, normal) * normal; };
    const glm::dvec3 right = flat(camera.right), up = flat(camera.up);
    return {{glm::normalize(glm::length(right) > 0.5 ? right : up), 0}};
  }
  if (std::holds_alternative<SphereLight>(light.kind)) return {{camera.right, 0}};
  return {};
}

}  // namespace

std::vector<LightLength> light_lengths(const Light& light) {
  if (const auto* rect = std::get_if<RectLight>(&light.kind))
    return {{"half_u", "half width", glm::length(glm::dvec3(rect->half_u))},
            {"half_v", "half height", glm::length(glm::dvec3(rect->half_v))}};
  if (const auto* disc = std::get_if<DiscLight>(&light.kind)) return {{"radius", "radius", disc->radius}};
  if (const auto* sphere = std::get_if<SphereLight>(&light.kind)) return {{"radius", "radius", sphere->radius}};
  return {};
}

Light with_length(const Light& light, std::size_t which, double meters) {
  // To cast more than a float holds is undefined.
  if (which >= light_lengths(light).size() || !(meters > 0 && meters < 1e30)) return light;
  Light sized = light;
  if (auto* rect = std::get_if<RectLight>(&sized.kind)) {
    glm::vec3& half = which == 0 ? rect->half_u : rect->half_v;
    half = meters * glm::normalize(glm::dvec3(half));
  } else if (auto* disc = std::get_if<DiscLight>(&sized.kind)) {
    disc->radius = static_cast<float>(meters);
  } else if (auto* sphere = std::get_if<SphereLight>(&sized.kind)) {
    sphere->radius = static_cast<float>(meters);
  }
  return is_valid(sized) ? sized : light;
}

Segments light_outline(const Light& light, const glm::dvec3& eye) {
  return std::visit([&](const auto& kind) { return outline(kind, eye); }, light.kind);
}

std::vector<SizeHandle> size_handles(const Camera& camera, const Light& light) {
  const std::vector<LightLength> lengths = light_lengths(light);
  if (lengths.empty()) return {};
  const glm::dvec3 center(homogeneous_of_center(light));
  std::vector<SizeHandle> handles;
  for (const Arm& arm : arms(camera, light))
    for (const double sign : {1.0, -1.0})
      handles.push_back({center + sign * lengths[arm.which].meters * arm.direction, arm.which});
  return handles;
}

Light drag_size(const Camera& camera, const Light& light, std::size_t k, glm::dvec2 pixel) {
  const std::vector<SizeHandle> handles = size_handles(camera, light);
  if (k >= handles.size()) return light;
  const glm::dvec3 center(homogeneous_of_center(light)), arm = handles[k].place - center, along = glm::normalize(arm);
  // Center + t along and eye + s ray: their distance is least where the line between is perpendicular to both.
  constexpr double least_sine = 1e-3;  // below, a pixel is kilometers
  const glm::dvec3 ray = camera.ray(pixel.x, pixel.y), to_center = center - camera.eye;
  const double steep = glm::dot(along, ray), squared = glm::dot(ray, ray), spread = squared - steep * steep;
  if (!(spread > least_sine * least_sine * squared)) return light;
  const double t = (steep * glm::dot(to_center, ray) - squared * glm::dot(to_center, along)) / spread;
  const double s = (glm::dot(to_center, ray) + t * steep) / squared;
  if (!(s > 0)) return light;
  return with_length(light, handles[k].which, std::max(t, 0.01 * glm::length(arm)));
}

}  // namespace gnomon::viewer
