// The light: where its handle is, and what follows from where it goes.
#include <algorithm>
#include <cmath>

#include "app/viewer/moves.h"
#include "app/viewer/moves_parts.h"

namespace gnomon::viewer {
namespace {

/// Where handles of directional lights are.
struct Ellipsoid {
  glm::dvec3 middle{0}, semiaxes{1};

  /// Just around the bounds, whose corners are the square root of 3 half edges off the middle when those have unit length. Of a
  /// flat scene, not flat: a light may come from the side.
  explicit Ellipsoid(const Scene& scene) {
    const Bounds bounds = scene.bounds();
    if (bounds.empty()) return;
    const glm::dvec3 low(bounds.min), high(bounds.max), half = (high - low) / 2.0;
    middle = (low + high) / 2.0;
    constexpr double margin = 1.05, flattest = 0.2;
    const double longest = std::max({half.x, half.y, half.z});
    if (longest > 0) semiaxes = margin * std::sqrt(3.0) * glm::max(half, glm::dvec3(flattest * longest));
  }
  /// The point on the way from the middle along `direction`.
  glm::dvec3 toward(const glm::dvec3& direction) const { return middle + direction / glm::length(direction / semiaxes); }
};

/// Where the ray meets the ellipsoid before its origin, on the side of it, near or far, that `place` is on; of a ray that
/// misses, where it passes nearest in units of the semiaxes. Nothing for rays that lead away from it.
std::optional<glm::dvec3> on(const Ellipsoid& ellipsoid, const glm::dvec3& origin, const glm::dvec3& ray,
                             const glm::dvec3& place) {
  // In those units it is the unit sphere; p is on the near side where the plane that touches it there has o before it.
  const glm::dvec3 o = (origin - ellipsoid.middle) / ellipsoid.semiaxes, d = glm::normalize(ray / ellipsoid.semiaxes);
  const bool is_near = glm::dot((place - ellipsoid.middle) / ellipsoid.semiaxes, o) > 1;
  const double nearest = -glm::dot(o, d);
  const glm::dvec3 foot = o + nearest * d;
  const double half = std::sqrt(std::max(1 - glm::dot(foot, foot), 0.0)), t = nearest + (is_near ? -half : half);
  if (!(t > 0)) return std::nullopt;
  return ellipsoid.middle + ellipsoid.semiaxes * (o + t * d);
}

}  // namespace

glm::dvec3 light_place(const Scene& scene, const Light& light) {
  const glm::dvec4 place = homogeneous(light);
  return place.w != 0 ? glm::dvec3(place) : Ellipsoid(scene).toward(place);
}

Light light_moved_to(const Scene& scene, const Light& light, const glm::dvec3& place) {
  if (!is_castable(place)) return light;
  Light moved = light;
  if (auto* sun = std::get_if<DirectionalLight>(&moved.kind)) {
    const glm::dvec3 direction = Ellipsoid(scene).middle - place;
    if (direction == glm::dvec3(0)) return light;
    sun->direction = glm::length(glm::dvec3(sun->direction)) * glm::normalize(direction);  // of the length that it had
  } else if (auto* point = std::get_if<PointLight>(&moved.kind)) {
    point->position = place;
  } else if (auto* spot = std::get_if<SpotLight>(&moved.kind)) {
    spot->position = place;
  } else if (auto* rect = std::get_if<RectLight>(&moved.kind)) {
    rect->center = place;
  } else if (auto* disc = std::get_if<DiscLight>(&moved.kind)) {
    disc->center = place;
  } else if (auto* sphere = std::get_if<SphereLight>(&moved.kind)) {
    sphere->center = place;
  }
  return is_valid(moved) ? moved : light;
}

std::optional<glm::dvec3> drag_place(const Camera& camera, const glm::dvec3& place, glm::dvec2 pixel, bool is_vertical) {
  const glm::dvec3 ray = camera.ray(pixel.x, pixel.y), to_place = place - camera.eye;
  double along = glm::dot(to_place, camera.forward);  // the ray is unit along the axis
  if (!is_vertical) return along > 0 ? std::optional(camera.eye + along * ray) : std::nullopt;

  // Line place + t up and ray eye + s ray: their distance is least where the line between is perpendicular to both.
  constexpr glm::dvec3 up(0, 1, 0);
  constexpr double least_sine = 1e-3;  // below, a pixel is kilometers
  const double steep = ray.y, squared = glm::dot(ray, ray), spread = squared - steep * steep;
  if (!(spread > least_sine * least_sine * squared)) return std::nullopt;
  along = (glm::dot(to_place, ray) - steep * to_place.y) / spread;
  if (!(along > 0)) return std::nullopt;
  return place + (along * steep - to_place.y) * up;
}

Light drag_light(const Scene& scene, const Light& light, const Camera& camera, glm::dvec2 pixel, bool is_vertical) {
  const glm::dvec3 place = light_place(scene, light);
  const auto to = std::holds_alternative<DirectionalLight>(light.kind) && !is_vertical
                      ? on(Ellipsoid(scene), camera.eye, camera.ray(pixel.x, pixel.y), place)
                      : drag_place(camera, place, pixel, is_vertical);
  return to ? light_moved_to(scene, light, *to) : light;
}

std::optional<Handle> light_handle(const Camera& camera, const glm::dvec3& place, double margin) {
  const std::optional<glm::dvec2> at = project(camera, place);
  if (!at) return std::nullopt;
  const glm::dvec2 middle = glm::dvec2(camera.width, camera.height) / 2.0, aside = *at - middle;
  double share = 1;
  for (int k = 0; k < 2; ++k)
    if (const double room = std::max(middle[k] - margin, 0.0); std::abs(aside[k]) > room)
      share = std::min(share, room / std::abs(aside[k]));
  return Handle{*at, share < 1 ? middle + share * aside : *at};
}

double key_step(const Scene& scene) {
  const Bounds bounds = scene.bounds();
  return bounds.empty() ? 1.0 / 50 : glm::length(glm::dvec3(bounds.max) - glm::dvec3(bounds.min)) / 50;
}

}  // namespace gnomon::viewer
