// Where the camera's eye and target go, and the light.
#include "app/viewer/moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/viewer/keys.h"
#include "measure/scene/base_scene.h"

namespace gnomon::viewer {
namespace {

constexpr double pole_gap = std::numbers::pi / 360;  // half a degree

/// How far rounding a coordinate may turn the line of sight, in radians: half a unit in the last place of the largest one.
double coarseness(double largest, double distance) { return largest * 0x1p-24 / distance; }
constexpr double coarsest_zoom = 1e-4;
constexpr double coarsest = 1e-2;  // a hundred times that: from where a zoom ends, panning and flying still go on

double coarseness(const View& view) {
  const glm::dvec3 eye(view.eye), target(view.target);
  return coarseness(std::max(extent(eye), extent(target)), glm::length(target - eye));
}

/// The view with this eye and target, rounded; the view as it is where they are none, or none that float32 can hold.
View with(const View& view, const glm::dvec3& eye, const glm::dvec3& target) {
  // To cast more than a float holds is undefined.
  if (!is_sound(eye) || !is_sound(target)) return view;
  View moved = view;
  moved.eye = eye;
  moved.target = target;
  return is_valid(moved) && coarseness(moved) <= std::max(coarsest, coarseness(view)) ? moved : view;
}

/// `arm` turned about `axis` (unit) by `azimuth`, and away from it by `polar`, both in radians. It ends short of the poles; one
/// that is nearer to a pole already comes no nearer.
glm::dvec3 turned(const glm::dvec3& arm, const glm::dvec3& axis, double azimuth, double polar) {
  const double along = glm::dot(arm, axis);
  const glm::dvec3 away = arm - along * axis, outward = glm::normalize(away), ahead = glm::cross(axis, outward);
  const double before = std::atan2(glm::length(away), along);
  const double after = std::clamp(before + polar, std::min(before, pole_gap), std::max(before, std::numbers::pi - pole_gap));
  const glm::dvec3 flat = std::cos(azimuth) * outward + std::sin(azimuth) * ahead;
  return glm::length(arm) * (std::cos(after) * axis + std::sin(after) * flat);
}

glm::dvec3 axis(const View& view) { return glm::normalize(glm::dvec3(view.up)); }
glm::dvec3 sight(const View& view) { return glm::dvec3(view.target) - glm::dvec3(view.eye); }

/// The width of a pixel in the middle of the picture, a meter before the eye.
double pixel_width(const View& view, int height) { return 2 * Camera(view, 1, 1).tan_y / std::max(height, 1); }

/// Eye and target moved by the same step. Of each coordinate, the larger is rounded and the other follows at the offset that it
/// had: that stays to the bit where float32 holds it.
View shifted(const View& view, const glm::dvec3& by) {
  const glm::dvec3 offset = sight(view);
  glm::dvec3 eye = glm::dvec3(view.eye) + by, target = glm::dvec3(view.target) + by;
  if (!is_sound(eye) || !is_sound(target)) return view;
  for (int k = 0; k < 3; ++k)
    if (std::abs(eye[k]) > std::abs(target[k]))
      target[k] = static_cast<float>(eye[k]) + offset[k];
    else
      eye[k] = static_cast<float>(target[k]) - offset[k];
  return with(view, eye, target);
}

}  // namespace

View orbit_by(const View& view, glm::dvec2 angles) {
  if (angles == glm::dvec2(0)) return view;
  const glm::dvec3 target(view.target);
  return with(view, target + turned(-sight(view), axis(view), angles.x, -angles.y), target);
}

View orbit(const View& view, glm::dvec2 pixels, int height) {
  return orbit_by(view, std::numbers::pi / std::max(height, 1) * glm::dvec2(-pixels.x, pixels.y));
}

View pan(const View& view, glm::dvec2 pixels, int height) {
  const Camera camera(view, 1, 1);
  const double meters = pixel_width(view, height) * glm::length(sight(view));
  return shifted(view, meters * (pixels.y * camera.up - pixels.x * camera.right));
}

View zoom(const View& view, double steps) {
  if (steps == 0) return view;
  constexpr double least = 1e-9, most = 1e9;  // meters, for targets that are the origin or near it
  const glm::dvec3 target(view.target), arm = -sight(view);
  const double distance = glm::length(arm);
  const double nearest = std::max(least, coarseness(extent(target), coarsest_zoom));
  const double wanted = std::clamp(distance * std::pow(0.9, steps), std::min(distance, nearest), std::max(distance, most));
  return with(view, target + wanted / distance * arm, target);
}

View look(const View& view, glm::dvec2 pixels, int height) {
  if (pixels == glm::dvec2(0)) return view;
  const glm::dvec3 eye(view.eye), arm = sight(view), up = axis(view);
  // The middle of the picture goes around the axis on a circle of this radius; near a pole it would have to spin.
  constexpr double least_radius = 0.2;
  const double radius = std::max(glm::length(glm::cross(glm::normalize(arm), up)), least_radius);
  const double angle = pixel_width(view, height);
  return with(view, eye, eye + turned(arm, up, angle * pixels.x / radius, -angle * pixels.y));
}

View fly(const View& view, glm::dvec3 steps, double step) {
  const Camera camera(view, 1, 1);
  return shifted(view, step * (steps.x * camera.right + steps.y * axis(view) + steps.z * camera.forward));
}

std::optional<glm::dvec2> project(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 to_point = point - camera.eye;
  const double depth = glm::dot(to_point, camera.forward);
  if (!(depth > 0)) return std::nullopt;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  const glm::dvec2 slope(glm::dot(to_point, camera.right) / depth / (camera.tan_y * aspect),
                         glm::dot(to_point, camera.up) / depth / camera.tan_y);
  if (!std::isfinite(slope.x) || !std::isfinite(slope.y)) return std::nullopt;
  return glm::dvec2((1 + slope.x) * camera.width / 2, (1 - slope.y) * camera.height / 2);
}

// --- the light ----------------------------------------------------------------------------------------------------------

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

glm::vec3* position_of(Light& light) {
  const auto of = [](auto& kind) -> glm::vec3* {
    if constexpr (requires { kind.position; })
      return &kind.position;
    else if constexpr (requires { kind.center; })
      return &kind.center;
    else
      return nullptr;
  };
  return std::visit(of, light.kind);
}

glm::dvec3 light_place(const Scene& scene, const Light& light) {
  const glm::dvec4 place = homogeneous_of_center(light);
  return place.w != 0 ? glm::dvec3(place) : Ellipsoid(scene).toward(place);
}

Light light_moved_to(const Scene& scene, const Light& light, const glm::dvec3& place) {
  if (!is_sound(place)) return light;
  Light moved = light;
  if (auto* sun = std::get_if<DirectionalLight>(&moved.kind)) {
    const glm::dvec3 direction = Ellipsoid(scene).middle - place;
    if (direction == glm::dvec3(0)) return light;
    sun->direction = glm::length(glm::dvec3(sun->direction)) * glm::normalize(direction);  // of the length that it had
  } else {
    *position_of(moved) = place;
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

// --- keys ---------------------------------------------------------------------------------------------------------------

std::optional<View> moved_by_key(const View& view, const Scene& scene, const KeyEffect& effect, double count) {
  constexpr double turn = std::numbers::pi / 36;  // 5 degrees
  if (const auto* orbit = std::get_if<OrbitSteps>(&effect))
    return orbit_by(view, turn * count * glm::dvec2(orbit->right, orbit->up));
  if (const auto* way = std::get_if<ZoomSteps>(&effect)) return zoom(view, count * way->nearer);
  if (const auto* way = std::get_if<FlySteps>(&effect))
    return fly(view, count * glm::dvec3(way->right, way->up, way->forward), key_step(scene));
  return std::nullopt;
}

std::optional<Light> moved_by_key(const Light& light, const Scene& scene, const KeyEffect& effect, double count) {
  const auto* const way = std::get_if<LightSteps>(&effect);
  if (!way) return std::nullopt;
  return light_moved_to(scene, light, light_place(scene, light) + count * key_step(scene) * glm::dvec3(way->x, way->y, 0));
}

}  // namespace gnomon::viewer
